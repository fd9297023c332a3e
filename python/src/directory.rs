//! The directory of an optimisation or an inference: one of the user, or a temporary one that lives as long as its results.

use std::path::{Path, PathBuf};

use stickslip::table::{MemoryTable, Table};
use tempfile::TempDir;

use crate::error::{Trouble, refused};

/// A directory of results.
pub enum Directory {
    /// Of the user.
    Named(PathBuf),
    /// Removed with its results.
    Temporary(TempDir),
}

impl Directory {
    /// Takes the directory of the user, or creates a temporary one.
    ///
    /// # Errors
    /// Returns an error if the path is empty, or if a temporary directory cannot be created.
    pub fn new(out: Option<PathBuf>) -> Result<Self, Trouble> {
        let Some(out) = out else {
            let temporary = tempfile::Builder::new().prefix("stickslip-").tempdir();
            let failed = |error| Trouble::System(format!("a temporary directory: {error}"));
            return temporary.map(Directory::Temporary).map_err(failed);
        };
        check_path(&out)?;
        Ok(Directory::Named(out))
    }

    /// Returns the path.
    pub fn path(&self) -> &Path {
        match self {
            Directory::Named(path) => path,
            Directory::Temporary(directory) => directory.path(),
        }
    }

    /// Returns the path if it is one of the user.
    pub fn named(&self) -> Option<&Path> {
        match self {
            Directory::Named(path) => Some(path),
            Directory::Temporary(_) => None,
        }
    }

    /// Reads tables, in order.
    ///
    /// # Errors
    /// Returns an error if a table is missing or damaged.
    pub fn tables<const N: usize>(&self, names: [&str; N]) -> Result<[MemoryTable; N], Trouble> {
        let read = |name| Ok(Table::of_itself(self.path(), name)?.0.in_memory()?);
        let tables: Result<Vec<MemoryTable>, Trouble> = names.into_iter().map(read).collect();
        tables?
            .try_into()
            .map_err(|_| Trouble::Defect("a defect of stickslip: no table".to_owned()))
    }
}

/// Refuses an empty path, which would otherwise be the current directory.
///
/// # Errors
/// Returns an error if the path is empty.
pub fn check_path(out: &Path) -> Result<(), Trouble> {
    check_named("out", out, "a directory, \".\" for the current one; None for tables in memory")
}

/// Refuses an empty path in an argument.
///
/// # Errors
/// Returns an error if the path is empty.
pub fn check_named(argument: &str, path: &Path, allowed: &str) -> Result<(), Trouble> {
    match path.as_os_str().is_empty() {
        true => Err(refused(argument, "an empty path", "\"\"", allowed)),
        false => Ok(()),
    }
}

/// Refuses an empty path of an HTML page.
///
/// # Errors
/// Returns an error if the path is empty.
pub fn check_page(out: Option<&Path>) -> Result<(), Trouble> {
    out.map_or(Ok(()), |out| check_named("out", out, "a file, such as \"page.html\""))
}
