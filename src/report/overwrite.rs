//! Overwrites report files only if an earlier report wrote them and they are unchanged.
//!
//! A page ends with a comment that holds the hash of the text before it.

use std::fs::{self, File};
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use super::page::OWN;
use crate::engine::CommandError;
use crate::table::{ResultsError, sha256, write_atomically};

/// The largest size of a report, in bytes.
const MOST_BYTES: u64 = 64 << 20;
const SEAL: &str = "<!-- stickslip, SHA-256 of what precedes: ";

/// Returns an HTML text with its hash appended.
pub fn sealed(text: &str) -> String {
    let end = if text.ends_with('\n') { "" } else { "\n" };
    let text = format!("{text}{end}");
    format!("{text}{SEAL}{} -->\n", sha256(&text))
}

fn is_sealed(content: &[u8]) -> bool {
    let Ok(text) = str::from_utf8(content) else { return false };
    let Some(place) = text.rfind(SEAL) else { return false };
    let (before, seal) = text.split_at(place);
    seal == format!("{SEAL}{} -->\n", sha256(before))
}

/// Writes a report file atomically in place of an earlier one. Concurrent writers do not disturb each other.
///
/// # Errors
/// Returns an error if the file cannot be written.
pub fn replace(path: &Path, content: &[u8]) -> Result<(), CommandError> {
    let written = || {
        if let Some(parent) = path.parent().filter(|parent| !parent.as_os_str().is_empty()) {
            fs::create_dir_all(parent)?;
        }
        write_atomically(path, content)
    };
    written().map_err(|error| {
        let what = format!("{}: cannot be written", path.display());
        CommandError::refusal(what, error, "a path that can be written to, with --out FILE")
    })
}

/// Checks that an output lies outside the directory of results.
///
/// # Errors
/// Returns an error if the output lies inside `directory`.
pub fn outside(directory: &Path, out: &Path) -> Result<(), CommandError> {
    let Ok(directory) = fs::canonicalize(directory) else { return Ok(()) };
    // The longest existing part of the path.
    let there = out.ancestors().find_map(|part| {
        let part = if part.as_os_str().is_empty() { Path::new(".") } else { part };
        fs::canonicalize(part).ok()
    });
    if there.is_some_and(|there| there.starts_with(&directory)) {
        let what = format!("{}: lies in the directory of results", out.display());
        let found = format!("an output in {}", directory.display());
        let allowed = "another place; that directory holds only files of the study";
        return Err(CommandError::refusal(what, found, allowed));
    }
    Ok(())
}

/// Returns the path next to a directory whose name is the directory's name followed by `added`.
///
/// # Errors
/// Returns an error if the directory has no name, as `/`.
pub fn beside(directory: &Path, added: &str) -> Result<PathBuf, CommandError> {
    // `.` and `..` have names only after resolution.
    let named = match directory.file_name() {
        Some(_) => directory.to_owned(),
        None => fs::canonicalize(directory).map_err(ResultsError::unusable(directory))?,
    };
    let Some(name) = named.file_name() else {
        let found = directory.display();
        return Err(CommandError::Usage(format!(
            "{found}: this directory has no name; name the output with --out"
        )));
    };
    let mut name = name.to_owned();
    name.push(added);
    Ok(named.with_file_name(name))
}

/// Checks that a file does not exist, or that it is a page of this program and its hash is right.
///
/// # Errors
/// Returns an error if anything else has this path.
pub fn replaceable(file: &Path) -> Result<(), CommandError> {
    let unusable = ResultsError::unusable(file);
    let found = match fs::symlink_metadata(file) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(()),
        Err(cause) => return Err(unusable(cause).into()),
        Ok(found) if found.is_file() => {
            let mut content = Vec::new();
            File::open(file)
                .and_then(|file| file.take(MOST_BYTES).read_to_end(&mut content))
                .map_err(unusable)?;
            let head = String::from_utf8_lossy(&content[..content.len().min(4096)]);
            match (head.contains(OWN), is_sealed(&content)) {
                (true, true) => return Ok(()),
                (true, false) => "a report that has been changed since it was written".to_owned(),
                (false, _) => "a file that `stickslip report` did not write".to_owned(),
            }
        }
        Ok(found) if found.is_dir() => "a directory".to_owned(),
        Ok(_) => "neither a file nor a directory".to_owned(),
    };
    let allowed = "a new path or an unchanged report, with --out FILE";
    Err(ResultsError::occupied(file, "this would overwrite a foreign file", found, allowed).into())
}
