//! Files that a report may replace: those that an earlier one has written.

use std::fs::{self, File};
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use super::exit::CliError;
use crate::table::ResultsError;

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

/// Refuses to replace a file unless `own` knows it by its first bytes as one of this program.
///
/// # Errors
/// Where something else is in the way.
pub fn replaceable(file: &Path, own: impl Fn(&[u8]) -> bool) -> Result<(), CliError> {
    let unusable = |cause| ResultsError::Unusable { path: file.to_owned(), cause };
    let found = match fs::symlink_metadata(file) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(()),
        Err(cause) => return Err(unusable(cause).into()),
        Ok(found) if found.is_file() => {
            let mut head = Vec::new();
            File::open(file)
                .and_then(|file| file.take(4096).read_to_end(&mut head))
                .map_err(unusable)?;
            if own(&head) {
                return Ok(());
            }
            "a file that `stickslip report` has not written".to_owned()
        }
        Ok(found) if found.is_dir() => "a directory".to_owned(),
        Ok(_) => "neither a file nor a directory".to_owned(),
    };
    Err(ResultsError::Occupied {
        path: file.to_owned(),
        reason: "this would replace something else".to_owned(),
        found,
        allowed: "a new name, or what `stickslip report` has written before; --out names one"
            .to_owned(),
    }
    .into())
}
