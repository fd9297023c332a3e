//! Computed files of the documentation and computed numbers in its pages: compared with the
//! checked-in ones, or written.

use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// Tests rewrite pages one at a time.
static PAGES: Mutex<()> = Mutex::new(());

/// Every computed part of each page.
const PARTS: [(&str, &str); 9] = [
    ("docs/check.md", "check"),
    ("docs/verification.md", "labels-below labels-above labels-irregular"),
    (
        "docs/methods.md",
        "distance-ratios escape-rate-thesis escape-from-thesis escape-rate slow-exponents \
         stratified-narrower",
    ),
    (
        "docs/validation.md",
        "closed-forms equilibrium-sets frictionless counts near-frictionless times-to-rest rest-over-time \
         thesis-orbits cycles block-on-belt flips independent-program newton least-minor",
    ),
    ("docs/evaluate.md", "common-draws-slow common-draws"),
    (
        "docs/optimize.md",
        "cd-rom cd-rom-ratio cd-rom-relative cd-rom-relative-thesis cd-rom-indices \
         cd-rom-indices-rest",
    ),
    ("docs/startup.md", "startup startup-ratio startup-all"),
    ("docs/identify.md", "identify identify-synthetic"),
    (
        "docs/study-file.md",
        "keys model-keys balancer-parameters block-parameters rotor-parameters distributions uncertain-sampling-keys \
         initial-condition-keys coordinates designs simulation-keys precision-keys audit-keys \
         expect-keys responses optimize-keys identify-keys prior-keys limit-keys \
         ramp-keys kick-keys hammer-keys",
    ),
];

fn parts_of(page: &str) -> Vec<&'static str> {
    let of_page = PARTS.iter().filter(|(other, _)| *other == page);
    of_page.flat_map(|(_, parts)| parts.split_whitespace()).collect()
}

fn writes() -> bool {
    std::env::var_os("STICKSLIP_WRITE_DOCS").is_some_and(|value| value == "1")
}

fn in_repository(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path)
}

/// Compares the text of a page between `<!-- computed: NAME -->` and `<!-- /computed -->` with the
/// computed one. With `STICKSLIP_WRITE_DOCS` set to 1, writes it instead (`scripts/docs`).
#[track_caller]
pub fn compare_or_write_part(page: &str, name: &str, computed: &str) {
    assert!(parts_of(page).contains(&name), "{page}: `{name}` is missing in PARTS");
    let _alone = PAGES.lock().unwrap_or_else(PoisonError::into_inner);
    let text = std::fs::read_to_string(in_repository(page)).expect("a page");
    let (begin, end) = (format!("<!-- computed: {name} -->"), "<!-- /computed -->");
    let (before, rest) = text.split_once(&begin).unwrap_or_else(|| panic!("{page}: no {begin}"));
    assert!(!rest.contains(&begin), "{page}: {begin} stands there twice");
    let (found, after) = rest.split_once(end).unwrap_or_else(|| panic!("{page}: no end of {name}"));
    if writes() {
        std::fs::write(in_repository(page), format!("{before}{begin}{computed}{end}{after}"))
            .expect("written");
        return;
    }
    assert!(
        found == computed,
        "{page}: `{name}` is out of date; `scripts/docs` writes it anew\n  found:    {found}\n  \
         computed: {computed}"
    );
}

/// Compares a file, named relative to the repository's root, with what it should contain, byte for
/// byte. With `STICKSLIP_WRITE_DOCS` set to 1 writes it instead (`scripts/docs`).
#[track_caller]
pub fn compare_or_write(path: &str, contents: &str) {
    let file = in_repository(path);
    if writes() {
        if let Some(folder) = file.parent() {
            std::fs::create_dir_all(folder).expect("a folder");
        }
        std::fs::write(&file, contents).expect("written");
        return;
    }
    let found = std::fs::read_to_string(&file)
        .unwrap_or_else(|error| panic!("{path}: {error}; `scripts/docs` writes it"));
    let differs = found.lines().zip(contents.lines()).position(|(found, due)| found != due);
    let line = differs.map_or_else(|| "its length".to_owned(), |line| format!("line {}", line + 1));
    assert!(found == contents, "{path} is out of date at {line}; `scripts/docs` writes it anew");
}

/// Every computed part of a page is computed by a test.
#[test]
fn parts_of_pages_are_computed() {
    let pages = std::fs::read_dir(in_repository("docs"))
        .expect("pages")
        .map(|entry| format!("docs/{}", entry.expect("a page").file_name().to_string_lossy()));
    for page in pages.filter(|page| page.ends_with(".md")).chain(["README.md".to_owned()]) {
        let text = std::fs::read_to_string(in_repository(&page)).expect("a page");
        let found = text.split("<!-- computed: ").skip(1).map(|rest| rest.split(' ').next());
        let mut found: Vec<&str> = found.flatten().collect();
        let mut expected = parts_of(&page);
        found.sort_unstable();
        expected.sort_unstable();
        assert_eq!(found, expected, "{page}");
    }
}
