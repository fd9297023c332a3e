//! Earlier results in an output directory, which are moved into separate folders below `earlier/`.
//! Nothing is ever removed from these folders.
//!
//! A folder is called `earlier/N.partial` while it is being filled, and gets its final name last.
//! After a program was killed, the next program either completes the folder with the rest of the
//! same results, or closes it as it is before it writes anything else. No move replaces a file.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use super::directory::{is_inside, make_inside, sync_directory};
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
    let unusable = |cause| ResultsError::Unusable { path: directory.to_owned(), cause };
    put_aside_by(directory, &mut |from, to| fs::rename(from, to)).map_err(unusable)
}

/// Closes the folders that a killed program left incomplete. Call this before writing anything into
/// an output directory unless [`put_aside`] was called.
///
/// # Errors
/// Returns an error if a folder cannot be renamed.
pub fn close_earlier(directory: &Path) -> Result<(), ResultsError> {
    let unusable = |cause| ResultsError::Unusable { path: directory.to_owned(), cause };
    close_by(directory, &mut |from, to| fs::rename(from, to)).map_err(unusable)
}

/// A function that renames a file.
type Rename<'a> = &'a mut dyn FnMut(&Path, &Path) -> io::Result<()>;

fn put_aside_by(directory: &Path, rename: Rename<'_>) -> io::Result<PathBuf> {
    let folder = directory.join(EARLIER);
    make_inside(&folder)?;
    let is_there = |name: &&str| fs::symlink_metadata(directory.join(name)).is_ok();
    // The manifest comes last, because it identifies the remaining files.
    let names: Vec<&str> = DATA_FILES.into_iter().chain([MANIFEST]).filter(is_there).collect();
    let mut half_full = None;
    for filling in unfinished(&folder)? {
        let taken = names.iter().any(|name| fs::symlink_metadata(filling.join(name)).is_ok());
        if taken || half_full.is_some() {
            close(&folder, &filling, rename)?;
        } else {
            half_full = Some(filling);
        }
    }
    let filling = match half_full {
        Some(filling) => filling,
        None => partial(&free(&folder)),
    };
    make_inside(&filling)?;
    for name in names {
        rename(&directory.join(name), &filling.join(name))?;
    }
    sync_directory(&filling)?;
    let place = close(&folder, &filling, rename)?;
    sync_directory(directory)?;
    Ok(place)
}

fn close_by(directory: &Path, rename: Rename<'_>) -> io::Result<()> {
    let folder = directory.join(EARLIER);
    if is_inside(&folder)? {
        for filling in unfinished(&folder)? {
            close(&folder, &filling, rename)?;
        }
    }
    Ok(())
}

/// Gives a folder its final name: its own number, or another number if that name is taken.
fn close(folder: &Path, filling: &Path, rename: Rename<'_>) -> io::Result<PathBuf> {
    let own = filling.with_extension("");
    let place = if fs::symlink_metadata(&own).is_ok() { free(folder) } else { own };
    rename(filling, &place)?;
    sync_directory(folder)?;
    Ok(place)
}

/// Returns the unfinished folders, in the order of their numbers.
fn unfinished(folder: &Path) -> io::Result<Vec<PathBuf>> {
    let mut found: Vec<(u64, PathBuf)> = Vec::new();
    for entry in fs::read_dir(folder)? {
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
fn free(folder: &Path) -> PathBuf {
    let names = (1..u64::MAX).map(|number| folder.join(number.to_string()));
    let is_free = |name: &PathBuf| {
        [name, &partial(name)].into_iter().all(|path| fs::symlink_metadata(path).is_err())
    };
    names.into_iter().find(is_free).unwrap_or_else(|| folder.join(u64::MAX.to_string()))
}

fn partial(place: &Path) -> PathBuf {
    place.with_added_extension("partial")
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use tempfile::{TempDir, tempdir};

    use super::*;

    /// Writes results whose files all have this content.
    fn write(directory: &Path, content: &str) {
        for name in DATA_FILES.into_iter().chain([MANIFEST]) {
            fs::write(directory.join(name), format!("{name} of {content}")).unwrap();
        }
    }

    /// Returns the contents of all files below a directory.
    fn contents(directory: &Path) -> BTreeSet<String> {
        let entries = fs::read_dir(directory).unwrap().map(|entry| entry.unwrap().path());
        entries
            .flat_map(|path| match path.is_dir() {
                true => contents(&path),
                false => BTreeSet::from([fs::read_to_string(path).unwrap()]),
            })
            .collect()
    }

    /// Puts the first results aside with a program that is killed before renaming number `kill`.
    fn killed(kill: usize) -> TempDir {
        let scratch = tempdir().unwrap();
        write(scratch.path(), "the first");
        let mut left = kill;
        let put_aside = put_aside_by(scratch.path(), &mut |from, to| {
            left = left.checked_sub(1).ok_or_else(|| io::Error::other("killed"))?;
            fs::rename(from, to)
        });
        assert_eq!(put_aside.is_err(), kill < RENAMINGS);
        scratch
    }

    const RENAMINGS: usize = DATA_FILES.len() + 2;

    /// The next two programs never lose a file of the first or the second results.
    #[test]
    fn no_kill_loses_earlier_results() {
        for kill in 0..=RENAMINGS {
            let scratch = killed(kill);
            let directory = scratch.path();
            let first = contents(directory);
            assert_eq!(first.len(), DATA_FILES.len() + 1);
            // If all files have been moved, a study runs as in any other directory, even if the
            // folder has not got its name yet. Otherwise the rest is put aside first.
            if directory.join(MANIFEST).exists() {
                let place = put_aside(directory).unwrap();
                assert_eq!(contents(&place), first, "killed before renaming {kill}");
            } else {
                close_earlier(directory).unwrap();
            }
            write(directory, "the second");
            let both = contents(directory);
            assert!(both.is_superset(&first), "killed before renaming {kill}");
            put_aside(directory).unwrap();
            write(directory, "the third");
            assert!(contents(directory).is_superset(&both), "killed before renaming {kill}");
            let names = fs::read_dir(directory.join(EARLIER)).unwrap();
            let names: BTreeSet<_> = names.map(|entry| entry.unwrap().file_name()).collect();
            assert_eq!(names, BTreeSet::from(["1".into(), "2".into()]), "{kill}");
        }
    }

    /// If an incomplete folder remains from a killed process, files with the same names are moved to another folder.
    #[test]
    fn a_folder_is_not_filled_up_with_other_results() {
        for kill in 1..RENAMINGS {
            let scratch = killed(kill);
            let first = contents(scratch.path());
            write(scratch.path(), "the second");
            let second = put_aside(scratch.path()).unwrap();
            assert_eq!(second, scratch.path().join("earlier/2"));
            assert_eq!(contents(&second).len(), DATA_FILES.len() + 1);
            let moved = contents(&scratch.path().join("earlier/1"));
            assert_eq!(moved.len(), kill.min(DATA_FILES.len() + 1));
            assert!(moved.is_subset(&first));
        }
    }

    #[cfg(unix)]
    #[test]
    fn links_in_the_folder_lead_nowhere() {
        for name in ["earlier", "earlier/1.partial", "earlier/7.partial"] {
            let scratch = tempdir().unwrap();
            let (directory, elsewhere) = (scratch.path().join("out"), scratch.path().join("else"));
            fs::create_dir(&elsewhere).unwrap();
            fs::create_dir(&directory).unwrap();
            write(&directory, "the first");
            let before = contents(&directory);
            let link = directory.join(name);
            fs::create_dir_all(link.parent().unwrap()).unwrap();
            std::os::unix::fs::symlink(&elsewhere, &link).unwrap();
            for refused in [put_aside(&directory).map(|_| ()), close_earlier(&directory)] {
                let error = refused.unwrap_err().to_string();
                assert!(error.contains("is a link to somewhere else"), "{error}");
            }
            fs::remove_file(link).unwrap();
            assert_eq!((contents(&directory), contents(&elsewhere)), (before, BTreeSet::new()));
        }
    }
}
