//! Files of the documentation that are computed: compared with what is checked in, or written.

use std::path::Path;

/// Compares a file, named relative to the repository's root, with what it should contain, byte for
/// byte. With `STICKSLIP_WRITE_DOCS` set to 1 writes it instead (`scripts/docs`).
#[track_caller]
pub fn compare_or_write(path: &str, contents: &str) {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join(path);
    if std::env::var_os("STICKSLIP_WRITE_DOCS").is_some_and(|value| value == "1") {
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
