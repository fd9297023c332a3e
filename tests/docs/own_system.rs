//! The page on systems in Rust quotes tests, and its package can be built.

use std::process::Command;

use crate::cli::support::Scratch;

const PAGE: &str = include_str!("../../docs/own-system.md");
const TESTS: [&str; 3] = [
    include_str!("../motion/resets.rs"),
    include_str!("../motion/forcing.rs"),
    include_str!("../classification/openings.rs"),
];
/// What the page says about the program as a whole.
const MAIN: &str =
    "fn main() -> ExitCode {\n    stickslip::cli::run(Registry::new().with(&KIND))\n}";

/// Each block of Rust stands in the tests of events, forcing and openings.
#[test]
fn code_is_that_of_tests() {
    let mut blocks = 0;
    for block in PAGE.split("\n```rust\n").skip(1) {
        let (text, _) = block.split_once("\n```").expect("its end");
        assert!(
            text == MAIN || TESTS.iter().any(|file| file.contains(text)),
            "no test has:\n{text}"
        );
        blocks += 1;
    }
    assert_eq!(blocks, 6);
}

/// Cargo finds the program and its dependencies in the package of the page.
#[test]
fn the_package_is_one() {
    let (_, rest) = PAGE.split_once("```toml\n").expect("a package");
    let (manifest, _) = rest.split_once("```").expect("its end");
    let scratch = Scratch::new();
    let checkout = env!("CARGO_MANIFEST_DIR");
    assert!(manifest.contains("\"../stickslip\""), "{manifest}");
    scratch.write("Cargo.toml", manifest.replace("../stickslip", checkout));
    std::fs::create_dir(scratch.path("src")).expect("a folder");
    scratch.write("src/main.rs", MAIN);
    // The versions of the lock file need no network.
    let lock = std::path::Path::new(checkout).join("Cargo.lock");
    std::fs::copy(lock, scratch.path("Cargo.lock")).expect("a lock file");
    let mut cargo = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    cargo.args(["tree", "--offline", "--depth", "1"]).current_dir(scratch.path("."));
    let output = cargo.output().expect("cargo starts");
    let printed = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(
        printed.starts_with("my-system v0.1.0") && printed.contains(" stickslip v"),
        "{printed}"
    );
}
