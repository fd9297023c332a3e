//! The provenance of a table: the JSON under the metadata key `stickslip` of every data file.
//!
//! It contains only what determines the data, without times or host, so that equal studies have
//! identical data files.

use serde_json::{Map, Value, json};

use crate::study::{Study, Unit, VariedParameter};

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

/// Returns the units in which people read swept parameters, by column, and speeds and vibration, each with its value in SI
/// units. A parameter of another system may have the name of a quantity.
fn shown_units(study: &Study) -> Value {
    let units = study.units();
    let with_si = |unit: &Unit| json!([unit.symbol, unit.si]);
    let swept = study.swept().iter();
    let parameter = |varied: &VariedParameter| {
        Some((varied.name.clone(), with_si(units.of_parameter(&varied.name)?)))
    };
    json!({
        "parameters": swept.filter_map(parameter).collect::<Map<_, _>>(),
        "speed": with_si(&units.speed()),
        "vibration": with_si(&units.vibration()),
    })
}
