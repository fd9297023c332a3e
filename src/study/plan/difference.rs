//! Differences between two studies, as text for users.

use serde_json::Value;

use crate::study::plan::planned_study::Study;

/// The longest value that is shown in full, in characters.
const LONGEST: usize = 60;

/// Returns every key of the resolved study files whose values differ, with both values, such as
/// `simulation.end_time_s: 16.5 -> 33.0`, in the order of the file.
pub fn difference(before: &Study, after: &Study) -> Vec<String> {
    let mut found = Vec::new();
    collect("", &before.resolved.to_value(), &after.resolved.to_value(), &mut found);
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

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::difference;
    use crate::study::Study;

    fn study(change: impl Fn(String) -> String) -> Study {
        let text = "schema: 1\nname: one\nseed: 7\nmodel: {kind: ball_balancer}\n\
                    sweep: [{grid: {speed_rad_s: [-160.0, -200.0]}}]\n\
                    initial_conditions: {design: {monte_carlo: {samples: 4}}}\n";
        Study::parse(Path::new("one.yaml"), change(text.to_owned())).unwrap()
    }

    #[test]
    fn what_differs_is_named_with_both_values() {
        let before = study(|text| text);
        assert!(difference(&before, &study(|text| format!("# a comment\n{text}"))).is_empty());
        let changed = |from: &'static str, to: &'static str| {
            let after = study(|text| {
                assert!(text.contains(from));
                text.replace(from, to)
            });
            difference(&before, &after)
        };
        assert_eq!(changed("seed: 7", "seed: 8"), ["seed: 7 -> 8"]);
        assert_eq!(
            changed("-200.0]", "-200.0, -240.0]"),
            ["sweep[0].grid.speed_rad_s: [-160.0,-200.0] -> [-160.0,-200.0,-240.0]"]
        );
        let other_friction = changed(
            "kind: ball_balancer",
            "kind: ball_balancer, friction: {viscous: {viscous_coefficient_n_s_m: 1.0e-4}}",
        );
        assert!(
            other_friction.iter().any(|line| line.starts_with("model.friction")),
            "{other_friction:?}"
        );
        assert_eq!(
            changed("monte_carlo: {samples: 4}", "sobol: {samples: 4}"),
            [
                "initial_conditions.design.monte_carlo: {\"samples\":4} -> not given",
                "initial_conditions.design.sobol: not given -> {\"samples\":4}"
            ]
        );
    }
}
