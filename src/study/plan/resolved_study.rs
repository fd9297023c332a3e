//! A resolved study as a study file with all defaults, its hash, and the keys in which two studies differ.

use std::path::Path;

use serde_json::Value;
use sha2::{Digest, Sha256};

use crate::study::error::StudyError;
use crate::study::file::resolved_yaml::{to_value, to_yaml};
use crate::study::file::study_file::StudyFile;
use crate::study::plan::planned_runs::Plan;
use crate::study::plan::planned_study::Study;
use crate::study::sampling::initial_box::general_axes;

impl Study {
    /// Returns this study with another master seed; everything else is unchanged.
    ///
    /// # Errors
    /// Returns only errors that parsing the study itself would return.
    pub fn with_seed(&self, seed: u64) -> Result<Study, StudyError> {
        let file = StudyFile { seed, ..self.resolved.clone() };
        Study::parse(Path::new(self.name()), to_yaml(&file))
    }
}

impl Plan {
    /// Returns the complete study file as plain values.
    pub(crate) fn resolved_file(&self) -> Value {
        to_value(&self.resolved)
    }

    /// Returns the complete study file in a canonical form, with all defaults and with inline
    /// tables. Parsing it gives the same study with the same hash.
    pub fn resolved_yaml(&self) -> String {
        self.resolved_yaml.get_or_init(|| to_yaml(&self.resolved)).clone()
    }

    /// Returns the SHA-256 hash, in hexadecimal, of everything that determines the runs. It
    /// excludes the name, format and comments of the file, and the keys `name`, `expect`, `design`,
    /// `responses`, `optimize`, `identify` and `units`.
    pub fn hash(&self) -> String {
        let compute = || {
            let mut determining = StudyFile {
                name: String::new(),
                expect: None,
                design: None,
                responses: None,
                optimize: None,
                identify: None,
                units: None,
                ..self.resolved.clone()
            };
            // Ranges of all balls concern designs; the balls of this study have their own ranges.
            if let Some(ranges) = &mut determining.initial_conditions.start_box {
                let general = general_axes(&self.base.model);
                ranges.retain(|name, _| !general.contains(&name.as_str()));
            }
            let mut digest = Sha256::new();
            digest.update(b"stickslip study 1\n");
            digest.update(to_value(&determining).to_string());
            if let Some(version) = self.base.model.own_version() {
                digest.update(format!("\nversion of the equations {version}"));
            }
            digest.finalize().iter().map(|byte| format!("{byte:02x}")).collect()
        };
        self.hash.get_or_init(compute).clone()
    }
}

/// The longest value that is shown in full, in characters.
const LONGEST: usize = 60;

/// Returns every key of the resolved study files whose values differ, with both values, such as
/// `simulation.end_time_s: 16.5 -> 33.0`, in the order of the file.
pub fn changed_keys(before: &Study, after: &Study) -> Vec<String> {
    let mut found = Vec::new();
    collect("", &to_value(&before.resolved), &to_value(&after.resolved), &mut found);
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
