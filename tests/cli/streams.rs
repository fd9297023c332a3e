//! Output streams, and streams that are closed or full.

use std::fs::OpenOptions;
use std::io::Read;
use std::process::Stdio;

use super::support::{AT_ONCE, Scratch, study_text};

fn scratch() -> Scratch {
    let rest = "sweep: [{grid: {speed_rad_s: [-160.0, -200.0]}}]\n\
                uncertain: {ball_mass_kg: {normal: {mean: 1.4e-4, std_dev: 1.4e-4}}}\n";
    let scratch = Scratch::with(study_text("a", "{monte_carlo: {samples: 50}}", AT_ONCE, rest));
    let expect = "expect: [{point: {}, undecided_fraction: [0.5, 1.0]}]\n";
    scratch.write("b.yaml", study_text("b", "{monte_carlo: {samples: 5}}", AT_ONCE, expect));
    scratch
}

#[test]
fn quiet_is_silent() {
    let scratch = scratch();
    for (arguments, code) in [
        ("run b.yaml --quiet --out out", 0),
        ("run b.yaml --quiet --out out", 0),
        ("run a.yaml -q", 3),
        ("verify b.yaml --quiet", 0),
    ] {
        let ended = scratch.stickslip(arguments);
        assert_eq!(
            (ended.code, ended.out.as_str(), ended.err.as_str()),
            (Some(code), "", ""),
            "{arguments}"
        );
    }
    // Requested data are printed; an error is not suppressed.
    let asked = scratch.json("run b.yaml --quiet --json --out other");
    assert_eq!(asked["runs_finished"], 5);
    scratch.refused("run missing.yaml --quiet", &["missing.yaml"]);
}

#[test]
fn no_escape_sequences_where_there_is_no_terminal() {
    let scratch = scratch();
    for arguments in
        ["run a.yaml", "run missing.yaml", "run --thread", "--help", "run --help", "verify b.yaml"]
    {
        let mut command = scratch.command(arguments);
        let ended = super::support::Ended::of(command.env("TERM", "xterm").output().unwrap());
        let both = format!("{}{}", ended.out, ended.err);
        assert!(!both.contains('\u{1b}') && !both.contains('\r'), "{arguments}: {both:?}");
    }
}

/// A device that takes no byte.
fn full() -> Stdio {
    OpenOptions::new().write(true).open("/dev/full").unwrap().into()
}

#[test]
fn a_full_stderr_costs_no_run() {
    let scratch = scratch();
    let ended = scratch.command("run b.yaml --out out").stderr(full()).output().unwrap();
    assert_eq!(ended.status.code(), Some(0));
    assert_eq!(scratch.table("out", "runs").num_rows(), 5);
    let refused = scratch.command("run missing.yaml").stderr(full()).output().unwrap();
    assert_eq!(refused.status.code(), Some(2));
}

#[test]
fn a_full_stdout_is_an_error_after_the_tables() {
    let scratch = scratch();
    let ended = scratch.command("run b.yaml --out out").stdout(full()).output().unwrap();
    assert_eq!(ended.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&ended.stderr).contains("cannot write to standard output"));
    assert_eq!(scratch.manifest("out")["complete"], true);
}

#[test]
fn a_reader_that_goes_early_ends_expand_well() {
    let scratch = scratch();
    let design = "{monte_carlo: {samples: 1000000000000}}";
    scratch.write("endless.yaml", study_text("endless", design, AT_ONCE, ""));
    let mut child = scratch.command("expand endless.yaml").spawn().unwrap();
    let mut reader = child.stdout.take().unwrap();
    let mut start = [0; 6];
    reader.read_exact(&mut start).unwrap();
    assert_eq!(&start, b"run_id");
    drop(reader);
    let mut message = String::new();
    child.stderr.take().unwrap().read_to_string(&mut message).unwrap();
    assert_eq!((child.wait().unwrap().code(), message.as_str()), (Some(0), ""));
}
