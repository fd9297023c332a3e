//! Earlier results in an output directory: they are moved into folders of their own below `earlier/`, from
//! which nothing is ever removed.
//!
//! A folder is `earlier/N.partial` while it is being filled, and gets its name last. What a killed program
//! leaves is either filled up, by whoever moves what is left of the same results, or closed as it is,
//! before anything else is written. No move ever takes the place of a file.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use super::directory::{is_inside, make_inside, sync_directory};
use super::manifest::MANIFEST;
use super::results::{DATA_FILES, ResultsError};

/// Folder of earlier results in an output directory.
pub const EARLIER: &str = "earlier";

/// Moves the tables, the study and the manifest of an output directory into a folder of their own below
/// `earlier/`; returns that folder.
///
/// # Errors
/// Where they cannot be moved; what is left is moved by the next try.
pub fn put_aside(directory: &Path) -> Result<PathBuf, ResultsError> {
    let unusable = |cause| ResultsError::Unusable { path: directory.to_owned(), cause };
    put_aside_by(directory, &mut |from, to| fs::rename(from, to)).map_err(unusable)
}

/// Closes the folders that a killed program has left half full; whoever writes anything into an output
/// directory without putting aside what is there calls this before.
///
/// # Errors
/// Where a folder cannot get its name.
pub fn close_earlier(directory: &Path) -> Result<(), ResultsError> {
    let unusable = |cause| ResultsError::Unusable { path: directory.to_owned(), cause };
    close_by(directory, &mut |from, to| fs::rename(from, to)).map_err(unusable)
}

/// Gives a file another name.
type Rename<'a> = &'a mut dyn FnMut(&Path, &Path) -> io::Result<()>;

fn put_aside_by(directory: &Path, rename: Rename<'_>) -> io::Result<PathBuf> {
    let folder = directory.join(EARLIER);
    make_inside(&folder)?;
    let is_there = |name: &&str| fs::symlink_metadata(directory.join(name)).is_ok();
    // The manifest last: as long as it is there, it says whose the rest is.
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

/// Gives a folder its name: its own number, or another one where something has that.
fn close(folder: &Path, filling: &Path, rename: Rename<'_>) -> io::Result<PathBuf> {
    let own = filling.with_extension("");
    let place = if fs::symlink_metadata(&own).is_ok() { free(folder) } else { own };
    rename(filling, &place)?;
    sync_directory(folder)?;
    Ok(place)
}

/// The folders that are not closed, in the order of their numbers.
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

/// The first number that nothing has, not even a folder that is being filled.
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

    /// Results whose files all have this content.
    fn write(directory: &Path, content: &str) {
        for name in DATA_FILES.into_iter().chain([MANIFEST]) {
            fs::write(directory.join(name), format!("{name} of {content}")).unwrap();
        }
    }

    /// The contents of all files below a directory.
    fn contents(directory: &Path) -> BTreeSet<String> {
        let entries = fs::read_dir(directory).unwrap().map(|entry| entry.unwrap().path());
        entries
            .flat_map(|path| match path.is_dir() {
                true => contents(&path),
                false => BTreeSet::from([fs::read_to_string(path).unwrap()]),
            })
            .collect()
    }

    /// The first results, put aside by a program that is killed before renaming number `kill`.
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

    /// Whatever the next two programs do, no file of the first results is lost, nor of the second ones.
    #[test]
    fn no_kill_loses_earlier_results() {
        for kill in 0..=RENAMINGS {
            let scratch = killed(kill);
            let directory = scratch.path();
            let first = contents(directory);
            assert_eq!(first.len(), DATA_FILES.len() + 1);
            // All of it has been moved, the folder may have its name or not: a study is run as in any other
            // directory. Before that, the rest is put aside.
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

    /// Where nobody has closed a folder that is half full, what has the same names goes into another one.
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
