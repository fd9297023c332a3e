//! The page on own systems quotes the example: its code and its study; its package can be built.

use std::process::Command;

use crate::cli::support::Scratch;

const PAGE: &str = include_str!("../../docs/own-system.md");
const SOURCE: &str = include_str!("../../examples/spring_block_chain/main.rs");
const EVENTS: &str = include_str!("../motion/resets.rs");
const FORCING: &str = include_str!("../motion/forcing.rs");
const OPENINGS: &str = include_str!("../classification/openings.rs");
const STUDY: &str = include_str!("../../examples/spring_block_chain/two-blocks.yaml");

/// Each block of Rust or YAML stands in the example or in the tests of events, forcing and openings, and the example is as short as the page says.
#[test]
fn code_is_that_of_the_example() {
    let mut blocks = 0;
    for block in PAGE.split("\n```").skip(1).step_by(2) {
        let (language, text) = block.split_once('\n').expect("a block");
        let files = match language {
            "rust" => vec![SOURCE, EVENTS, FORCING, OPENINGS],
            "yaml" => vec![STUDY],
            _ => continue,
        };
        assert!(files.iter().any(|file| file.contains(text)), "not in the example:\n{text}");
        blocks += 1;
    }
    assert!(blocks > 5, "{blocks} blocks");
    assert!(SOURCE.lines().count() < 200);
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
    scratch.write("src/main.rs", SOURCE);
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
