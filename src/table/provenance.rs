//! The provenance of a table: the JSON under the metadata key `stickslip` of every data file.
//!
//! It contains only what determines the data, without times or host, so that equal studies have
//! identical data files.

use serde_json::{Map, Value, json};

use crate::study::Study;

/// Version of this program.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");
/// Commit that this program was built from; `unknown` outside a repository.
pub const COMMIT: &str = env!("STICKSLIP_COMMIT");

/// Version of the layout of the tables and of this JSON.
pub const FORMAT: u32 = 1;

/// Returns the provenance of a table of a study.
pub fn provenance(study: &Study, table: &str) -> String {
    facts(study, table).to_string()
}

/// Returns the provenance of a table that also depends on command-line options.
pub fn provenance_with(study: &Study, table: &str, options: &Value) -> String {
    let mut facts = facts(study, table);
    facts["options"] = options.clone();
    facts.to_string()
}

fn facts(study: &Study, table: &str) -> Value {
    json!({
        "format": FORMAT,
        "table": table,
        "program": "stickslip",
        "version": VERSION,
        "commit": COMMIT,
        "study": study.name(),
        "study_hash": study.hash(),
        "seed": study.seed(),
        "study_yaml": study.resolved_yaml(),
        "shown_units": shown_units(study),
    })
}

/// Returns the units in which people read swept parameters and vibration, each with its value in SI units, by name.
fn shown_units(study: &Study) -> Map<String, Value> {
    let units = study.units();
    let swept = study.swept().iter();
    let swept =
        swept.filter_map(|one| Some((one.name.clone(), units.of_parameter(&one.name)?.clone())));
    let all = swept
        .chain([("speed".to_owned(), units.speed()), ("vibration".to_owned(), units.vibration())]);
    all.map(|(name, unit)| (name, json!([unit.symbol, unit.si]))).collect()
}
