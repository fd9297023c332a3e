//! The pages name every key of a study file and every column of a table.

use std::collections::BTreeSet;
use std::path::Path;

use serde_json::Value;
use stickslip::study::json_schema;

use super::{EQUILIBRIA, STUDY_FILE, SYSTEM_FILES};
use crate::cli::support::table;

const RESULTS: &str = include_str!("../../docs/results.md");
const LABELS: [&str; 8] = [
    "equilibrium",
    "limit_cycle",
    "periodic",
    "creep",
    "quasi_periodic",
    "irregular",
    "undecided",
    "failed",
];

/// Returns whether a part of a name is the number of a ball.
fn is_number(part: &str) -> bool {
    part.len() == 1 && part.bytes().all(|byte| byte.is_ascii_digit())
}

/// Returns a column in the notation of the pages: `K` for the number of a ball, `J_K` for those of two balls, `<label>` for
/// a label.
fn as_written(column: &str) -> String {
    let mut parts: Vec<&str> = column.split('_').collect();
    for place in 0..parts.len() {
        let of_two = parts.get(place + 1).is_some_and(|next| is_number(next));
        if is_number(parts[place]) {
            parts[place] = if of_two { "J" } else { "K" };
        }
    }
    let name = parts.join("_");
    let of_label = LABELS.iter().find_map(|label| {
        let rest = name.strip_prefix(label)?;
        ["_runs", "_low", "_high"].contains(&rest).then_some(rest)
    });
    of_label.map_or_else(|| name.clone(), |rest| format!("<label>{rest}"))
}

/// Compares the columns of all tables in a folder with the pages about them.
pub fn columns_are_on_pages(folder: &Path) {
    let mut tables = 0;
    for entry in std::fs::read_dir(folder).expect("tables") {
        let path = entry.expect("a file").path();
        if path.extension().is_none_or(|ending| ending != "parquet") {
            continue;
        }
        tables += 1;
        for field in table(&path).schema().fields() {
            let name = format!("`{}`", as_written(field.name()));
            // Swept parameters are on the page about study files.
            let found = [RESULTS, EQUILIBRIA, STUDY_FILE].iter().any(|page| page.contains(&name));
            assert!(found, "{}: {name} is on no page", path.display());
        }
    }
    assert!(tables > 1, "{} tables in {}", tables, folder.display());
}

fn keys_of(schema: &Value, keys: &mut BTreeSet<String>) {
    match schema {
        Value::Object(entries) => {
            for (key, value) in entries {
                if let ("properties", Value::Object(properties)) = (key.as_str(), value) {
                    keys.extend(properties.keys().cloned());
                }
                keys_of(value, keys);
            }
        }
        Value::Array(values) => values.iter().for_each(|value| keys_of(value, keys)),
        _ => {}
    }
}

#[test]
fn keys_of_files_are_on_their_pages() {
    let mut keys = BTreeSet::new();
    keys_of(&json_schema(), &mut keys);
    assert!(keys.len() > 80, "{} keys", keys.len());
    for key in keys {
        // A parameter of one ball is on the page as that of all balls.
        let parts: Vec<&str> = key.split('_').filter(|part| !is_number(part)).collect();
        // The unit 1/s also has a number.
        let forms = [key.clone(), parts.join("_")].map(|key| {
            [format!("`{key}`"), format!("`{key}."), format!(".{key}`"), format!("{key}: ")]
        });
        let is_on = |page: &str| forms.iter().flatten().any(|form| page.contains(form.as_str()));
        let found = is_on(STUDY_FILE) || is_on(SYSTEM_FILES);
        assert!(found, "`{key}` is not on the page");
    }
}

#[test]
fn columns_have_the_notation_of_the_pages() {
    assert_eq!(as_written("ball_speed_2_rad_s"), "ball_speed_K_rad_s");
    assert_eq!(as_written("gap_1_2_rad"), "gap_J_K_rad");
    assert_eq!(as_written("limit_cycle_low"), "<label>_low");
    assert_eq!(as_written("equilibrium_fraction"), "equilibrium_fraction");
}
