//! The page of a report, from a directory of results to a file.

use std::path::{Path, PathBuf};

use super::exit::CliError;
use super::overwrite::{beside, outside, replace, replaceable, sealed};
use super::results_study::results_study;
use super::summary::no_tables;
use crate::report::{Budget, OWN, ReportData, ResultTables, of_results, page};

/// The largest page, in bytes, small enough to mail; pages of larger results show less detail.
const MOST_BYTES: usize = 4_900_000;

/// Writes the page of a directory of results and returns its path.
///
/// # Errors
/// Returns an error if the directory holds no readable results, or if the page cannot be written.
pub fn write(directory: &Path, out: Option<&Path>) -> Result<PathBuf, CliError> {
    let (study, manifest) = results_study(directory)?;
    if manifest.files.is_empty() {
        return Err(no_tables(directory, &study, &manifest)?);
    }
    let file = match out {
        Some(file) => file.to_owned(),
        None => beside(directory, "-report.html")?,
    };
    outside(directory, &file)?;
    replaceable(&file, is_page)?;
    let tables = ResultTables::open(directory, &manifest)?;
    let mut budget = Budget::SCREEN;
    let page = loop {
        let data = ReportData::read(&tables, &study, &manifest, budget)?;
        let page = page(directory, &data, &of_results(&data));
        if page.len() <= MOST_BYTES || budget == budget.halved() {
            break page;
        }
        budget = budget.halved();
    };
    replace(&file, sealed(&page).as_bytes())?;
    Ok(file)
}

fn is_page(content: &[u8]) -> bool {
    let head = &content[..content.len().min(4096)];
    String::from_utf8_lossy(head).contains(OWN)
}
