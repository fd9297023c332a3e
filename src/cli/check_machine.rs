//! The machine of a study for `check`: every parameter with its unit and the origin of its value.

use serde_json::{Value, json};

use crate::numbers::{counted, short};
use crate::printed_table::text_table;
use crate::responses::add_known;
use crate::study::{ListedParameter, ParameterValue, Study, Unit, short_name};

/// Returns the parameters as lines of text.
pub(super) fn machine_text(study: &Study) -> String {
    let row = |entry: ListedParameter| {
        let unit = study.units().of_parameter(&entry.name);
        let name = unit.map_or_else(|| entry.name.clone(), |_| short_name(&entry.name, entry.unit));
        [String::new(), name, value(&entry, unit), origin(&entry, unit)]
    };
    let rows: Vec<_> = study.parameters().into_iter().map(row).collect();
    format!("machine ({})\n{}", study.model().kind().name, text_table(&rows, &[0, 1, 2, 3]))
}

/// Returns the value with its unit, or the range of a value that is swept or part of a design.
fn value(parameter: &ListedParameter, shown: Option<&Unit>) -> String {
    let unit = match shown.map_or(parameter.unit, |unit| unit.symbol.as_str()) {
        "" | "1" => String::new(),
        unit => format!(" {unit}"),
    };
    let long = |value: f64| long(shown.map_or(value, |unit| unit.of(value)));
    let swept = parameter.swept.as_ref().and_then(|swept| swept.range);
    match (parameter.design.or(swept), parameter.value) {
        (Some([low, high]), _) if low == high => format!("{}{unit}", long(low)),
        (Some([low, high]), _) => format!("{} to {}{unit}", long(low), long(high)),
        (None, ParameterValue::Number(number)) => format!("{}{unit}", long(number)),
        (None, ParameterValue::Text(text)) => text.to_owned(),
    }
}

/// Formats a number of a study file with all its digits, and a computed one with few.
fn long(number: f64) -> String {
    let all = ParameterValue::Number(number).to_string();
    if all.len() <= 12 { all } else { short(number) }
}

/// Returns the origin of the value in words; nothing if the study gives a fixed value.
fn origin(parameter: &ListedParameter, shown: Option<&Unit>) -> String {
    let mut words = Vec::new();
    if parameter.is_default && !parameter.is_varied() {
        words.push("(default)".to_owned());
    }
    if let Some(swept) = &parameter.swept {
        words.push(format!("swept, {}", counted(swept.count as u64, "value")));
    }
    if parameter.design.is_some() {
        words.push("design".to_owned());
    }
    if let Some(uncertain) = parameter.uncertain {
        let shown = shown.filter(|_| !uncertain.factor);
        let [low, high] = uncertain.range.map(|end| short(shown.map_or(end, |unit| unit.of(end))));
        let what = if uncertain.factor { "uncertain, times" } else { "uncertain, median;" };
        words.push(format!("{what} {low} to {high} in 95 % of the runs"));
    }
    words.join("; ")
}

/// Returns the parameters as JSON.
pub(super) fn machine_json(study: &Study) -> Value {
    study.parameters().iter().map(parameter_json).collect()
}

fn parameter_json(parameter: &ListedParameter) -> Value {
    let unit = Some(parameter.unit).filter(|unit| !unit.is_empty());
    let mut object = json!({
        "name": parameter.name,
        "value": parameter.value,
        "unit": unit,
        "default": parameter.is_default && !parameter.is_varied(),
    });
    let swept = parameter.swept.as_ref().map(|swept| {
        let [from, to] = [0, 1].map(|end| swept.range.map(|range| range[end]));
        json!({"values": swept.count, "from": from, "to": to})
    });
    let uncertain = parameter.uncertain.map(|uncertain| {
        let [low, high] = uncertain.range;
        json!({"low": low, "high": high, "factor": uncertain.factor})
    });
    let design = parameter.design.map(|[from, to]| json!({"from": from, "to": to}));
    for (key, value) in [("swept", swept), ("uncertain", uncertain), ("design", design)] {
        add_known(&mut object, key, value);
    }
    object
}
