//! The page of a report: from a directory of results to a file.

use std::fs;
use std::path::{Path, PathBuf};

use super::exit::CliError;
use super::replaceable::{beside, replaceable};
use super::results_study::results_study;
use super::summary::no_tables;
use crate::report::{Budget, Gathered, OWN, of_results, page};
use crate::table::{ResultsError, write_atomically};

/// A page that can be mailed; of larger results less is shown.
const MOST_BYTES: usize = 4_900_000;

/// Writes the page of a directory of results and returns its path.
///
/// # Errors
/// Where the directory holds no results that can be read, or the page cannot be written.
pub fn write(directory: &Path, out: Option<&Path>) -> Result<PathBuf, CliError> {
    let (study, manifest) = results_study(directory)?;
    if manifest.files.is_empty() {
        return Err(no_tables(directory, &study, &manifest)?);
    }
    let file = match out {
        Some(file) => file.to_owned(),
        None => beside(directory, "-report.html")?,
    };
    replaceable(&file, |head| String::from_utf8_lossy(head).contains(OWN))?;
    let mut budget = Budget::SCREEN;
    let page = loop {
        let gathered = Gathered::read(directory, &study, &manifest, budget)?;
        let page = page(directory, &gathered, &of_results(&gathered));
        if page.len() <= MOST_BYTES || budget == budget.halved() {
            break page;
        }
        budget = budget.halved();
    };
    let unusable = |cause| ResultsError::Unusable { path: file.clone(), cause };
    if let Some(parent) = file.parent().filter(|parent| !parent.as_os_str().is_empty()) {
        fs::create_dir_all(parent).map_err(unusable)?;
    }
    write_atomically(&file, page.as_bytes()).map_err(unusable)?;
    Ok(file)
}
