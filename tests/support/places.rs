//! The places of all parts of a JSON value.

use serde_json::Value;

/// Returns the JSON pointers of a value and of its parts; lists count up to this number of items.
pub fn places(value: &Value, items: usize) -> Vec<String> {
    let mut all = vec![String::new()];
    let parts: Vec<(String, &Value)> = match value {
        Value::Object(fields) => fields.iter().map(|(key, value)| (key.clone(), value)).collect(),
        Value::Array(values) => {
            (0..items).zip(values).map(|(place, value)| (place.to_string(), value)).collect()
        }
        _ => Vec::new(),
    };
    for (key, value) in parts {
        let key = key.replace('~', "~0").replace('/', "~1");
        all.extend(places(value, items).into_iter().map(|below| format!("/{key}{below}")));
    }
    all
}
