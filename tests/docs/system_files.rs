//! The page on system files quotes shipped systems.

use crate::cli::support::parse;

const PAGE: &str = include_str!("../../docs/system-files.md");

/// Each block of YAML stands in a shipped system or study.
#[test]
fn systems_on_the_page_are_shipped() {
    let shipped = [
        include_str!("../../studies/systems/belt_oscillator.yaml"),
        include_str!("../../studies/systems/woodpecker.yaml"),
        include_str!("../../studies/systems/block_chain.yaml"),
        include_str!("../../studies/systems/unbalanced_shaft.yaml"),
        include_str!("../../studies/systems/shaken_block.yaml"),
        include_str!("../../studies/belt-oscillator.yaml"),
    ];
    let excerpt = "parameters: {m: 1 kg";
    let mut blocks = 0;
    for block in PAGE.split("\n```yaml\n").skip(1) {
        let (text, _) = block.split_once("\n```").expect("its end");
        if text.starts_with(excerpt) {
            let keys = "system: shaken\ncoordinates: {x: {unit: m}}\nmass: {x: {x: m}}\n\
                        contacts: {ground: {normal: load, sliding: x'}}\n";
            let system = format!("{keys}{text}").replace('\n', "\n    ");
            parse(format!(
                "schema: 1\nname: a\nseed: 1\nmodel:\n  system:\n    {system}\n\
                 initial_conditions: {{design: {{monte_carlo: {{samples: 1}}}}}}\n"
            ));
            blocks += 1;
            continue;
        }
        assert!(shipped.iter().any(|file| file.contains(text)), "not shipped:\n{text}");
        blocks += 1;
    }
    assert_eq!(blocks, 9);
}
