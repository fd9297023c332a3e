//! `files.json`: lists that a killed process leaves, and lists that are refused.

use std::fs;

use stickslip::table::{FILES, FileEntry, FileList};
use tempfile::tempdir;

#[test]
fn the_list_is_valid_if_a_process_is_killed_before_or_after_a_renaming() {
    let (scratch, other) = (tempdir().unwrap(), tempdir().unwrap());
    let entry_of = |content: &str| {
        let path = other.path().join("content");
        fs::write(&path, content).unwrap();
        FileEntry::of(&path, None).unwrap()
    };
    let there = |content: &str| fs::write(scratch.path().join("a"), content).unwrap();
    let announced = |list: &mut FileList, content: &str| {
        list.announce(scratch.path(), &[("a".to_owned(), entry_of(content))]).unwrap();
    };
    // Returns the changed files of the list on disk, and the list without what was replaced.
    let reconciled = || {
        let mut list = FileList::read(scratch.path()).unwrap().unwrap();
        let changed = list.reconcile(scratch.path());
        assert_eq!(list.clone().reconcile(scratch.path()), changed, "once is enough");
        (changed, list)
    };
    let mut list = FileList::default();
    list.write(scratch.path(), "a", b"one", true).expect("the folder is writable");
    // The process is killed before the renaming, twice.
    announced(&mut list, "two");
    let (changed, mut list) = reconciled();
    assert!(changed.is_empty());
    announced(&mut list, "three");
    assert!(reconciled().0.is_empty());
    // The process is killed after the renaming.
    there("three");
    assert!(reconciled().0.is_empty());
    for other in ["two", "thre3", ""] {
        there(other);
        assert_eq!(reconciled().0, ["a"], "{other}");
    }
    // A file that is written with the same content, or has its name for good, replaces nothing.
    let mut list = FileList::default();
    let is_replaced = |name: &str| {
        let text = fs::read(scratch.path().join(FILES)).unwrap();
        let list: serde_json::Value = serde_json::from_slice(&text).unwrap();
        list["replaced"].get(name).is_some()
    };
    for (content, replaces) in [("one", false), ("one", false), ("two", true), ("two", false)] {
        list.write(scratch.path(), "a", content.as_bytes(), true).expect("the folder is writable");
        assert_eq!(is_replaced("a"), replaces, "{content}");
    }
    list.write(scratch.path(), "a", b"three", true).expect("the folder is writable");
    list.write(scratch.path(), "b", b"one", true).expect("the folder is writable");
    assert!(!is_replaced("a"));
    list.remove("b");
    fs::remove_file(scratch.path().join("a")).unwrap();
    list.save(scratch.path()).unwrap();
    assert_eq!(reconciled(), (vec![], FileList::default()));
}

#[test]
fn invalid_lists_are_refused() {
    let scratch = tempdir().unwrap();
    assert!(FileList::read(scratch.path()).unwrap().is_none());
    let hash = "0".repeat(64);
    let entry = format!("{{\"rows\": null, \"bytes\": 1, \"sha256\": \"{hash}\"}}");
    for text in [
        "",
        "{}",
        "{\"format\": 99, \"files\": {}}",
        &format!("{{\"format\": 1, \"files\": {{\"../a\": {entry}}}}}"),
        &format!("{{\"format\": 1, \"files\": {{\"/a\": {entry}}}}}"),
        &format!("{{\"format\": 1, \"files\": {{\"a\\u001b\": {entry}}}}}"),
    ] {
        fs::write(scratch.path().join(FILES), text).unwrap();
        let error = FileList::read(scratch.path()).unwrap_err().to_string();
        assert!(error.contains("not a list of files") && !error.contains('\u{1b}'), "{error}");
    }
}
