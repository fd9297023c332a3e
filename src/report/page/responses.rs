//! The table of the study's responses: each point with the estimates and their 95 % intervals, and what they mean.

use super::html::{Html, escaped};
use super::tables::MOST_ROWS;
use crate::analysis::Estimate;
use crate::report::data::{PointFacts, ReportData, said};
use crate::report::figures::significant;
use crate::study::{Response, Unit, VariedParameter};

/// Adds the table; nothing if the study has no responses.
pub fn responses(body: &mut Html, data: &ReportData<'_>) {
    let (study, responses) = (data.study, data.study.responses());
    if responses.is_empty() {
        return;
    }
    body.line("<section aria-labelledby=\"responses\"><h2 id=\"responses\">Responses</h2>");
    let units: Vec<Unit> = responses.iter().map(|one| one.shown_unit(study.units())).collect();
    let balls = study.model().kind().offers.vibration;
    let is_known = |response: &Response| balls && response.has_value_without_balls();
    let mut head = vec!["point".to_owned()];
    head.extend(study.swept().iter().map(VariedParameter::shown_name));
    for (response, unit) in responses.iter().zip(&units) {
        head.extend([format!("{} [{}]", response.name, unit.symbol), "95 % interval".to_owned()]);
        head.extend(is_known(response).then(|| format!("no balls [{}]", unit.symbol)));
    }
    let head: Vec<&str> = head.iter().map(String::as_str).collect();
    let row = |point: &PointFacts| {
        let mut cells = vec![point.point_id.to_string()];
        cells.extend(said(study, &point.swept).iter().map(|value| escaped(value)));
        let estimates = point.responses.iter().zip(&point.responses_without_balls);
        for (((estimate, without), unit), response) in estimates.zip(&units).zip(responses) {
            let written = |value: f64| significant(unit.of(value));
            cells.push(match (estimate.value, &estimate.reason) {
                (Some(value), _) => written(value),
                (None, Some(reason)) => escaped(reason),
                (None, None) => "–".to_owned(),
            });
            cells.push(format!("<span class=\"interval\">{}</span>", interval(estimate, written)));
            let without =
                is_known(response).then(|| without.map_or_else(|| "–".to_owned(), written));
            cells.extend(without);
        }
        cells
    };
    let rows: Vec<Vec<String>> = data.points.iter().take(MOST_ROWS).map(row).collect();
    body.table(&head, &rows, &[]);
    body.line("<dl class=\"facts\">");
    for response in responses {
        body.element("dt", "", &response.name);
        body.element("dd", "", &response.meaning_in(&study.units().vibration()));
    }
    body.line("</dl></section>");
}

fn interval(estimate: &Estimate, written: impl Fn(f64) -> String) -> String {
    match (estimate.low, estimate.high) {
        (Some(low), Some(high)) => format!("{} to {}", written(low), written(high)),
        (Some(low), None) => format!("at least {}", written(low)),
        (None, Some(high)) => format!("at most {}", written(high)),
        (None, None) => "–".to_owned(),
    }
}
