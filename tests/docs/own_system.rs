//! The page on own systems quotes the example: its code and its study.

const PAGE: &str = include_str!("../../docs/own-system.md");
const SOURCE: &str = include_str!("../../examples/spring_block_chain/main.rs");
const EVENTS: &str = include_str!("../motion/resets.rs");
const STUDY: &str = include_str!("../../examples/spring_block_chain/two-blocks.yaml");

/// Each block of Rust or YAML stands in the example or in the tests of events, and the example is as short as the page says.
#[test]
fn code_is_that_of_the_example() {
    let mut blocks = 0;
    for block in PAGE.split("\n```").skip(1).step_by(2) {
        let (language, text) = block.split_once('\n').expect("a block");
        let files = match language {
            "rust" => vec![SOURCE, EVENTS],
            "yaml" => vec![STUDY],
            _ => continue,
        };
        assert!(files.iter().any(|file| file.contains(text)), "not in the example:\n{text}");
        blocks += 1;
    }
    assert!(blocks > 5, "{blocks} blocks");
    assert!(SOURCE.lines().count() < 200);
}
