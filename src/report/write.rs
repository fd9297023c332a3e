//! The page of a directory of results, written as one file.

use std::path::{Path, PathBuf};
use std::thread;
use std::time::Duration;

use super::data::{Budget, ReportData, ResultTables};
use super::figures::of_results;
use super::optimum::{OptimumData, of_search};
use super::overwrite::{beside, outside, replace, replaceable, sealed};
use super::page::{OWN, optimum_page, page};
use crate::command_error::CommandError;
use crate::engine::{Readable, readable_results};
use crate::table::MANIFEST;

/// The largest page, in bytes, small enough to mail; pages of larger results show less detail.
const MOST_BYTES: usize = 4_900_000;

/// Writes the page of a directory of results or of a search, by default beside it, and returns its path.
///
/// # Errors
/// Returns an error if the directory holds no readable results, or if the page cannot be written.
pub fn write_report(directory: &Path, out: Option<&Path>) -> Result<PathBuf, CommandError> {
    let is_search = is_search(directory);
    // Results are opened first, so that the error for anything else names them.
    let results = if is_search { None } else { Some(readable_results(directory)?) };
    let file = match out {
        Some(file) => file.to_owned(),
        None => beside(directory, "-report.html")?,
    };
    outside(directory, &file)?;
    replaceable(&file, is_page)?;
    let page = match results {
        Some(results) => page_of_results(directory, &results)?,
        None => page_of_search(directory)?,
    };
    replace(&file, sealed(&page).as_bytes())?;
    Ok(file)
}

/// Returns the page of a study, with as much detail as fits.
fn page_of_results(directory: &Path, results: &Readable) -> Result<String, CommandError> {
    let Readable { study, manifest, tables, .. } = results;
    let tables = ResultTables::open(tables, manifest)?;
    let mut budget = Budget::SCREEN;
    loop {
        let data = ReportData::read(&tables, study, manifest, budget)?;
        let page = page(directory, &data, &of_results(&data));
        if page.len() <= MOST_BYTES || budget == budget.halved() {
            return Ok(page);
        }
        budget = budget.halved();
    }
}

/// The number of attempts to read the tables of a search.
///
/// A report reads the list of files first and the tables after it. A running search may replace or remove a table in
/// between, so that list and table disagree although both are sound; the next attempt reads the new list. A running
/// search replaces its tables at most once for each batch of designs, which takes longer than an attempt. Damage is
/// permanent: the last attempt reports it, less than half a second later.
const ATTEMPTS: u32 = 5;
/// The time between attempts.
const BETWEEN: Duration = Duration::from_millis(100);

/// Whether a directory was written by `stickslip optimize`.
fn is_search(directory: &Path) -> bool {
    let is_there = |name: &str| directory.join(name).exists();
    is_there("evaluations.parquet") && !is_there(MANIFEST)
}

/// Returns the page of a search.
fn page_of_search(directory: &Path) -> Result<String, CommandError> {
    let mut attempt = 1;
    let data = loop {
        match OptimumData::read(directory) {
            // The search may have replaced a table during the reading.
            Err(_) if attempt < ATTEMPTS => thread::sleep(BETWEEN),
            Err(error) => return Err(error),
            Ok(data) => break data,
        }
        attempt += 1;
    };
    Ok(optimum_page(directory, &data, &of_search(&data)))
}

fn is_page(content: &[u8]) -> bool {
    let head = &content[..content.len().min(4096)];
    String::from_utf8_lossy(head).contains(OWN)
}
