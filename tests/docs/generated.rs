//! Pages and pictures of `docs/` that are made from real runs: compared by the tests, and written by
//! `scripts/docs`.

use std::path::Path;

/// The environment variable with which the tests write the files instead of comparing them.
const WRITE: &str = "STICKSLIP_WRITE_DOCS";

/// Compares what has been made with the file in `docs/`, or writes it there.
pub fn compare_or_write(name: &str, contents: &str) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs").join(name);
    if std::env::var_os(WRITE).is_some() {
        std::fs::write(&path, contents).expect("the file can be written");
        return;
    }
    let found = std::fs::read_to_string(&path).unwrap_or_default();
    let differing = found.lines().zip(contents.lines()).position(|(old, new)| old != new);
    if let Some(line) = differing {
        let [old, new] = [found.as_str(), contents].map(|text| text.lines().nth(line));
        panic!("docs/{name}, line {}: `scripts/docs` makes it anew\n{old:?}\n{new:?}", line + 1);
    }
    assert!(found == contents, "docs/{name} has another length; `scripts/docs` makes it anew");
}
