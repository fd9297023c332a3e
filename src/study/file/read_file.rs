//! Reads whole files up to a size limit.

use std::fs::{self, File};
use std::io::{self, Read};
use std::path::Path;

use crate::study::error::Fault;
use crate::study::file::yaml_tree::MAX_FILE_BYTES;
use crate::tabular::to_text;

/// Reads a regular file of limited size.
pub(crate) fn read_bytes(file: &Path) -> Result<Vec<u8>, Fault> {
    let metadata = fs::metadata(file).map_err(|error| unreadable(&error))?;
    if !metadata.is_file() {
        // Checked before opening, because opening a named pipe would wait for a writer.
        let what = if metadata.is_dir() { "a directory" } else { "not a regular file" };
        return Err(Fault::new(format!("this is {what}"), what, "a regular file"));
    }
    if metadata.len() > MAX_FILE_BYTES {
        return Err(too_large(format!("{} bytes", metadata.len())));
    }
    let mut bytes = Vec::new();
    // The content decides, not the size in the metadata: a file may grow, and files in /proc have size 0.
    File::open(file)
        .and_then(|file| file.take(MAX_FILE_BYTES + 1).read_to_end(&mut bytes))
        .map_err(|error| unreadable(&error))?;
    if bytes.len() as u64 > MAX_FILE_BYTES {
        return Err(too_large(format!("more than {MAX_FILE_BYTES} bytes")));
    }
    Ok(bytes)
}

/// Reads a text file of limited size.
pub(crate) fn read_text(file: &Path) -> Result<String, Fault> {
    to_text(read_bytes(file)?)
}

/// Converts an input/output error of a file into a fault.
pub(crate) fn unreadable(error: &io::Error) -> Fault {
    Fault { problem: error.to_string(), found: None, allowed: Some("a readable file".to_owned()) }
}

fn too_large(found: String) -> Fault {
    Fault::new("the file is too large", found, format!("at most {MAX_FILE_BYTES} bytes"))
}
