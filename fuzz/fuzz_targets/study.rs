//! The target `study` of `tests/fuzz/targets.rs` for cargo-fuzz.
#![no_main]

#[path = "../../tests/fuzz/targets.rs"]
mod targets;

use std::sync::LazyLock;

use libfuzzer_sys::fuzz_target;
use tempfile::TempDir;

static FOLDER: LazyLock<TempDir> = LazyLock::new(|| TempDir::new().expect("a scratch folder"));

fuzz_target!(|bytes: &[u8]| {
    targets::target("study")(FOLDER.path(), bytes);
});
