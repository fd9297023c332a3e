//! The directory of an unfinished table, and the renaming of the finished table.
//!
//! All unfinished files are in one temporary directory beside the table, which belongs to this
//! process: `table` contains the parts that are being written, and `replaced-0` briefly contains
//! the table that is replaced. One rename gives the table its name, so that the name never belongs
//! to an incomplete table. A table of one part is a file, and a table of several parts is a
//! directory. If two processes write the same table, the last one gives it the name, and each table
//! is complete. The temporary directory is removed when the value is dropped.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use tempfile::TempDir;

use super::durable_files::{parent, sync_directory, temporary_directory};
use crate::sanitize::shorten;

/// The folder of the parts in the temporary directory.
const PARTS: &str = "table";
/// The beginning of the name of a replaced table in the temporary directory; a number follows.
const REPLACED: &str = "replaced";
/// The number of attempts if other processes take the name at the same time.
const MAX_ATTEMPTS: u32 = 100;

/// The directory of an unfinished table.
pub(super) struct UnfinishedTable {
    target: PathBuf,
    /// The directory with the parts.
    pub(super) directory: TempDir,
}

/// Returns the name of a part in the directory of its table; names sort like numbers up to 100,000
/// parts.
pub(super) fn part_name(number: usize) -> String {
    format!("part-{number:05}.parquet")
}

/// Returns whether a name is one of [`part_name`].
fn is_part(name: &str) -> bool {
    let number = name.strip_prefix("part-").and_then(|rest| rest.strip_suffix(".parquet"));
    number.is_some_and(|number| number.len() >= 5 && number.bytes().all(|b| b.is_ascii_digit()))
}

impl UnfinishedTable {
    /// Creates the directory for the table `target`.
    pub(super) fn create(target: &Path) -> io::Result<Self> {
        let directory = temporary_directory(target)?;
        let unfinished = UnfinishedTable { target: target.to_owned(), directory };
        fs::create_dir(unfinished.parts())?;
        Ok(unfinished)
    }

    fn parts(&self) -> PathBuf {
        self.directory.path().join(PARTS)
    }

    /// Returns the path of part `number` while it is being written.
    pub(super) fn part(&self, number: usize) -> PathBuf {
        self.parts().join(part_name(number))
    }

    /// Returns the final names of the parts, relative to the directory of the table.
    pub(super) fn names(&self, parts: usize) -> Vec<String> {
        let name = self.target.file_name().unwrap_or_default().to_string_lossy();
        match parts {
            1 => vec![name.into_owned()],
            _ => (0..parts).map(|number| format!("{name}/{}", part_name(number))).collect(),
        }
    }

    /// Gives the table its name and replaces an earlier table; `parts` parts have been written and
    /// synced.
    pub(super) fn publish(self, parts: usize) -> io::Result<()> {
        sync_directory(&self.parts())?;
        self.rename_to_target(&if parts == 1 { self.part(0) } else { self.parts() })?;
        sync_directory(parent(&self.target))?;
        self.directory.close()
    }

    fn rename_to_target(&self, source: &Path) -> io::Result<()> {
        for number in 0..MAX_ATTEMPTS {
            // A rename replaces a file by a file, but never a directory that is not empty.
            let Err(refused) = fs::rename(source, &self.target) else { return Ok(()) };
            match fs::symlink_metadata(&self.target) {
                Ok(old) if old.is_dir() || source.is_dir() => {}
                // The name was taken when the rename failed; another process has moved that table since.
                Err(error) if is_missing(&error) && !is_missing(&refused) => continue,
                _ => return Err(refused),
            }
            if let Some(name) = foreign_entry(&self.target)? {
                return Err(io::Error::other(format!(
                    "a directory of this name is in the way: it holds {}, which is not part of a \
                     table",
                    shorten(&name)
                )));
            }
            let aside = self.directory.path().join(format!("{REPLACED}-{number}"));
            match fs::rename(&self.target, aside) {
                // Another process has moved it, and may put its own table there.
                Err(error) if !is_missing(&error) => return Err(error),
                _ => {}
            }
        }
        Err(io::Error::other("other processes write this table at the same time"))
    }
}

fn is_missing(error: &io::Error) -> bool {
    error.kind() == io::ErrorKind::NotFound
}

/// Returns the name of something in a directory that is not part of a table, or `None` if there is
/// nothing or no such directory.
fn foreign_entry(directory: &Path) -> io::Result<Option<String>> {
    if !fs::symlink_metadata(directory).is_ok_and(|found| found.is_dir()) {
        return Ok(None);
    }
    let entries = match fs::read_dir(directory) {
        // Another process has moved it since.
        Err(error) if is_missing(&error) => return Ok(None),
        entries => entries?,
    };
    for entry in entries {
        let name = entry?.file_name().to_string_lossy().into_owned();
        if !is_part(&name) {
            return Ok(Some(name));
        }
    }
    Ok(None)
}
