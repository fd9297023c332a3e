//! Earlier results in an output directory, which are moved into separate folders below `earlier/`.
//! Nothing is ever removed from these folders.
//!
//! A folder is called `earlier/N.partial` while it is being filled, and gets its final name last.
//! After a program was killed, the next program either completes the folder with the rest of the
//! same results, or closes it as it is before it writes anything else. No move replaces a file.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use super::durable_files::{is_inside, make_inside, sync_directory};
use super::manifest::MANIFEST;
use super::results::{DATA_FILES, ResultsError};

/// Name of the folder of earlier results in an output directory.
pub const EARLIER: &str = "earlier";

/// Moves the tables, the study and the manifest of an output directory into a new folder below
/// `earlier/`, and returns the folder.
///
/// # Errors
/// Returns an error if a file cannot be moved; the next call moves the remaining files.
pub fn put_aside(directory: &Path) -> Result<PathBuf, ResultsError> {
    put_aside_by(directory, |from, to| fs::rename(from, to))
        .map_err(ResultsError::unusable(directory))
}

/// Gives their final names to the folders that a killed program left incomplete. Call this before
/// writing anything into an output directory unless [`put_aside`] was called.
///
/// # Errors
/// Returns an error if a folder cannot be renamed.
pub fn close_earlier(directory: &Path) -> Result<(), ResultsError> {
    let close_all = || -> io::Result<()> {
        let earlier = directory.join(EARLIER);
        if is_inside(&earlier)? {
            for folder in unfinished_folders(&earlier)? {
                close(&earlier, &folder, |from, to| fs::rename(from, to))?;
            }
        }
        Ok(())
    };
    close_all().map_err(ResultsError::unusable(directory))
}

fn put_aside_by(
    directory: &Path,
    mut rename: impl FnMut(&Path, &Path) -> io::Result<()>,
) -> io::Result<PathBuf> {
    let earlier = directory.join(EARLIER);
    make_inside(&earlier)?;
    let exists = |name: &&str| fs::symlink_metadata(directory.join(name)).is_ok();
    // The manifest comes last, because it identifies the remaining files.
    let all = DATA_FILES.iter().copied().chain([MANIFEST]);
    let names: Vec<&str> = all.filter(exists).collect();
    let mut reusable = None;
    for folder in unfinished_folders(&earlier)? {
        let taken = names.iter().any(|name| fs::symlink_metadata(folder.join(name)).is_ok());
        if taken || reusable.is_some() {
            close(&earlier, &folder, &mut rename)?;
        } else {
            reusable = Some(folder);
        }
    }
    let folder = reusable.unwrap_or_else(|| unfinished_name(&unused_name(&earlier)));
    make_inside(&folder)?;
    for name in names {
        rename(&directory.join(name), &folder.join(name))?;
    }
    sync_directory(&folder)?;
    let final_name = close(&earlier, &folder, rename)?;
    sync_directory(directory)?;
    Ok(final_name)
}

/// Gives a folder its final name: its own number, or another number if that name is taken.
fn close(
    earlier: &Path,
    folder: &Path,
    mut rename: impl FnMut(&Path, &Path) -> io::Result<()>,
) -> io::Result<PathBuf> {
    let target = folder.with_extension("");
    let final_name =
        if fs::symlink_metadata(&target).is_ok() { unused_name(earlier) } else { target };
    rename(folder, &final_name)?;
    sync_directory(earlier)?;
    Ok(final_name)
}

/// Returns the unfinished folders, in the order of their numbers.
fn unfinished_folders(earlier: &Path) -> io::Result<Vec<PathBuf>> {
    let mut found: Vec<(u64, PathBuf)> = Vec::new();
    for entry in fs::read_dir(earlier)? {
        let path = entry?.path();
        let number = path.file_name().and_then(|name| name.to_str()?.strip_suffix(".partial"));
        if let Some(number) = number.and_then(|number| number.parse().ok()) {
            is_inside(&path)?;
            found.push((number, path));
        }
    }
    found.sort();
    Ok(found.into_iter().map(|(_, path)| path).collect())
}

/// Returns the first number that neither a finished nor an unfinished folder has.
fn unused_name(earlier: &Path) -> PathBuf {
    let mut names = (1..u64::MAX).map(|number| earlier.join(number.to_string()));
    let is_unused = |name: &PathBuf| {
        [name, &unfinished_name(name)].into_iter().all(|path| fs::symlink_metadata(path).is_err())
    };
    names.find(is_unused).unwrap_or_else(|| earlier.join(u64::MAX.to_string()))
}

fn unfinished_name(final_name: &Path) -> PathBuf {
    final_name.with_added_extension("partial")
}

#[cfg(test)]
mod tests {
    use tempfile::tempdir;

    use super::*;

    /// Tests in `tests/` rely on this order for what a killed program leaves.
    #[test]
    fn the_manifest_is_moved_last_and_the_folder_is_named_after_it() {
        let scratch = tempdir().unwrap();
        let expected = [DATA_FILES, &[MANIFEST, "1.partial"]].concat();
        for name in &expected[..expected.len() - 1] {
            fs::write(scratch.path().join(name), "").unwrap();
        }
        let mut renamed = Vec::new();
        put_aside_by(scratch.path(), |from, to| {
            renamed.push(from.file_name().unwrap().to_owned());
            fs::rename(from, to)
        })
        .unwrap();
        assert_eq!(renamed, expected);
    }
}
