//! The further errors of a wrong study: each faulty key is left out in turn, and the rest is read again.
//!
//! An error that could follow from a key that was left out is not listed: one at the same key or above it, and one that is
//! found between keys and depends on such a key.

use crate::study::error::StudyError;
use crate::study::file::key_path::{KeyPath, Segment};
use crate::study::file::yaml_tree::{Content, YamlNode};

/// The largest number of errors that are listed.
const MOST: usize = 20;

/// Keys on which checks of other keys depend, with these other keys.
const DEPENDENT: [(&str, &[&str]); 7] = [
    ("model.kind", &[""]),
    ("model.friction", &["sweep", "uncertain", "design", "identify"]),
    ("model.parameters.balls", &["initial_conditions", "sweep", "uncertain", "design"]),
    ("model.speed_profile", &["model", "simulation", "sweep", "uncertain", "responses"]),
    ("model.protocol", &["model", "simulation", "sweep", "uncertain", "responses"]),
    ("simulation", &["model", "responses", "precision", "audit"]),
    ("initial_conditions", &["sweep"]),
];

/// Where an error was found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Found {
    /// In the text, or in a key or value alone.
    InKey,
    /// Between keys, or in a table.
    BetweenKeys,
}

/// Returns the error with all further errors; `read` reads the study without these keys.
pub(crate) fn with_further_errors(
    first: StudyError,
    read: impl Fn(&[KeyPath]) -> Result<(), (Found, StudyError)>,
) -> StudyError {
    let mut left_out = Vec::new();
    let mut others: Vec<StudyError> = Vec::new();
    let mut last = first.clone();
    while others.len() + 1 < MOST {
        let Some(path) = faulty_key(&last).filter(|path| !left_out.contains(path)) else { break };
        left_out.push(path);
        let Err((found, error)) = read(&left_out) else { break };
        let is_consequence = match faulty_key(&error) {
            Some(path) => left_out.iter().any(|other| {
                other.0.starts_with(&path.0) || found == Found::BetweenKeys && depends(&path, other)
            }),
            None => true,
        };
        if !is_consequence {
            others.push(error.clone());
        }
        last = error;
    }
    others.push(first);
    others.sort_by_key(|error| (error.line(), error.column()));
    let first = others.remove(0);
    first.with_others(others)
}

/// Returns whether a check of one key depends on another key.
fn depends(path: &KeyPath, other: &KeyPath) -> bool {
    let below = |path: &KeyPath, key: &str| {
        path.to_string()
            .strip_prefix(key)
            .is_some_and(|rest| key.is_empty() || rest.is_empty() || rest.starts_with(['.', '[']))
    };
    DEPENDENT.iter().any(|(key, keys)| below(other, key) && keys.iter().any(|key| below(path, key)))
}

/// Returns the path of the faulty key, without an item of a list at its end; `None` if there is no such key in the file.
fn faulty_key(error: &StudyError) -> Option<KeyPath> {
    let is_missing = error.problem().starts_with("missing key");
    if error.key().is_empty() || error.line().is_none() || is_missing {
        return None;
    }
    let mut path = KeyPath::parse(error.key())?;
    while let Some(Segment::Item(_)) = path.0.last() {
        path.0.pop();
    }
    (!path.0.is_empty()).then_some(path)
}

/// Leaves a key out of a tree. A top-level key that every study needs gets a value instead.
pub(crate) fn leave_out(root: &mut YamlNode, path: &KeyPath) {
    let Some((Segment::Key(name), above)) = path.0.split_last() else { return };
    let needed = match (name.as_str(), above.is_empty()) {
        ("schema", true) => Some(Content::Natural(1)),
        ("name", true) => Some(Content::Text("study".to_owned())),
        ("seed", true) => Some(Content::Natural(0)),
        _ => None,
    };
    let Some(YamlNode { content: Content::Map(entries), .. }) = root.at_mut(above) else { return };
    match (entries.iter_mut().find(|(key, _)| key.name() == name), needed) {
        (Some((_, value)), Some(needed)) => value.content = needed,
        _ => entries.retain(|(key, _)| key.name() != name),
    }
}
