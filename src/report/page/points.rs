//! The table of points, and that of the study's responses.

use std::collections::BTreeSet;
use std::path::Path;

use super::html::{Html, escaped};
use super::tables::MOST_ROWS;
use crate::numbers::{percent, significant};
use crate::printed_table::{PrintedColumn, PrintedTable};
use crate::report::data::{PeakOfRun, PointFacts, ReportData, said};
use crate::report::printed_columns::{printed_columns, response_columns};
use crate::sanitize::shell_word;
use crate::study::{ParameterKind, Study};

/// The number of rows above which a table is folded.
const SHORT_TABLE: usize = 24;

/// Adds the table of points: residual vibration first, then the ends of the runs with their intervals; and that of the
/// responses.
pub fn points(body: &mut Html, directory: &Path, data: &ReportData<'_>) {
    body.line("<section aria-labelledby=\"points\"><h2 id=\"points\">Points</h2>");
    let study = data.study;
    let rows = &data.points[..data.points.len().min(MOST_ROWS)];
    let shown: Vec<Vec<String>> = rows.iter().map(|point| said(study, &point.swept)).collect();
    let balls = study.model().kind().offers.vibration;
    let vibration = balls.then(|| study.units().vibration());
    let of_points = (rows, study.swept(), &shown[..]);
    let mut columns = printed_columns(of_points, vibration.as_ref(), study.audit().is_some());
    columns.extend(further_columns(data, rows));
    let text: Vec<usize> = study
        .swept()
        .iter()
        .enumerate()
        .filter(|(_, parameter)| parameter.kind == ParameterKind::Text)
        .map(|(column, _)| column + 1)
        .collect();
    let long = rows.len() > SHORT_TABLE;
    if long {
        let rows = rows.len();
        body.line(&format!("<details><summary>Table of {rows} points</summary>"));
    }
    body.columns(&columns, &text);
    if long {
        body.line("</details>");
    }
    let dir = escaped(&shell_word(directory));
    if data.point_count > rows.len() as u64 {
        body.line(&format!(
            "<p>The first {} of {} points; <code class=\"command\">stickslip summary {dir} --points \
             all</code> prints all points, and points.parquet has all columns.</p>",
            rows.len(),
            data.point_count,
        ));
    }
    body.line("</section>");
    responses(body, data, rows, &shown);
}

/// Adds the table of the study's responses at these points, with the estimates, their 95 % intervals, and what they mean;
/// nothing if the study has no responses.
fn responses(body: &mut Html, data: &ReportData<'_>, rows: &[PointFacts], shown: &[Vec<String>]) {
    let (study, responses) = (data.study, data.study.responses());
    if responses.is_empty() {
        return;
    }
    body.line("<section aria-labelledby=\"responses\"><h2 id=\"responses\">Responses</h2>");
    body.columns(&response_columns((rows, study.swept(), shown), responses, study.units()), &[]);
    body.line("<dl class=\"facts\">");
    for (index, response) in responses.iter().enumerate() {
        body.element("dt", "", &response.name);
        body.element("dd", "", &response.meaning_in(&study.units().vibration()));
        let estimates = rows.iter().filter_map(|point| point.responses.get(index));
        let reasons = estimates
            .filter(|estimate| estimate.value.is_none())
            .filter_map(|estimate| estimate.reason.as_deref());
        let reasons: BTreeSet<&str> = reasons.collect();
        reasons
            .iter()
            .for_each(|reason| body.element("dd", "", &format!("It is missing where {reason}.")));
    }
    body.line("</dl></section>");
}

/// Returns the speed of the disc at the largest vibration of a run, rad/s.
fn disc_speed(study: &Study, peak: &PeakOfRun) -> Option<f64> {
    let case = study.planned_run(peak.run_id).case.ok()?;
    Some(case.model.ball_balancer()?.disc_motion().speed_rad_s(peak.time_s))
}

/// Returns the columns that only the page has: the largest vibration of a run, rests that touch, and
/// the fraction of all positions that are positions of rest.
fn further_columns(data: &ReportData<'_>, rows: &[PointFacts]) -> Vec<PrintedColumn> {
    let (study, vibration) = (data.study, data.study.units().vibration());
    let speed = study.units().speed();
    let mut table = PrintedTable::new(rows, "–");
    if study.has_peaks() {
        let peak = |point: &PointFacts| data.run_up.largest.get(&point.point_id);
        table.add_if_any(format!("largest amplitude of a run [{}]", vibration.symbol), |point| {
            Some(significant(vibration.of(peak(point)?.amplitude_m)))
        });
        table.add_if_any(format!("at the speed [{}]", speed.symbol), |point| {
            Some(significant(speed.of(disc_speed(study, peak(point)?)?)))
        });
    }
    table.add_if_any("rests that touch", |point| {
        data.touching_rests(point).map(|rests| format!("{rests} of {}", point.equilibrium.runs))
    });
    table.add_if_any("positions of rest [%]", |point| point.set_fraction.map(percent));
    table.columns
}
