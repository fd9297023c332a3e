//! The page of a report: from a directory of results to a file.

use std::fs::{self, File};
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use super::exit::CliError;
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
    refuse_strangers(&file)?;
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

/// A name beside a directory: its own with something added.
///
/// # Errors
/// Where the directory has no name, as `/`.
pub fn beside(directory: &Path, added: &str) -> Result<PathBuf, CliError> {
    // `.` and `..` have a name once they are resolved.
    let named = match directory.file_name() {
        Some(_) => directory.to_owned(),
        None => fs::canonicalize(directory)
            .map_err(|cause| ResultsError::Unusable { path: directory.to_owned(), cause })?,
    };
    let Some(name) = named.file_name() else {
        let found = directory.display();
        return Err(CliError::Usage(format!("{found}: name the output with --out")));
    };
    let mut name = name.to_owned();
    name.push(added);
    Ok(named.with_file_name(name))
}

/// Refuses to replace a file that is not a page of this program.
fn refuse_strangers(file: &Path) -> Result<(), CliError> {
    let unusable = |cause| ResultsError::Unusable { path: file.to_owned(), cause };
    let found = match fs::symlink_metadata(file) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(()),
        Err(cause) => return Err(unusable(cause).into()),
        Ok(found) if found.is_file() => {
            let mut head = Vec::new();
            File::open(file)
                .and_then(|file| file.take(2000).read_to_end(&mut head))
                .map_err(unusable)?;
            if String::from_utf8_lossy(&head).contains(OWN) {
                return Ok(());
            }
            "a file that `stickslip report` has not written".to_owned()
        }
        Ok(found) if found.is_dir() => "a directory".to_owned(),
        Ok(_) => "neither a file nor a directory".to_owned(),
    };
    Err(ResultsError::Occupied {
        path: file.to_owned(),
        reason: "the page would replace something else".to_owned(),
        found,
        allowed: "a new name, or an earlier page; --out names one".to_owned(),
    }
    .into())
}
