//! Facts of a study, in words and as JSON.

use serde_json::Value;

/// Facts of a study for people, each with a name and words, and the same facts as JSON.
pub(super) struct StudyFacts {
    pub(super) words: Vec<(&'static str, String)>,
    pub(super) json: Value,
}
