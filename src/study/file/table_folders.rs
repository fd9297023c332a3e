//! Which files the tables of a study may be, and how much they may hold together.
//!
//! A study file may come from anywhere, and what it names must not lead out of its directory: the
//! table of a study is a file in the study file's directory or below it, or in a directory that the
//! user names on the command line. Naming a directory allows files and finds none: a table's path is
//! always relative to the study file (or absolute), so that a study that can be used means the same
//! tables whatever directories are named.

use std::cell::Cell;
use std::fs;
use std::path::{Component, Path, PathBuf};

use crate::study::error::{Fault, StudyError, shorten};
use crate::study::file::read_file::{read_bytes, unreadable};
use crate::study::file::yaml_tree::MAX_FILE_BYTES;

/// The most values that all sweeps and tables of a study may hold together.
pub(crate) const MAX_VALUES: usize = 1_000_000;

/// The most tables that a study may read from files.
const MAX_FILES: usize = 1000;

/// The directories in which tables may lie, and what has been read from them.
pub(crate) struct TableFolders {
    /// The study file's directory.
    own: PathBuf,
    /// Directories that the user names, without links.
    named: Vec<PathBuf>,
    files: Cell<usize>,
    bytes: Cell<u64>,
    values: Cell<usize>,
}

impl TableFolders {
    /// The directory of a study file, and others that the user names.
    ///
    /// # Errors
    /// Where a directory that the user names cannot be used.
    pub fn new(study_file: &Path, named: &[PathBuf]) -> Result<TableFolders, StudyError> {
        let own = study_file.parent().unwrap_or(Path::new(""));
        let own = if own.as_os_str().is_empty() { Path::new(".") } else { own };
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
            own: own.to_path_buf(),
            named: named.collect::<Result<_, _>>()?,
            files: Cell::new(0),
            bytes: Cell::new(0),
            values: Cell::new(0),
        })
    }

    /// The path of a table, as it is named in messages, and its content.
    ///
    /// # Errors
    /// A table outside of the directories, one that cannot be read, too many or too large ones.
    pub fn read(&self, name: &str) -> Result<(PathBuf, Vec<u8>), Fault> {
        let path = if self.own == Path::new(".") { name.into() } else { self.own.join(name) };
        let real = self.find(name, &path)?;
        let files = self.files.get() + 1;
        if files > MAX_FILES {
            let allowed = format!("at most {MAX_FILES}, or tables put together");
            return Err(Fault::new("too many tables", format!("{files} of them"), allowed));
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

    /// Counts values that have been read from files.
    ///
    /// # Errors
    /// More than a study may hold.
    pub fn count(&self, values: usize) -> Result<(), Fault> {
        let values = self.values.get().saturating_add(values);
        if values > MAX_VALUES {
            let allowed = format!("at most {MAX_VALUES} in all tables of a study");
            return Err(Fault::new("too many values", format!("{values} values"), allowed));
        }
        self.values.set(values);
        Ok(())
    }

    /// The file itself, all links followed.
    fn find(&self, name: &str, path: &Path) -> Result<PathBuf, Fault> {
        if self.named.is_empty() && leads_out(Path::new(name)) {
            return Err(self.outside(name, None));
        }
        let real = |path: &Path| {
            fs::canonicalize(path).map_err(|error| unreadable_table(name, unreadable(&error)))
        };
        let (real, own) = (real(path)?, real(&self.own)?);
        if real.starts_with(own) || self.named.iter().any(|folder| real.starts_with(folder)) {
            return Ok(real);
        }
        Err(self.outside(name, (!leads_out(Path::new(name))).then_some(&real)))
    }

    fn outside(&self, name: &str, link_to: Option<&Path>) -> Fault {
        let name = shorten(name);
        let found = match link_to {
            None => name,
            Some(real) => format!("{name}, a link to {}", shorten(&real.display().to_string())),
        };
        let problem = if self.named.is_empty() {
            "the table lies outside of the study file's directory"
        } else {
            "the table lies outside of the study file's directory and of those after --tables"
        };
        let allowed = "a file in the study file's directory or below it, or the option --tables DIR \
                       with the directory that holds the table";
        Fault::new(problem, found, allowed)
    }
}

/// What the system says of a file, as a fault of the table's name.
fn unreadable_table(name: &str, fault: Fault) -> Fault {
    Fault { found: Some(shorten(name)), ..fault }
}

/// Whether a path, links aside, leads out of the directory that it is relative to.
fn leads_out(path: &Path) -> bool {
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
