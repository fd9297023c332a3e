//! The page of a search for the best design: notes, the best design beside the reference, and figures.

use std::path::Path;

use serde_json::Value;

use super::conclusion::conclusion_of_search;
use super::html::{Html, escaped};
use super::{assembled, drawn_figures, links};
use crate::numbers::{counted, significant};
use crate::report::chart::Figure;
use crate::report::optimum::{OptimumData, notes};
use crate::sanitize::shown_path;

/// Returns the page of a directory that `stickslip optimize` has written.
pub fn optimum_page(directory: &Path, data: &OptimumData, figures: &[Figure]) -> String {
    let study = &data.study;
    let mut body = Html::default();
    body.line("<header>");
    body.element("h1", "", &format!("{}: search for the best design", study.name()));
    facts(&mut body, data);
    for note in notes(data) {
        body.line(&format!("<p class=\"warning note\">{}</p>", escaped(&note)));
    }
    links(&mut body, &[("best", "Best design")], figures, &[("study", "Study")]);
    conclusion_of_search(&mut body, data);
    best(&mut body, data);
    drawn_figures(&mut body, figures);
    let place = shown_path(&directory.join("evaluations.parquet"));
    let place = format!("the key `stickslip` in the metadata of {place}");
    assembled(study, &place, directory, body, figures)
}

/// Adds study, objectives, limits and size of the search.
fn facts(body: &mut Html, data: &OptimumData) {
    let objectives = data.optimization.objectives.iter().map(|objective| {
        let verb = if objective.maximize { "maximize" } else { "minimize" };
        format!("{verb} {}", described(data, objective.response))
    });
    let limits = data.optimization.limits.iter().map(|limit| {
        let relation = if limit.least { "at least" } else { "at most" };
        let (_, unit) = data.response(limit.response);
        let value = significant(unit.of(limit.value));
        let what = described(data, limit.response);
        format!("{what} {relation} {value} {}", unit.symbol).trim_end().to_owned()
    });
    let limits: Vec<String> = limits.collect();
    let ended = data.optimum.as_ref().and_then(|optimum| optimum["search"]["ended"].as_str());
    let facts = [
        ("Study", format!("{}, seed {}", data.study.name(), data.study.seed())),
        ("Objective", objectives.collect::<Vec<_>>().join("; ")),
        ("Limits", if limits.is_empty() { "none".to_owned() } else { limits.join("; ") }),
        (
            "Search",
            format!(
                "{} at {} each; {}",
                counted(data.evaluations.len() as u64, "design"),
                counted(data.study.point_count(), "point"),
                ended.unwrap_or("not finished")
            ),
        ),
    ];
    body.line("<dl class=\"facts\">");
    for (name, text) in facts {
        body.line(&format!("<dt>{name}</dt><dd>{}</dd>", escaped(&text)));
    }
    body.line("</dl>");
}

/// Returns name and meaning of a response.
fn described(data: &OptimumData, response: usize) -> String {
    let response = &data.study.responses()[response];
    format!("{} ({})", response.name, response.meaning_in(&data.study.units().vibration()))
}

/// Adds the table of the best design and the reference design.
fn best(body: &mut Html, data: &OptimumData) {
    body.line("<section aria-labelledby=\"best\"><h2 id=\"best\">Best design</h2>");
    let designs = [("best", "best design"), ("compare_with", "reference design")];
    let known = designs.into_iter().filter_map(|(key, name)| Some((name, data.design(key)?)));
    let known: Vec<(&str, &Value)> = known.collect();
    if known.is_empty() {
        let text = match (&data.optimum, data.optimization.objectives.len()) {
            (None, _) => "The search has not ended: there are no final runs yet.",
            (Some(_), 1) => "The search has no final runs.",
            _ => "With two objectives there is no single best design: see the Pareto front.",
        };
        body.line(&format!("<p>{text}</p></section>"));
        return;
    }
    let ratios =
        data.optimum.as_ref().and_then(|optimum| optimum["best_over_compare_with"].as_array());
    let mut head = vec!["quantity"];
    head.extend(known.iter().map(|(name, _)| *name));
    head.extend(ratios.map(|_| "best / reference"));
    let mut rows: Vec<Vec<String>> = Vec::new();
    let cells = |name: String, cell: &dyn Fn(&Value) -> String| {
        let mut row = vec![escaped(&name)];
        row.extend(known.iter().map(|(_, design)| cell(design)));
        row
    };
    for (index, response) in data.study.responses().iter().enumerate() {
        if known.iter().all(|(_, design)| design["responses"].get(&response.name).is_none()) {
            continue;
        }
        let (name, unit) = data.response(index);
        let title = match unit.symbol.as_str() {
            "" => name.to_owned(),
            symbol => format!("{name} [{symbol}]"),
        };
        let factor = unit.si.recip();
        let mut row = cells(title, &|design| estimate(&design["responses"][name], factor));
        row.extend(ratios.map(|ratios| {
            let of = ratios.iter().find(|ratio| ratio["response"] == name);
            of.map_or_else(|| "–".to_owned(), |ratio| estimate(&ratio["ratio"], 1.0))
        }));
        rows.push(row);
    }
    let pad = |mut row: Vec<String>| {
        row.resize(head.len(), String::new());
        row
    };
    for variable in data.study.variables() {
        let title = variable.shown_name();
        let cell = |design: &Value| match &design["values"][variable.name()] {
            Value::Number(number) => {
                value(&number.as_f64().map(|number| variable.shown_number(number)).into())
            }
            other => value(other),
        };
        rows.push(pad(cells(title, &cell)));
    }
    rows.push(pad(cells("meets all limits".to_owned(), &|design| {
        if design["limits_met"] == true { "yes" } else { "no" }.to_owned()
    })));
    rows.push(pad(cells("runs (failed)".to_owned(), &|design| {
        format!("{} ({})", design["runs"], design["failed"])
    })));
    body.line(
        "<p>Values of the final runs with 95 % intervals. They are independent of the runs that chose the design.</p>",
    );
    body.table(&head, &rows, &[0]);
    body.line("</section>");
}

/// Returns an estimate with its interval.
fn estimate(estimate: &Value, factor: f64) -> String {
    let number = |key: &str| estimate[key].as_f64().map(|value| significant(factor * value));
    match (number("value"), number("low"), number("high")) {
        (Some(value), Some(low), Some(high)) => {
            format!("{value} <span class=\"interval\">({low} to {high})</span>")
        }
        (Some(value), ..) => value,
        _ => {
            let reason = estimate["reason"].as_str().unwrap_or("–");
            format!("<span class=\"free\">{}</span>", escaped(reason))
        }
    }
}

/// Returns the value of a variable.
fn value(value: &Value) -> String {
    match (value.as_f64(), value.as_str()) {
        (Some(number), _) if number.fract() == 0.0 && number.abs() < 1e9 => {
            format!("{number}").replace('-', "\u{2212}")
        }
        (Some(number), _) => significant(number),
        (_, Some(text)) => escaped(text),
        _ => "–".to_owned(),
    }
}
