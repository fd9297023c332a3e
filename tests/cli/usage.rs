//! Wrong arguments and unreadable studies: exit code 2, one message, nothing written.

use std::fs;

use super::support::{AT_ONCE, Ended, Scratch, assert_has, study_text};

fn scratch() -> Scratch {
    Scratch::with(study_text("a", "{monte_carlo: {samples: 4}}", AT_ONCE, ""))
}

#[test]
fn wrong_arguments_are_refused() {
    let scratch = scratch();
    scratch.refuses(
        "",
        r#"run a.yaml --threads 0 ¦ --threads ¦ found "0" ¦ allowed: a whole number from 1
run a.yaml --threads x ¦ --threads ¦ found "x" ¦ allowed: a whole number from 1
run a.yaml --threads 1000000 ¦ --threads ¦ found "1000000" ¦ 1 to 1024
run a.yaml --out= ¦ --out ¦ value is required
run a.yaml --threads -1 ¦ --threads ¦ found "-1" ¦ allowed: a whole number from 1
run a.yaml --chunk 0 ¦ --chunk ¦ found "0" ¦ allowed: a whole number from 1
run a.yaml --shard 3/2 ¦ --shard ¦ found "3/2" ¦ allowed: K/N with whole numbers 1 ≤ K ≤ N, such as 2/8
run a.yaml --shard 0/2 ¦ --shard ¦ found "0/2" ¦ allowed: K/N with whole numbers 1 ≤ K ≤ N, such as 2/8
run a.yaml --shard x ¦ --shard ¦ found "x" ¦ allowed: K/N with whole numbers 1 ≤ K ≤ N, such as 2/8
verify a.yaml --threads 0 ¦ --threads ¦ found "0" ¦ allowed: a whole number from 1
expand a.yaml --shard 3/2 ¦ --shard ¦ found "3/2" ¦ allowed: K/N with whole numbers 1 ≤ K ≤ N, such as 2/8
run a.yaml --thread 2 ¦ unexpected argument '--thread' ¦ '--threads'
run a.yaml b.yaml ¦ unexpected argument 'b.yaml'
run ¦ <STUDY>
rum a.yaml ¦ unrecognized subcommand 'rum' ¦ 'run'
completions tcsh ¦ invalid value 'tcsh' ¦ bash ¦ fish
 ¦ Usage: stickslip <COMMAND> ¦ Examples: ¦ Exit codes:"#,
    );
}

#[test]
fn studies_that_cannot_be_read() {
    let scratch = scratch();
    fs::create_dir(scratch.path("folder.yaml")).unwrap();
    scratch.write("latin-1.yaml", b"schema: 1\nname: caf\xe9\n");
    scratch.write("empty.yaml", "");
    scratch.write("misspelt.yaml", study_text("a", "{monte_carlo: {smaples: 4}}", AT_ONCE, ""));
    for command in ["run", "check", "expand", "verify"] {
        scratch.refuses(
            command,
            "missing.yaml ¦ missing.yaml: No such file
folder.yaml ¦ folder.yaml ¦ a directory
latin-1.yaml ¦ latin-1.yaml ¦ not UTF-8 ¦ an invalid byte at position 19
empty.yaml ¦ empty.yaml ¦ empty
misspelt.yaml ¦ misspelt.yaml:5: ¦ smaples ¦ samples (did you mean this?)",
        );
    }
}

/// Each command shows examples, and paragraphs of its help fill the width of the terminal: a line ends only where the next
/// word does not fit.
#[test]
fn help_has_examples_and_is_wrapped_once() {
    let scratch = Scratch::new();
    scratch.prints("--help", &["Examples:\n  stickslip ", "130  interrupted"]);
    let version = format!("stickslip {}\n", env!("CARGO_PKG_VERSION"));
    assert_eq!(scratch.well("--version"), version);
    let mut paragraphs = 0;
    for width in [72_usize, 100] {
        for command in stickslip::cli::definition().get_subcommands() {
            let name = command.get_name();
            let help = |arguments: &str| {
                let mut command = scratch.command(arguments);
                Ended::of(command.env("COLUMNS", width.to_string()).output().expect("it ends")).out
            };
            let text = help(&format!("{name} --help"));
            assert_eq!(text, help(&format!("help {name}")));
            let (_, examples) = text.split_once("Examples:").expect("examples");
            assert_has(examples, &[format!("  stickslip {name} ")]);
            for pair in examples.lines().collect::<Vec<_>>().windows(2) {
                let &[line, next] = pair else { continue };
                let prose = |line: &str| !line.is_empty() && !line.starts_with(' ');
                if prose(line) && prose(next) {
                    let word = next.split(' ').next().unwrap().chars().count();
                    let fits = line.chars().count() + 1 + word <= width;
                    assert!(!fits, "{name} at {width}: {line:?}, {next:?}");
                    paragraphs += 1;
                }
            }
        }
    }
    assert!(paragraphs > 50, "{paragraphs} lines");
}
