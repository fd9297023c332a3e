//! The text and tables of the page: facts of the run, missing runs, points, failed and flipped runs.

use std::path::Path;

use super::html::{Html, escaped};
use crate::analysis::RankCorrelation;
use crate::classification::Label;
use crate::counted::counted;
use crate::model::Method;
use crate::report::data::{DrawnRuns, Fraction, Notable, PointFacts, ReportData, Vibration, said};
use crate::report::figures::{shown_parameters, significant};
use crate::sanitize::{one_line, shell_word};
use crate::study::{ParameterKind, VariedParameter};

/// The number of rows above which a table is folded.
const SHORT_TABLE: usize = 24;
/// The number of characters of a run's error message that are shown.
const LONGEST_ERROR: usize = 400;
/// The largest number of rows of a table.
const MOST_ROWS: usize = 200;

/// Adds the facts of the run: study, version, seed, machine, time.
pub fn facts(body: &mut Html, data: &ReportData<'_>) {
    let (study, manifest) = (data.study, data.manifest);
    let simulation = study.simulation();
    let points = match data.point_count {
        1 => "one point".to_owned(),
        count => format!("{count} points"),
    };
    let runs = match manifest.complete {
        true => format!("{} at {points}", counted(manifest.runs_finished, "run")),
        false => {
            format!("{} of {} runs, at {points}", manifest.runs_finished, manifest.runs_planned)
        }
    };
    let program = format!("stickslip {} ({})", manifest.version, manifest.commit);
    let model = format!(
        "{}, {} friction; {} s at most, method {}",
        study.model().kind().replace('_', " "),
        study.model().friction().name(),
        simulation.end_time_s,
        match simulation.method {
            Method::Switch => "switch",
            Method::Event => "event",
        },
    );
    let hash: String = manifest.study_hash.chars().take(16).collect();
    let facts = [
        ("Study", format!("{}, hash {hash}, seed {}", study.name(), study.seed())),
        ("Model", model),
        ("Runs", runs),
        ("Program", program),
    ];
    body.line("<dl class=\"facts\">");
    for (name, text) in facts {
        body.line(&format!("<dt>{name}</dt><dd>{}</dd>", escaped(&text)));
    }
    let shard = match manifest.shard.as_str() {
        "1/1" => String::new(),
        shard => format!("; shard {}", escaped(shard)),
    };
    body.line(&format!(
        "<dt>Computed</dt><dd>on {}, {}, in {:.1} s, begun <time \
         data-unix=\"{:.0}\">at {:.0} s (Unix time)</time>{shard}</dd>",
        escaped(&manifest.host),
        counted(manifest.threads, "thread"),
        manifest.wall_s,
        manifest.started_unix_s,
        manifest.started_unix_s,
    ));
    body.line("</dl>");
}

/// Adds warnings about missing, failed and undecided runs.
pub fn warnings(body: &mut Html, directory: &Path, data: &ReportData<'_>) {
    let manifest = data.manifest;
    let (finished, planned) = (manifest.runs_finished, manifest.runs_planned);
    let bound = if data.study.precision().is_some() { "at most " } else { "" };
    if !manifest.complete {
        let missing = planned.saturating_sub(finished);
        let fraction = 100.0 * missing as f64 / planned.max(1) as f64;
        let points = match data.incomplete.words() {
            Some(words) => format!("; {words}"),
            None => String::new(),
        };
        body.line(&format!(
            "<p class=\"warning\" id=\"missing\"><strong>Not complete.</strong> {bound}{missing} of \
             {bound}{planned} runs are missing ({fraction:.1} %){points}. The page shows the {finished} finished \
             runs. If no process is computing this study, <code \
             class=\"command\">stickslip resume {}</code> computes the rest.</p>",
            escaped(&shell_word(directory)),
        ));
    }
    let count = |label: Label| manifest.labels.get(label.name()).copied().unwrap_or(0);
    let failed = count(Label::Failed);
    if failed > 0 {
        let all = if failed == finished { "All" } else { "Some" };
        body.line(&format!(
            "<p class=\"warning\" id=\"failed\"><strong>{all} runs failed:</strong> {failed} of \
             {finished}. They widen the intervals; see the <a href=\"#notable\">errors</a>.</p>"
        ));
    }
    let flips: u64 = data.points.iter().map(|point| point.audit.flips).sum();
    let audited: u64 = data.points.iter().map(|point| point.audit.runs).sum();
    let undecided = count(Label::Undecided);
    let audit = match audited {
        0 => "no run was audited".to_owned(),
        audited => format!("{flips} of {audited} audited runs changed their label"),
    };
    body.line(&format!(
        "<p>Diagnostics: {undecided} of {finished} runs are undecided, {failed} failed, {audit}.</p>"
    ));
}

/// A column that results of earlier versions lack.
#[derive(Clone, Copy)]
struct Optional {
    name: &'static str,
    value: fn(&Vibration) -> Option<f64>,
    text: fn(Option<f64>) -> String,
}

const OPTIONAL: [Optional; 4] = [
    Optional {
        name: "runs worse than without balls [%]",
        value: |point| point.worse_fraction,
        text: percent,
    },
    Optional {
        name: "median balance quality grade G [mm/s]",
        value: |point| point.grade_mm_s[0],
        text: written,
    },
    Optional {
        name: "95 % quantile of G [mm/s]",
        value: |point| point.grade_mm_s[1],
        text: written,
    },
    Optional {
        name: "rests with overlapping balls [%]",
        value: |point| point.overlapping_fraction,
        text: percent,
    },
];

fn micro(metres: Option<f64>) -> String {
    written(metres.map(|value| 1e6 * value))
}

fn percent(fraction: Option<f64>) -> String {
    fraction.map_or_else(|| "–".to_owned(), |value| format!("{:.1}", 100.0 * value))
}

/// Adds the table of points: residual vibration first, then the ends of the runs with their intervals.
pub fn points(body: &mut Html, directory: &Path, data: &ReportData<'_>) {
    body.line("<section aria-labelledby=\"points\"><h2 id=\"points\">Points</h2>");
    let study = data.study;
    let mut head = vec!["point"];
    head.extend(study.swept().iter().map(|parameter| parameter.name.as_str()));
    let balls = study.model().balls() > 0;
    if balls {
        head.extend(["median amplitude [µm]", "95 % quantile [µm]", "no balls [µm]"]);
    }
    let known = |of: fn(&Vibration) -> Option<f64>| {
        data.points.iter().any(|point| of(&data.vibration(point)).is_some())
    };
    let optional: Vec<Optional> = OPTIONAL.into_iter().filter(|one| known(one.value)).collect();
    head.extend(optional.iter().map(|one| one.name));
    head.extend(["runs", "equilibria", "95 % interval"]);
    let moving = [Label::LimitCycle, Label::Irregular, Label::Undecided, Label::Failed];
    let words = moving.map(super::super::figures::label_words);
    head.extend(words.iter().map(String::as_str));
    let audit = study.audit().is_some();
    if audit {
        head.push("flips");
    }
    head.push("median time to rest [s]");
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
        cells.extend(point.swept.iter().map(|value| escaped(&said(value))));
        if balls {
            let [_, median, p95] = point.amplitude_m;
            cells.extend([median, p95, point.without_balls_m].map(micro));
        }
        let vibration = data.vibration(point);
        cells.extend(optional.iter().map(|one| (one.text)((one.value)(&vibration))));
        let Fraction { fraction, low, high, .. } = point.equilibrium;
        cells.push(point.runs.to_string());
        cells.push(format!("{fraction:.4}"));
        cells.push(format!("<span class=\"interval\">{low:.4} to {high:.4}</span>"));
        cells.extend(
            Label::ALL
                .iter()
                .zip(&point.labels)
                .filter(|(label, _)| moving.contains(label))
                .map(|(_, fraction)| fraction.runs.to_string()),
        );
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

/// Adds the table of the uncertain parameters that the figures omit; nothing if they show all.
pub fn other_parameters(body: &mut Html, data: &ReportData<'_>) {
    let shown = shown_parameters(data);
    let strongest = |of: &dyn Fn(&DrawnRuns) -> Option<RankCorrelation>| {
        let all = data.drawn.points.iter().filter_map(|(point, runs)| Some((point, of(runs)?)));
        let found = all.max_by(|(_, a), (_, b)| a.value.abs().total_cmp(&b.value.abs()));
        found.map_or_else(
            || "–".to_owned(),
            |(point, RankCorrelation { value, low, high })| {
                let text = format!("{value:.2} ({low:.2} to {high:.2}) at point {point}");
                text.replace('-', "\u{2212}")
            },
        )
    };
    let row = |(index, parameter): (usize, &VariedParameter)| {
        vec![
            escaped(&parameter.name),
            strongest(&|runs| runs.with_amplitude(index)),
            strongest(&|runs| runs.with_time_to_rest(index)),
        ]
    };
    let others = data.study.uncertain().iter().enumerate();
    let others = others.filter(|(index, _)| !shown.contains(index));
    let rows: Vec<Vec<String>> = others.take(MOST_ROWS).map(row).collect();
    if rows.is_empty() || data.drawn.points.is_empty() {
        return;
    }
    body.line(
        "<section aria-labelledby=\"parameters\"><h2 id=\"parameters\">Other uncertain parameters</h2>\
         <p>The strongest rank correlation of each parameter with the amplitude and with the time to rest, with its \
         95 % interval.</p>",
    );
    body.table(&["parameter", "with the amplitude", "with the time to rest"], &rows, &[0, 1, 2]);
    body.line("</section>");
}

/// Adds the table of runs that failed and of runs whose label changed in the audit.
pub fn notable(body: &mut Html, directory: &Path, data: &ReportData<'_>) {
    body.line(
        "<section aria-labelledby=\"notable\"><h2 id=\"notable\">List of failed and flipped runs</h2>",
    );
    if data.notable.is_empty() {
        let audit = if data.study.audit().is_some() { ", and no label changed" } else { "" };
        body.line(&format!("<p>None: no run failed{audit}.</p></section>"));
        return;
    }
    let head = ["run", "label", "evidence", "label in the audit", "error", "replay"];
    let dir = escaped(&shell_word(directory));
    let row = |run: &Notable| {
        let Notable { run_id, label, evidence, audited, error } = run;
        let words = |text: &str| escaped(&text.replace('_', " "));
        vec![
            run_id.to_string(),
            words(label),
            words(evidence),
            audited.as_deref().map_or_else(|| "–".to_owned(), words),
            format!("<span class=\"free\">{}</span>", escaped(&one_line(error, LONGEST_ERROR))),
            format!("<code>stickslip replay {dir} {run_id}</code>"),
        ]
    };
    let rows: Vec<Vec<String>> = data.notable.iter().map(row).collect();
    body.line(&format!(
        "<p>Runs that failed, and audited runs that have another label when they are computed more \
         precisely: {}.</p>",
        match data.runs.notable {
            all if all > rows.len() as u64 => format!("the first {} of {all}", rows.len()),
            1 => "one".to_owned(),
            all => format!("all {all}"),
        }
    ));
    body.table(&head, &rows, &[1, 2, 3, 4, 5]);
    body.line("</section>");
}

/// Returns a number with four significant digits, or a dash.
fn written(value: Option<f64>) -> String {
    value.map_or_else(|| "–".to_owned(), significant)
}
