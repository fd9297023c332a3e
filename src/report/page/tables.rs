//! The text and tables of the page: facts of the run, missing runs, parameters, failed and flipped runs.

use std::path::Path;

use super::html::{Html, escaped};
use crate::analysis::RankCorrelation;
use crate::classification::Label;
use crate::model::Method;
use crate::numbers::counted;
use crate::report::data::{DrawnRuns, NotableRun, ReportData};
use crate::report::figures::shown_parameters;
use crate::sanitize::{one_line, shell_word};
use crate::study::VariedParameter;

/// The number of characters of a run's error message that are shown.
const LONGEST_ERROR: usize = 400;
/// The largest number of rows of a table.
pub const MOST_ROWS: usize = 200;

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
        study.model().kind().name.replace('_', " "),
        study.model().friction().name(),
        data.ends_in_words(),
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
    let mut computed = vec![format!("on {}", escaped(&manifest.host))];
    // The tables of a study that was killed lack the number of threads and the time that it took.
    if manifest.threads > 0 {
        computed.push(counted(manifest.threads, "thread"));
    }
    if manifest.wall_s > 0.0 {
        computed.push(format!("in {:.1} s", manifest.wall_s));
    }
    let shard = match manifest.shard.as_str() {
        "1/1" => String::new(),
        shard => format!("; shard {}", escaped(shard)),
    };
    body.line(&format!(
        "<dt>Computed</dt><dd>{}, begun <time data-unix=\"{:.0}\">at {:.0} s (Unix time)</time>{shard}</dd>",
        computed.join(", "),
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
    let row = |run: &NotableRun| {
        let NotableRun { run_id, label, evidence, audited, error } = run;
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
