//! The table of the study's responses: each point with the estimates and their 95 % intervals, and what they mean.

use std::collections::BTreeSet;

use super::html::Html;
use super::tables::MOST_ROWS;
use crate::report::data::{ReportData, said};
use crate::report::printed_columns::response_columns;

/// Adds the table; nothing if the study has no responses.
pub fn responses(body: &mut Html, data: &ReportData<'_>) {
    let (study, responses) = (data.study, data.study.responses());
    if responses.is_empty() {
        return;
    }
    body.line("<section aria-labelledby=\"responses\"><h2 id=\"responses\">Responses</h2>");
    let rows = &data.points[..data.points.len().min(MOST_ROWS)];
    let shown: Vec<Vec<String>> = rows.iter().map(|point| said(study, &point.swept)).collect();
    body.columns(&response_columns((rows, study.swept(), &shown), responses, study.units()), &[]);
    body.line("<dl class=\"facts\">");
    for (index, response) in responses.iter().enumerate() {
        body.element("dt", "", &response.name);
        body.element("dd", "", &response.meaning_in(&study.units().vibration()));
        let estimates = rows.iter().filter_map(|point| point.responses.get(index));
        let reasons =
            estimates.filter(|one| one.value.is_none()).filter_map(|one| one.reason.as_deref());
        let reasons: BTreeSet<&str> = reasons.collect();
        reasons
            .iter()
            .for_each(|reason| body.element("dd", "", &format!("It is missing where {reason}.")));
    }
    body.line("</dl></section>");
}
