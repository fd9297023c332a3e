//! The error message of an invalid study: the place, what was found, and what is allowed.

use std::fmt;
use std::path::{Path, PathBuf};

pub(crate) use crate::numbers::describe_number;
pub(crate) use crate::sanitize::shorten;
use crate::sanitize::shown_path;
pub(crate) use crate::tabular::Fault;

/// Why a study cannot be used: a message with file, line, key, the value found and the values allowed, and the messages of
/// further errors that do not depend on it.
///
/// An example of the printed message:
///
/// ```text
/// studies/a.yaml:12:5: `model.parameters.table_mas_kg`: unknown key
///   found:   table_mas_kg
///   allowed: table_mass_kg (did you mean this?), stiffness_n_m, ...
///   12 |     table_mas_kg: 0.324
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StudyError(Box<Message>);

#[derive(Clone, Debug, PartialEq, Eq)]
struct Message {
    file: PathBuf,
    place: Option<Location>,
    key: String,
    fault: Fault,
    snippet: Option<String>,
    others: Vec<StudyError>,
}

/// A position in a text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Location {
    /// Line, counted from one.
    pub line: usize,
    /// Column in characters, counted from one.
    pub column: usize,
}

impl StudyError {
    /// Creates a message without a place inside the file.
    pub(crate) fn about_file(file: &Path, fault: Fault) -> StudyError {
        StudyError::new(file, None, String::new(), fault, None)
    }

    /// Creates a message about a key of a study file, or about a row and column of a table.
    pub(crate) fn new(
        file: &Path,
        place: Option<Location>,
        key: String,
        fault: Fault,
        line_text: Option<&str>,
    ) -> StudyError {
        StudyError(Box::new(Message {
            file: file.to_path_buf(),
            place,
            key,
            fault,
            snippet: line_text.map(shorten),
            others: Vec::new(),
        }))
    }

    /// Returns this message with another fault at the same place.
    pub(crate) fn with_fault(self, fault: Fault) -> StudyError {
        StudyError(Box::new(Message { fault, ..*self.0 }))
    }

    /// Returns this message with the messages of further errors.
    pub(crate) fn with_others(self, others: Vec<StudyError>) -> StudyError {
        StudyError(Box::new(Message { others, ..*self.0 }))
    }

    /// Returns the further errors of the study that do not depend on this one, in the order of their lines.
    pub fn others(&self) -> &[StudyError] {
        &self.0.others
    }

    /// Returns the faulty file: the study file or a table that it names.
    pub fn file(&self) -> &Path {
        &self.0.file
    }

    /// Returns the line, counted from one, or `None` if it is unknown.
    pub fn line(&self) -> Option<usize> {
        self.0.place.map(|place| place.line)
    }

    /// Returns the column in characters, counted from one, or `None` if it is unknown.
    pub fn column(&self) -> Option<usize> {
        self.0.place.map(|place| place.column)
    }

    /// Returns the key, such as `model.parameters.speed_rad_s`, or `row 2, column x` in a table.
    /// The key is empty if the message concerns the whole file.
    pub fn key(&self) -> &str {
        &self.0.key
    }

    /// Returns the problem, in a few words.
    pub fn problem(&self) -> &str {
        &self.0.fault.problem
    }

    /// Returns what was found, if anything.
    pub fn found(&self) -> Option<&str> {
        self.0.fault.found.as_deref()
    }

    /// Returns what is allowed, or what to do.
    pub fn allowed(&self) -> Option<&str> {
        self.0.fault.allowed.as_deref()
    }
}

impl fmt::Display for StudyError {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let message = &self.0;
        write!(out, "{}", shown_path(&message.file))?;
        if let Some(place) = message.place {
            write!(out, ":{}:{}", place.line, place.column)?;
        }
        if !message.key.is_empty() {
            write!(out, ": `{}`", message.key)?;
        }
        write!(out, ": {}", message.fault.problem)?;
        if let Some(found) = &message.fault.found {
            write!(out, "\n  found:   {found}")?;
        }
        if let Some(allowed) = &message.fault.allowed {
            write!(out, "\n  allowed: {allowed}")?;
        }
        if let (Some(place), Some(snippet)) = (message.place, &message.snippet) {
            write!(out, "\n  {} | {snippet}", place.line)?;
        }
        message.others.iter().try_for_each(|other| write!(out, "\n{other}"))
    }
}

impl std::error::Error for StudyError {}

/// Describes a range of numbers with its keys.
pub(crate) fn from_to(from: f64, to: f64) -> String {
    format!("from {} to {}", describe_number(from), describe_number(to))
}

/// Describes a range `[low, high]`.
pub(crate) fn low_high(low: f64, high: f64) -> String {
    format!("[{}, {}]", describe_number(low), describe_number(high))
}

/// Lists the allowed names. The name most similar to `found` comes first and is marked.
pub(crate) fn list_names<S: AsRef<str>>(found: &str, names: &[S]) -> String {
    // The time and memory of a comparison are proportional to both lengths.
    let found: String = found.chars().take(LONGEST_COMPARED).collect();
    let found = found.as_str();
    let likeness = |name: &str| {
        let edits = strsim::normalized_damerau_levenshtein(found, name);
        let beginning = strsim::jaro_winkler(found, name);
        (edits >= 0.6 || beginning >= 0.85).then_some(edits + beginning)
    };
    let nearest = names
        .iter()
        .map(AsRef::as_ref)
        .filter_map(|name| Some((likeness(name)?, name)))
        .max_by(|left, right| left.0.total_cmp(&right.0))
        .map(|(_, name)| name);
    let mut parts: Vec<String> = Vec::with_capacity(names.len());
    parts.extend(nearest.map(|name| format!("{name} (did you mean this?)")));
    parts.extend(
        names.iter().map(AsRef::as_ref).filter(|name| Some(*name) != nearest).map(str::to_owned),
    );
    parts.join(", ")
}

/// The number of characters of a name that are compared with the allowed names.
const LONGEST_COMPARED: usize = 96;
