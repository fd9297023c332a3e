//! The keys in which two studies differ, as text for users.

use serde_json::Value;

use crate::study::file::resolved_yaml::to_value;
use crate::study::plan::planned_study::Study;

/// The longest value that is shown in full, in characters.
const LONGEST: usize = 60;

/// Returns every key of the resolved study files whose values differ, with both values, such as
/// `simulation.end_time_s: 16.5 -> 33.0`, in the order of the file.
pub fn changed_keys(before: &Study, after: &Study) -> Vec<String> {
    let mut found = Vec::new();
    collect("", &to_value(&before.resolved.file), &to_value(&after.resolved.file), &mut found);
    found
}

fn collect(path: &str, before: &Value, after: &Value, found: &mut Vec<String>) {
    let below = |key: &str| if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") };
    match (before, after) {
        (Value::Object(left), Value::Object(right)) => {
            for (key, value) in left {
                collect(&below(key), value, right.get(key).unwrap_or(&Value::Null), found);
            }
            for (key, value) in right.iter().filter(|(key, _)| !left.contains_key(*key)) {
                collect(&below(key), &Value::Null, value, found);
            }
        }
        (Value::Array(left), Value::Array(right))
            if left.len() == right.len() && left.iter().any(|item| !is_plain(item)) =>
        {
            for (index, (left, right)) in left.iter().zip(right).enumerate() {
                collect(&format!("{path}[{index}]"), left, right, found);
            }
        }
        (left, right) if left == right => {}
        (left, right) => found.push(format!("{path}: {} -> {}", shown(left), shown(right))),
    }
}

fn is_plain(value: &Value) -> bool {
    !matches!(value, Value::Object(_) | Value::Array(_))
}

fn shown(value: &Value) -> String {
    if value.is_null() {
        return "not given".to_owned();
    }
    let text = value.to_string();
    match text.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{}...", &text[..end]),
        None => text,
    }
}
