//! The table of points: residual vibration first, then the ends of the runs with their intervals.

use std::path::Path;

use super::html::{Html, escaped};
use super::tables::MOST_ROWS;
use crate::classification::Label;
use crate::report::data::{Fraction, PeakOfRun, PointFacts, ReportData, said};
use crate::report::figures::{label_words, significant};
use crate::sanitize::shell_word;
use crate::study::{ParameterKind, Study, VariedParameter};

/// The number of rows above which a table is folded.
const SHORT_TABLE: usize = 24;

/// A column that is left out if no point has a value.
#[derive(Clone, Copy)]
struct Optional {
    name: &'static str,
    value: fn(&PointFacts) -> Option<f64>,
    text: fn(Option<f64>) -> String,
}

const OPTIONAL: [Optional; 4] = [
    Optional {
        name: "runs worse than without balls [%]",
        value: |point| point.residual.worse_than_without_balls.map(|[worse, ..]| worse),
        text: percent,
    },
    Optional {
        name: "median balance quality grade G [mm/s]",
        value: |point| point.residual.balance_quality_grade_mm_s[0],
        text: written,
    },
    Optional {
        name: "95 % quantile of G [mm/s]",
        value: |point| point.residual.balance_quality_grade_mm_s[1],
        text: written,
    },
    Optional {
        name: "rests with overlapping balls [%]",
        value: |point| point.residual.overlapping_rest_fraction,
        text: percent,
    },
];

fn percent(fraction: Option<f64>) -> String {
    fraction.map_or_else(|| "–".to_owned(), |value| format!("{:.1}", 100.0 * value))
}

/// Adds the table of points: residual vibration first, then the ends of the runs with their intervals.
pub fn points(body: &mut Html, directory: &Path, data: &ReportData<'_>) {
    body.line("<section aria-labelledby=\"points\"><h2 id=\"points\">Points</h2>");
    let study = data.study;
    let swept: Vec<String> = study.swept().iter().map(VariedParameter::shown_name).collect();
    let mut head = vec!["point"];
    head.extend(swept.iter().map(String::as_str));
    let balls = study.model().kind().offers.vibration;
    let (vibration, speed) = (study.units().vibration(), study.units().speed());
    let with_unit = |name: &str| format!("{name} [{}]", vibration.symbol);
    let vibration_names = ["median amplitude", "95 % quantile", "no balls"].map(with_unit);
    let stage_names =
        [with_unit("largest amplitude of a run"), format!("at the speed [{}]", speed.symbol)];
    let shown = |metres: Option<f64>| written(metres.map(|metres| vibration.of(metres)));
    if balls {
        head.extend(vibration_names.iter().map(String::as_str));
    }
    let stages = study.has_stages();
    if stages {
        head.extend(stage_names.iter().map(String::as_str));
    }
    let optional: Vec<Optional> = OPTIONAL
        .into_iter()
        .filter(|one| data.points.iter().any(|point| (one.value)(point).is_some()))
        .collect();
    head.extend(optional.iter().map(|one| one.name));
    head.extend(["runs", "equilibria", "95 % interval"]);
    let contact = data.points.iter().any(|point| data.touching_rests(point).is_some());
    if contact {
        head.push("rests that touch");
    }
    let moving = [Label::LimitCycle, Label::Irregular, Label::Undecided, Label::Failed];
    let occurs = |label: &Label| data.points.iter().any(|point| point.label(*label).runs > 0);
    let moving: Vec<Label> = moving.into_iter().filter(occurs).collect();
    let words: Vec<String> = moving.iter().map(|label| label_words(*label)).collect();
    head.extend(words.iter().map(String::as_str));
    let audit = study.audit().is_some();
    if audit {
        head.push("flips");
    }
    head.push(match stages {
        true => "median time to rest after the begin of the last stage [s]",
        false => "median time to rest [s]",
    });
    if balls {
        head.push("set [%]");
    }
    let text: Vec<usize> = study
        .swept()
        .iter()
        .enumerate()
        .filter(|(_, parameter)| parameter.kind == ParameterKind::Text)
        .map(|(column, _)| column + 1)
        .collect();
    let row = |point: &PointFacts| {
        let mut cells = vec![point.point_id.to_string()];
        cells.extend(said(study, &point.swept).iter().map(|value| escaped(value)));
        if balls {
            let [_, median, p95] = point.amplitude_m;
            cells.extend([median, p95, point.residual.amplitude_without_balls_m].map(shown));
        }
        if stages {
            let peak = data.run_up.largest.get(&point.point_id);
            let at_speed = peak.and_then(|peak| disc_speed(study, peak));
            let at_speed = at_speed.map(|rad_s| speed.of(rad_s));
            cells.extend([shown(peak.map(|peak| peak.amplitude_m)), written(at_speed)]);
        }
        cells.extend(optional.iter().map(|one| (one.text)((one.value)(point))));
        let Fraction { fraction, low, high, .. } = point.equilibrium;
        cells.push(point.runs.to_string());
        cells.push(format!("{fraction:.4}"));
        cells.push(format!("<span class=\"interval\">{low:.4} to {high:.4}</span>"));
        if contact {
            let rests = data.touching_rests(point);
            cells.push(rests.map_or_else(
                || "–".to_owned(),
                |rests| format!("{rests} of {}", point.equilibrium.runs),
            ));
        }
        cells.extend(moving.iter().map(|label| point.label(*label).runs.to_string()));
        if audit {
            cells.push(format!("{} of {}", point.audit.flips, point.audit.runs));
        }
        cells.push(written(point.time_to_rest_s[1]));
        if balls {
            cells.push(percent(point.set_fraction));
        }
        cells
    };
    let rows: Vec<Vec<String>> = data.points.iter().take(MOST_ROWS).map(row).collect();
    let long = rows.len() > SHORT_TABLE;
    if long {
        let rows = rows.len();
        body.line(&format!("<details><summary>Table of {rows} points</summary>"));
    }
    body.table(&head, &rows, &text);
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
}

/// Returns the speed of the disc at the largest vibration of a run, rad/s.
fn disc_speed(study: &Study, peak: &PeakOfRun) -> Option<f64> {
    if peak.run_id >= study.run_count() {
        return None;
    }
    let case = study.planned_run(peak.run_id).case.ok()?;
    Some(case.model.ball_balancer()?.disc_motion().speed_rad_s(peak.time_s))
}

/// Returns a number with four significant digits, or a dash.
fn written(value: Option<f64>) -> String {
    value.map_or_else(|| "–".to_owned(), significant)
}
