//! Reads files of limited size: study files, and their tables, which must lie in certain directories.
//!
//! A study file may come from an untrusted source. Its tables must therefore lie in the study file's directory, in one of its
//! subdirectories, or in a directory that the user names on the command line. Naming a directory grants access only: the
//! path of a table is always absolute or relative to the study file, so a study refers to the same tables with any
//! options.

use std::cell::Cell;
use std::fs::{self, File};
use std::io::{self, Read};
use std::path::{Component, Path, PathBuf};

use crate::study::error::{Fault, StudyError, shorten};
use crate::study::file::yaml_tree::MAX_FILE_BYTES;
use crate::tabular::to_text;

/// The largest number of values in all sweeps and tables of a study together.
pub(crate) const MAX_VALUES: usize = 1_000_000;

/// The largest number of table files in a study.
const MAX_FILES: usize = 1000;

/// The directories that may contain tables, and the amounts read from them so far.
pub(crate) struct TableFolders {
    /// The study file's directory.
    folder: PathBuf,
    /// The directories named by the user, with all symbolic links resolved.
    named: Vec<PathBuf>,
    files: Cell<usize>,
    bytes: Cell<u64>,
    values: Cell<usize>,
}

impl TableFolders {
    /// Allows the directory of a study file and the directories named by the user.
    ///
    /// # Errors
    /// Returns an error if a named directory does not exist or cannot be accessed.
    pub fn new(study_file: &Path, named: &[PathBuf]) -> Result<TableFolders, StudyError> {
        let directory = study_file.parent().unwrap_or(Path::new(""));
        let directory = if directory.as_os_str().is_empty() { Path::new(".") } else { directory };
        let named = named.iter().map(|folder| {
            let refuse = |problem: String| {
                let found = shorten(&folder.display().to_string());
                let fault = Fault::new(problem, found, "an existing directory after --tables");
                StudyError::about_file(folder, fault)
            };
            let real = fs::canonicalize(folder).map_err(|error| refuse(error.to_string()))?;
            if real.is_dir() { Ok(real) } else { Err(refuse("this is not a directory".to_owned())) }
        });
        Ok(TableFolders {
            folder: directory.to_path_buf(),
            named: named.collect::<Result<_, _>>()?,
            files: Cell::new(0),
            bytes: Cell::new(0),
            values: Cell::new(0),
        })
    }

    /// Reads a table. Returns its path for messages and its content.
    ///
    /// # Errors
    /// Returns an error if the table lies outside the allowed directories or cannot be read, or if there are too many or
    /// too large tables.
    pub fn read(&self, name: &str) -> Result<(PathBuf, Vec<u8>), Fault> {
        let path = if self.folder == Path::new(".") { name.into() } else { self.folder.join(name) };
        let real = self.find(name, &path)?;
        let files = self.files.get() + 1;
        if files > MAX_FILES {
            let allowed = format!("at most {MAX_FILES}; combine several tables in one file");
            return Err(Fault::new("too many tables", format!("{files} tables"), allowed));
        }
        let content = read_bytes(&real).map_err(|fault| unreadable_table(name, fault))?;
        let bytes = self.bytes.get() + content.len() as u64;
        if bytes > MAX_FILE_BYTES {
            let allowed = format!("at most {MAX_FILE_BYTES} bytes in all tables of a study");
            return Err(Fault::new("the tables are too large", format!("{bytes} bytes"), allowed));
        }
        self.files.set(files);
        self.bytes.set(bytes);
        Ok((path, content))
    }

    /// Counts values read from files.
    ///
    /// # Errors
    /// Returns an error if the tables of the study contain too many values.
    pub fn count(&self, values: usize) -> Result<(), Fault> {
        let values = self.values.get().saturating_add(values);
        if values > MAX_VALUES {
            let allowed = format!("at most {MAX_VALUES} in all tables of a study");
            return Err(Fault::new("too many values", format!("{values} values"), allowed));
        }
        self.values.set(values);
        Ok(())
    }

    /// Returns the path of a table with all symbolic links resolved.
    fn find(&self, name: &str, path: &Path) -> Result<PathBuf, Fault> {
        if self.named.is_empty() && leaves_directory(Path::new(name)) {
            return Err(self.outside(name, None));
        }
        let real = |path: &Path| {
            fs::canonicalize(path).map_err(|error| unreadable_table(name, unreadable(&error)))
        };
        let (real, directory) = (real(path)?, real(&self.folder)?);
        if real.starts_with(directory) || self.named.iter().any(|folder| real.starts_with(folder)) {
            return Ok(real);
        }
        Err(self.outside(name, (!leaves_directory(Path::new(name))).then_some(&real)))
    }

    fn outside(&self, name: &str, link_to: Option<&Path>) -> Fault {
        let name = shorten(name);
        let found = match link_to {
            None => name,
            Some(real) => format!("{name}, a link to {}", shorten(&real.display().to_string())),
        };
        let problem = if self.named.is_empty() {
            "the table lies outside the study file's directory"
        } else {
            "the table lies outside the study file's directory and the directories given with --tables"
        };
        let allowed = "a file in the study file's directory or a subdirectory, or the option --tables DIR \
                       with the directory that contains the table";
        Fault::new(problem, found, allowed)
    }
}

/// Adds the name of a table to the fault of its file.
fn unreadable_table(name: &str, fault: Fault) -> Fault {
    Fault { found: Some(shorten(name)), ..fault }
}

/// Returns whether a path leaves the directory that it is relative to, without regard to symbolic links.
fn leaves_directory(path: &Path) -> bool {
    let mut depth = 0_usize;
    for component in path.components() {
        match component {
            Component::Normal(_) => depth += 1,
            Component::CurDir => {}
            Component::ParentDir if depth > 0 => depth -= 1,
            Component::ParentDir | Component::RootDir | Component::Prefix(_) => return true,
        }
    }
    false
}

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
