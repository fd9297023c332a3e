//! Files read whole, with a bound on their size.

use std::fs::{self, File};
use std::io::{self, Read};
use std::path::Path;

use crate::study::error::Fault;
use crate::study::file::yaml_tree::MAX_FILE_BYTES;
use crate::tabular::to_text;

/// Reads a regular file of bounded size.
///
/// # Errors
/// What is wrong with the file: absent, a folder or another thing that is no regular file, too large.
pub(crate) fn read_bytes(file: &Path) -> Result<Vec<u8>, Fault> {
    let metadata = fs::metadata(file).map_err(|error| unreadable(&error))?;
    if !metadata.is_file() {
        // Asked before it is opened: opening a named pipe would wait for a writer.
        let what = if metadata.is_dir() { "a directory" } else { "not a regular file" };
        return Err(Fault::new(format!("this is {what}"), what, "a regular file"));
    }
    if metadata.len() > MAX_FILE_BYTES {
        return Err(too_large(format!("{} bytes", metadata.len())));
    }
    let mut bytes = Vec::new();
    // Not what the metadata say but what comes: a file may grow, and some in /proc say 0.
    File::open(file)
        .and_then(|file| file.take(MAX_FILE_BYTES + 1).read_to_end(&mut bytes))
        .map_err(|error| unreadable(&error))?;
    if bytes.len() as u64 > MAX_FILE_BYTES {
        return Err(too_large("more".to_owned()));
    }
    Ok(bytes)
}

/// Reads a text file of bounded size.
///
/// # Errors
/// What is wrong with the file, also where it is not UTF-8.
pub(crate) fn read_text(file: &Path) -> Result<String, Fault> {
    to_text(read_bytes(file)?)
}

/// What the operating system says about a file that cannot be read.
pub(crate) fn unreadable(error: &io::Error) -> Fault {
    Fault {
        problem: error.to_string(),
        found: None,
        allowed: Some("a file that can be read".to_owned()),
    }
}

fn too_large(found: String) -> Fault {
    Fault::new("the file is too large", found, format!("at most {MAX_FILE_BYTES} bytes"))
}
