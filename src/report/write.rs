//! The page of a directory of results or of a search, written as one file, and its figures for print.

use std::path::{Path, PathBuf};
use std::thread;
use std::time::Duration;

use super::chart::{Figure, PrintedFigure};
use super::data::{Budget, ReportData, ResultTables};
use super::figures::of_results;
use super::optimum::{OptimumData, of_search};
use super::overwrite::{beside, outside, replace, replaceable, sealed};
use super::page::{optimum_page, page};
use crate::engine::{CommandError, ReadableResults, readable_results};
use crate::study::Study;
use crate::table::{MANIFEST, Manifest};

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
    replaceable(&file)?;
    let page = match results {
        Some(results) => page_of_results(directory, &results)?,
        None => {
            let data = read_search(directory)?;
            optimum_page(directory, &data, &of_search(&data))
        }
    };
    replace(&file, sealed(&page).as_bytes())?;
    Ok(file)
}

/// Returns the page of a study, with as much detail as fits.
fn page_of_results(directory: &Path, results: &ReadableResults) -> Result<String, CommandError> {
    let ReadableResults { study, manifest, tables, .. } = results;
    let tables = ResultTables::open(tables, manifest)?;
    let mut budget = Budget::SCREEN;
    loop {
        let data = ReportData::read(&tables, study, manifest, budget, None)?;
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

/// Reads the tables of a search, running or finished.
fn read_search(directory: &Path) -> Result<OptimumData, CommandError> {
    for _ in 1..ATTEMPTS {
        match OptimumData::read(directory) {
            // The search may have replaced a table during the reading.
            Err(_) => thread::sleep(BETWEEN),
            read => return read,
        }
    }
    OptimumData::read(directory)
}

/// Returns the figures of a directory of results or of a search for print, in reading order; of results, those of all points
/// or of the chosen ones.
///
/// # Errors
/// Returns an error if the directory holds no readable results, or if they do not have a chosen point.
pub fn printed_figures(
    directory: &Path,
    chosen: Option<&[u64]>,
) -> Result<Vec<PrintedFigure>, CommandError> {
    if is_search(directory) {
        return Ok(printed(of_search(&read_search(directory)?)));
    }
    let ReadableResults { study, manifest, tables, .. } = &readable_results(directory)?;
    printed_figures_of(&ResultTables::open(tables, manifest)?, (study, manifest), chosen)
}

/// Returns the figures of the tables of results for print, like [`printed_figures`].
///
/// # Errors
/// Returns an error if a table cannot be read, or if the results do not have a chosen point.
pub fn printed_figures_of(
    tables: &ResultTables,
    (study, manifest): (&Study, &Manifest),
    chosen: Option<&[u64]>,
) -> Result<Vec<PrintedFigure>, CommandError> {
    let data = ReportData::read(tables, study, manifest, Budget::PRINT, chosen)?;
    let has = |point: &u64| data.points.iter().any(|known| known.point_id == *point);
    if let Some(missing) = chosen.and_then(|chosen| chosen.iter().find(|point| !has(point))) {
        let last = study.point_count().saturating_sub(1);
        return Err(CommandError::Usage(format!(
            "points: these results have no such point\n  found:   {missing}\n  allowed: numbers of points from 0 to {last} \
             with finished runs"
        )));
    }
    Ok(printed(of_results(&data)))
}

fn printed(figures: Vec<Figure>) -> Vec<PrintedFigure> {
    let with_caption = |figure: Figure| PrintedFigure { caption: figure.caption.clone(), figure };
    figures.into_iter().map(with_caption).collect()
}
