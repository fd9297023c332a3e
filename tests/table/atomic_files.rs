//! Files and directories that are complete or absent, and temporary names.

use std::fs;

use stickslip::table::column::Columns;
use stickslip::table::{
    TableWriter, clear_temporaries, make_directory, make_inside, write_atomically,
};
use tempfile::tempdir;

/// Returns the names in a directory, sorted.
fn names(directory: &std::path::Path) -> Vec<String> {
    let entries = fs::read_dir(directory).unwrap();
    let mut names: Vec<String> =
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

#[test]
fn files_are_written_whole_or_not_at_all() {
    let scratch = tempdir().unwrap();
    let path = scratch.path().join("a.json");
    fs::write(scratch.path().join("a.json.partial"), "mine").unwrap();
    write_atomically(&path, b"one").unwrap();
    write_atomically(&path, b"two").unwrap();
    assert_eq!(fs::read_to_string(&path).unwrap(), "two");
    assert_eq!(fs::read_to_string(scratch.path().join("a.json.partial")).unwrap(), "mine");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        let mode = |name: &str| {
            let found = fs::metadata(scratch.path().join(name)).unwrap();
            found.permissions().mode()
        };
        assert_eq!(mode("a.json"), mode("a.json.partial"), "as any new file");
    }
    // A directory is not replaced, and the attempt leaves nothing.
    fs::create_dir_all(scratch.path().join("b/full")).unwrap();
    assert!(write_atomically(&scratch.path().join("b"), b"x").is_err());
    assert_eq!(names(scratch.path()), ["a.json", "a.json.partial", "b"]);
}

/// Two writers of one table have different temporary names, which are recognised as temporary.
#[test]
fn temporary_names_are_unique_and_recognised() {
    let scratch = tempdir().unwrap();
    let target = scratch.path().join("r.parquet");
    let start = || {
        let mut list = Columns::<u64>::new();
        list.count("row", |row| *row).meaning("number of the row");
        TableWriter::create(&target, list.finish(), "here").unwrap()
    };
    let (_one, _other) = (start(), start());
    let found = names(scratch.path());
    assert!(found.len() == 2 && found[0] != found[1], "{found:?}");
    for name in found {
        assert!(name.starts_with("r.parquet.") && name.ends_with(".stickslip-partial"), "{name}");
    }
    clear_temporaries(scratch.path(), |name| name == "r.parquet").expect("removed");
    assert!(names(scratch.path()).is_empty());
}

#[test]
fn only_temporaries_of_these_files_are_cleared_away() {
    let scratch = tempdir().unwrap();
    let mut kept = [
        ".abcdef.stickslip-partial",
        "a.parquet",
        "a.parquet.abc-ef.stickslip-partial",
        "a.parquet.abc.stickslip-partial",
        "a.parquet.abcdef.stickslip-partial2",
        "a.parquet.partial",
        "a.parquet.stickslip-partial",
        "c.parquet.abcdef.stickslip-partial",
    ];
    kept.iter().for_each(|name| fs::write(scratch.path().join(name), "kept").unwrap());
    let gone = ["a.parquet.abcdef.stickslip-partial", "b.json.012345.stickslip-partial"];
    fs::create_dir_all(scratch.path().join(gone[0]).join("table")).unwrap();
    fs::write(scratch.path().join(gone[1]), "half").unwrap();
    clear_temporaries(scratch.path(), |name| ["a.parquet", "b.json"].contains(&name))
        .expect("removed");
    kept.sort_unstable();
    assert_eq!(names(scratch.path()), kept);
}

#[cfg(unix)]
#[test]
fn a_link_is_no_directory_inside() {
    let scratch = tempdir().unwrap();
    let (elsewhere, link) = (scratch.path().join("elsewhere"), scratch.path().join("link"));
    for there in [false, true] {
        if there {
            fs::create_dir(&elsewhere).unwrap();
            fs::remove_file(&link).unwrap();
        }
        std::os::unix::fs::symlink(&elsewhere, &link).unwrap();
        let error = make_inside(&link).unwrap_err().to_string();
        assert_eq!(error, "link is a link to somewhere else");
        assert_eq!(elsewhere.exists(), there);
    }
    // The user may name a link as the output directory.
    make_directory(&link).unwrap();
}
