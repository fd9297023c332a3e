//! The numbers of docs/open-questions.md come from docs/records/open-questions.json, which
//! `scripts/open-questions` computes from the studies in studies/open-questions.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use serde_json::Value;
use stickslip::study::Study;

use super::generated::{compare_or_write_part, parts_of};
use super::records::stale;

const PAGE: &str = "docs/open-questions.md";
const STUDIES: &str = "studies/open-questions";

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).to_owned()
}

/// Returns the studies of the questions, relative to the root.
fn studies() -> Vec<String> {
    let names = fs::read_dir(root().join(STUDIES))
        .expect("studies")
        .map(|entry| entry.expect("a file").file_name().into_string().expect("a plain name"));
    let mut studies: Vec<String> = names
        .filter(|name| name.ends_with(".yaml"))
        .map(|name| format!("{STUDIES}/{name}"))
        .collect();
    studies.sort();
    studies
}

/// Returns the values of the record, which is of all studies as they are now.
fn record() -> Value {
    let text =
        fs::read_to_string(root().join("docs/records/open-questions.json")).expect("a record");
    let mut record: Value = serde_json::from_str(&text).expect("JSON");
    let of = record["of"].as_array().expect("a list");
    let remedy = "`scripts/open-questions` computes the record anew";
    for one in of {
        if let Some(why) = stale(one, one["study"].as_str().expect("a study")) {
            panic!("{why}; {remedy}");
        }
    }
    let known: BTreeSet<&str> = of.iter().filter_map(|one| one["study"].as_str()).collect();
    let due = studies();
    assert_eq!(known, due.iter().map(String::as_str).collect(), "{remedy}");
    record["values"].take()
}

/// Formats a cell of the record: words, or a number, with its interval if it has one.
fn cell(cell: &Value) -> String {
    if let Value::String(words) = cell {
        return words.clone();
    }
    let digits = cell["digits"].as_u64().expect("decimals") as usize;
    let number = |key: &str| {
        let text = format!("{:.digits$}", cell[key].as_f64()?);
        // A negative number that is rounded to zero has no sign.
        let zero = text.bytes().all(|byte| matches!(byte, b'-' | b'0' | b'.'));
        Some(if zero { text.trim_start_matches('-').to_owned() } else { text })
    };
    let Some(value) = number("value") else {
        return "–".to_owned();
    };
    match (number("low"), number("high")) {
        (Some(low), Some(high)) => format!("{value} ({low} to {high})"),
        _ => value,
    }
}

fn row(cells: impl Iterator<Item = String>) -> String {
    format!("| {} |\n", cells.collect::<Vec<_>>().join(" | "))
}

/// Formats a table of the record in Markdown.
fn markdown(table: &Value) -> String {
    let list = |value: &Value| value.as_array().expect("a list").clone();
    let head = list(&table["head"]);
    let rows = list(&table["rows"]).into_iter().map(|one| row(list(&one).iter().map(cell)));
    let line = format!("|{}\n", "---|".repeat(head.len()));
    format!("\n{}{line}{}", row(head.iter().map(cell)), rows.collect::<String>())
}

/// Every table and number of the page is that of the record, whose studies have not changed since.
#[test]
fn the_open_questions() {
    let record = record();
    let mut found = 0;
    for name in parts_of(PAGE) {
        let (table, number) = (&record["tables"][name], &record["numbers"][name]);
        let text = match (table, number) {
            (Value::Object(_), Value::Null) => markdown(table),
            (Value::Null, Value::Object(_)) => cell(number),
            _ => panic!("{name} is not one table or one number of the record"),
        };
        compare_or_write_part(PAGE, name, &text);
        found += 1;
    }
    assert!(found > 20);
    let tables = record["tables"].as_object().expect("tables");
    let unused = tables.keys().find(|name| !parts_of(PAGE).contains(&name.as_str()));
    assert_eq!(unused, None, "a table that is not on the page");
}

/// The studies of the questions load, resolve to themselves, have the names of their files, and
/// cover both normal forces.
#[test]
fn studies_of_the_open_questions() {
    for path in studies() {
        let study = Study::load(&root().join(&path)).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(path, format!("{STUDIES}/{}.yaml", study.name()));
        let again = Study::parse(Path::new("resolved.yaml"), study.resolved_yaml());
        assert_eq!(again.unwrap_or_else(|error| panic!("{error}")).hash(), study.hash());
        assert!(study.planned_run(study.run_count() - 1).case.is_ok(), "{path}");
        assert!(study.swept().iter().any(|one| one.name == "normal_force"), "{path}");
    }
}

#[test]
fn cells_are_formatted() {
    let number =
        |value: Value| serde_json::json!({"value": value, "low": -0.04, "high": 1.26, "digits": 1});
    assert_eq!(cell(&number(0.5.into())), "0.5 (0.0 to 1.3)");
    assert_eq!(cell(&number(Value::Null)), "–");
    assert_eq!(cell(&"comes to rest".into()), "comes to rest");
}
