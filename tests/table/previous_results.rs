//! Earlier results that are put aside, also after a program was killed while it did so.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use stickslip::table::{EARLIER, MANIFEST, close_earlier, put_aside};
use tempfile::{TempDir, tempdir};

use crate::cli::support::DATA_FILES;

/// The files of an output directory, in the order in which they are moved.
fn files() -> Vec<&'static str> {
    [&DATA_FILES[..], &[MANIFEST]].concat()
}

/// Writes results whose files all have this content.
fn write(directory: &Path, content: &str) {
    for name in files() {
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

/// Returns a directory whose first results were put aside by a program that was killed after this
/// number of moves. It had moved all files at 8 and also renamed their folder at 9.
fn killed(moves: usize) -> TempDir {
    let scratch = tempdir().unwrap();
    write(scratch.path(), "the first");
    let partial = scratch.path().join("earlier/1.partial");
    fs::create_dir_all(&partial).unwrap();
    for name in files().into_iter().take(moves) {
        fs::rename(scratch.path().join(name), partial.join(name)).unwrap();
    }
    if moves > files().len() {
        fs::rename(&partial, scratch.path().join("earlier/1")).unwrap();
    }
    scratch
}

/// The next two programs never lose a file of the first or the second results.
#[test]
fn no_kill_loses_earlier_results() {
    for moves in 0..=files().len() + 1 {
        let scratch = killed(moves);
        let directory = scratch.path();
        let first = contents(directory);
        assert_eq!(first.len(), files().len());
        // If all files have been moved, a study runs as in any other directory, even if the
        // folder has not got its name yet. Otherwise the rest is put aside first.
        if directory.join(MANIFEST).exists() {
            let place = put_aside(directory).unwrap();
            assert_eq!(contents(&place), first, "killed after {moves} moves");
        } else {
            close_earlier(directory).unwrap();
        }
        write(directory, "the second");
        let both = contents(directory);
        assert!(both.is_superset(&first), "killed after {moves} moves");
        put_aside(directory).unwrap();
        write(directory, "the third");
        assert!(contents(directory).is_superset(&both), "killed after {moves} moves");
        let names = fs::read_dir(directory.join(EARLIER)).unwrap();
        let names: BTreeSet<_> = names.map(|entry| entry.unwrap().file_name()).collect();
        assert_eq!(names, BTreeSet::from(["1".into(), "2".into()]), "{moves} moves");
    }
}

/// If an incomplete folder remains from a killed process, files with the same names are moved to
/// another folder.
#[test]
fn a_folder_is_not_filled_up_with_other_results() {
    for moves in 1..=files().len() {
        let scratch = killed(moves);
        let first = contents(scratch.path());
        write(scratch.path(), "the second");
        let second = put_aside(scratch.path()).unwrap();
        assert_eq!(second, scratch.path().join("earlier/2"));
        assert_eq!(contents(&second).len(), files().len());
        let moved = contents(&scratch.path().join("earlier/1"));
        assert_eq!(moved.len(), moves);
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
