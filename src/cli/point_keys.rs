//! A point of the sweep in messages and JSON: its number and the values of its swept parameters.

use serde_json::{Value, json};

use crate::study::{ParameterValue, VariedParameter};

/// Returns the start of a point's JSON object: its number and the values of its swept parameters.
pub fn point_keys(point_id: u64, columns: &[VariedParameter], swept: &[ParameterValue]) -> Value {
    let mut object = json!({"point_id": point_id});
    for (column, value) in columns.iter().zip(swept) {
        object[&column.name] = match value {
            ParameterValue::Number(number) => json!(number),
            ParameterValue::Text(text) => json!(text),
        };
    }
    object
}

/// Returns the values of the swept parameters for a message, each after a blank, as ` speed_rad_s=-160` or, with a unit
/// that the study chooses, ` speed=-1528 rpm`. The values are those of [`crate::study::Study::shown`].
pub fn swept_text(columns: &[VariedParameter], shown: &[String]) -> String {
    let each = columns.iter().zip(shown);
    each.map(|(column, value)| match &column.shown {
        Some(unit) => format!(" {}={value} {}", column.short_name(), unit.symbol),
        None => format!(" {}={value}", column.name),
    })
    .collect()
}

/// Returns the object `first` with the keys of the object `second` added.
pub fn merged(mut first: Value, second: Value) -> Value {
    if let (Value::Object(first), Value::Object(second)) = (&mut first, second) {
        first.extend(second);
    }
    first
}
