//! A warning about a study that is valid but probably not what its author means.

use std::fmt;
use std::path::PathBuf;

use serde::Serialize;

use crate::sanitize::shown_path;
use crate::study::Study;

/// A warning with the key that it concerns, the value found and a remedy.
///
/// An example of the printed message:
///
/// ```text
/// a.yaml:7:19: `model.parameters.ball_mass_kg`: the density of a ball is that of no material
///   found:  0.14 kg and a diameter of 0.003 m, which is 9.9e6 kg/m³
///   remedy: a density from 500 to 25000 kg/m³; a steel ball of this diameter has 1.1e-4 kg
/// ```
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Warning {
    /// Name of the kind of warning.
    pub kind: &'static str,
    /// The key as the study file writes it, such as `model.parameters.ball_mass_kg`.
    pub key: String,
    /// The study file.
    #[serde(skip)]
    pub file: PathBuf,
    /// Line of the key, from 1, if the file contains it or a key around it.
    pub line: Option<usize>,
    /// Column of the key, from 1, if its line is known.
    pub column: Option<usize>,
    /// What is probably wrong, in a few words.
    pub problem: String,
    /// The value found.
    pub found: String,
    /// What to do.
    pub remedy: String,
}

/// A warning without its place, and the key that it concerns.
#[derive(Clone, Debug)]
pub(super) struct Finding {
    pub kind: &'static str,
    pub key: String,
    pub problem: String,
    pub found: String,
    pub remedy: String,
}

impl Finding {
    /// Returns the warning with its place in the study file.
    pub fn in_file(self, study: &Study) -> Warning {
        let Finding { kind, key, problem, found, remedy } = self;
        let (file, place) = (study.file().to_path_buf(), study.place_of(&key));
        let (line, column) = place.map(|[line, column]| (line, column)).unzip();
        let key = study.key_with_unit(&key).unwrap_or(key);
        Warning { kind, file, line, column, key, problem, found, remedy }
    }
}

impl fmt::Display for Warning {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "{}", shown_path(&self.file))?;
        if let (Some(line), Some(column)) = (self.line, self.column) {
            write!(out, ":{line}:{column}")?;
        }
        write!(out, ": `{}`: {}", self.key, self.problem)?;
        write!(out, "\n  found:  {}\n  remedy: {}", self.found, self.remedy)
    }
}
