//! Output directories: each is filled by one study only, and no file in it is ever lost.

use std::fs;

use super::support::{AT_ONCE, DATA_FILES, Scratch, assert_has, of_older_model, study_text};

/// Four short runs at each of two speeds.
fn small(seed_and_more: &str) -> String {
    let sweep = "sweep: [{grid: {speed_rad_s: [-160.0, -200.0]}}]\n";
    study_text("small", "{monte_carlo: {samples: 4}}", AT_ONCE, sweep)
        .replace("seed: 5\n", seed_and_more)
}

#[test]
fn a_study_fills_its_directory_once() {
    let scratch = Scratch::with(small("seed: 5\n"));
    let ended = scratch.ended("run a.yaml --out deep/down", 0);
    let header = "point  speed_rad_s       [µm]";
    assert_has(&ended.out, &[header, "    0         -160  ", "    1         -200  ", "  0/4  "]);
    // Two lines of header, two points, a sentence about their vibration, a remedy, and the undecided runs.
    assert_eq!(ended.out.lines().count(), 7, "{}", ended.out);
    assert_has(&ended.err, &["8 runs in ", "tables in deep/down"]);
    let expected = DATA_FILES.into_iter().chain(["manifest.json", "chunks"]).map(str::to_owned);
    assert_eq!(scratch.names("deep/down"), expected.collect());

    let before = scratch.files();
    let again = scratch.stickslip("run a.yaml --out deep/down --threads 1");
    assert_eq!((again.code, &again.out), (Some(0), &ended.out));
    assert_has(&again.err, &["deep/down already holds all 8 runs of this study: nothing to do"]);
    // Only content that affects the runs counts, not the file's name, layout and comments.
    scratch.write("b.yaml", format!("# another comment\n{}", small("seed:   5\n")));
    assert_eq!(scratch.stickslip("run b.yaml --out deep/down").code, Some(0));
    fs::remove_file(scratch.path("b.yaml")).unwrap();
    assert_eq!(scratch.files(), before);
    // Without `--out` the tables go into `results`; an empty directory is used.
    fs::create_dir_all(scratch.path("results/small")).expect("the directory does not exist yet");
    scratch.well("run a.yaml");
    assert_eq!(scratch.table("results/small", "runs").num_rows(), 8);
}

/// No command fills a directory with other files, or overwrites a file with the name of a results file that it would not
/// write identically.
#[test]
fn foreign_files_and_those_under_our_names_are_left_alone() {
    let expect = "expect: [{point: {}, undecided_fraction: [0, 1]}]\n";
    let scratch = Scratch::with(small("seed: 5\n") + expect);
    scratch.write("other.yaml", small("seed: 6\n"));
    scratch.well("run other.yaml --out other");
    scratch.well("run a.yaml --out part --shard 1/1");
    let content = scratch.bytes("other/study.yaml");
    for (name, what) in [
        ("study.yaml", "a study.yaml that is not what this study writes"),
        ("study.yaml.partial", "files without a manifest.json, such as study.yaml.partial"),
        ("runs.parquet.partial", "files without a manifest.json, such as runs.parquet.partial"),
        ("thesis.tex", "files without a manifest.json, such as thesis.tex"),
    ] {
        fs::create_dir(scratch.path("mine")).unwrap();
        scratch.write(&format!("mine/{name}"), &content);
        let found = format!("found:   {what}");
        let refused = ["mine: this directory is not empty", &found, "allowed: another directory"];
        for command in ["run a.yaml", "merge part", "verify a.yaml"] {
            scratch.refused(&format!("{command} --out mine"), &refused);
        }
        fs::remove_dir_all(scratch.path("mine")).unwrap();
    }
    fs::create_dir(scratch.path("mine")).unwrap();
    scratch.write("mine/manifest.json", "{\"name\": \"a web application\"}");
    let damaged =
        ["mine: manifest.json is damaged, or is not a manifest of stickslip", "allowed: "];
    scratch.refused("run a.yaml --out mine", &damaged);
    fs::remove_file(scratch.path("mine/manifest.json")).expect("a file of this test");
    // The study's own file, in its own directory.
    scratch.write("mine/study.yaml", small("seed: 5\n"));
    scratch.refused("run mine/study.yaml --out mine", &["mine: this directory is not empty"]);
    // A file with the content that the program would write may be replaced.
    fs::create_dir(scratch.path("same")).unwrap();
    fs::copy(scratch.path("part/study.yaml"), scratch.path("same/study.yaml")).unwrap();
    scratch.well("run same/study.yaml --out same");
    assert_eq!(scratch.data("same"), scratch.data("part"));
}

/// Leftovers of a run that was killed at its start (the study or a part of it, unfinished tables,
/// an empty list of finished runs) do not prevent the study from continuing.
#[test]
fn a_study_continues_after_a_kill_at_its_start() {
    let scratch = Scratch::with(small("seed: 5\n"));
    scratch.well("run a.yaml --out whole");
    let study = scratch.bytes("whole/study.yaml");
    for (number, (name, content)) in [
        ("study.yaml", &study[..]),
        ("study.yaml.abc123.stickslip-partial", &study[..100]),
        ("study.yaml.abc123.stickslip-partial", &[]),
        ("runs.parquet.abc123.stickslip-partial/table/part-00000.parquet", b"PAR1"),
    ]
    .into_iter()
    .enumerate()
    {
        let out = format!("out{number}");
        let path = scratch.path(&out).join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, content).unwrap();
        scratch.well(&format!("run a.yaml --out {out}"));
        assert_eq!(scratch.data(&out), scratch.data("whole"), "{name}");
        assert_eq!(scratch.names(&out), scratch.names("whole"), "{name}");
    }
    // With finished runs beside them, files that may be the user's are moved aside.
    fs::create_dir_all(scratch.path("aside/chunks")).unwrap();
    scratch.write("aside/study.yaml", "mine");
    scratch.well("run a.yaml --out aside");
    assert_eq!(scratch.data("aside"), scratch.data("whole"));
    let aside = fs::read_to_string(scratch.path("aside/earlier/1/study.yaml"));
    assert_eq!(aside.unwrap(), "mine");
}

/// In incomplete results, too, only files that the program has written are replaced.
#[test]
fn unfinished_results_continue_and_nothing_else_is_replaced() {
    type Change = (&'static str, fn(Vec<u8>) -> Vec<u8>);
    let changes: [Change; 3] = [
        ("study.yaml", |mut study| {
            study.extend(b"# years of work\n");
            study
        }),
        ("runs.parquet", |mut table| {
            table[40] ^= 1;
            table
        }),
        ("points.parquet", |_| b"mine".to_vec()),
    ];
    for command in ["resume out", "run a.yaml --out out"] {
        for (name, change) in changes {
            let scratch = Scratch::with(small("seed: 5\n"));
            scratch.well("run a.yaml --out whole");
            scratch.ended("run a.yaml --out out --max-seconds 0", 130);
            let path = scratch.path("out").join(name);
            let changed = change(fs::read(&path).unwrap_or_default());
            fs::write(&path, &changed).unwrap();
            let told = [
                "another file has the name of a result",
                name,
                "earlier results moved to out/earlier/1",
            ];
            scratch.tells(command, 0, &told);
            assert_eq!(fs::read(scratch.path("out/earlier/1").join(name)).unwrap(), changed);
            assert_eq!(scratch.data("out"), scratch.data("whole"), "{name}");
        }
    }
}

#[test]
fn an_empty_path_is_no_directory() {
    let scratch = Scratch::with(small("seed: 5\n"));
    scratch.well("run a.yaml --out part");
    for command in
        ["run a.yaml", "verify a.yaml", "merge part", "equilibria a.yaml", "replay part 0"]
    {
        let before = scratch.files();
        let output = scratch.command(command).args(["--out", ""]).output().unwrap();
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{command}: {said}");
        assert_has(&said, &["--out <DIR"]);
        assert_eq!(scratch.files(), before, "{command}");
    }
    // The library returns the same error.
    let study = super::support::parse(small("seed: 5\n"));
    let error =
        stickslip::table::inspect(std::path::Path::new(""), &study, "1/1", &[]).unwrap_err();
    assert_has(&error.to_string(), &["\"\": cannot be used", "found:   an empty path"]);
}

/// A path below a file cannot be created by any user; tests may run as root, whom no permission
/// stops.
#[test]
fn directories_that_cannot_be_made() {
    let scratch = Scratch::with(small("seed: 5\n"));
    for out in ["a.yaml", "a.yaml/out", "a.yaml/further/down"] {
        let message = [out, ": cannot be used as output directory\n  found: ", "allowed: "];
        scratch.refused(&format!("run a.yaml --out {out}"), &message);
    }
}

/// Commands that read results name the command that has written another directory, and what reads it.
#[test]
fn directories_of_other_commands_are_named() {
    let scratch = Scratch::ran(small("seed: 5\n"));
    scratch.well("replay out 0 --out motion");
    scratch.well("equilibria a.yaml --no-set --grid 8 --out sets");
    fs::create_dir(scratch.path("search")).unwrap();
    scratch.write("search/evaluations.parquet", "");
    for (directory, file, writer, reader) in [
        ("motion", "trajectory.parquet", "replay", "`stickslip-figures motion` draws"),
        ("sets", "equilibrium_set_summary.parquet", "equilibria", "`stickslip-figures sets` draws"),
        ("search", "evaluations.parquet", "optimize", "`stickslip optimize STUDY --out search`"),
    ] {
        let found =
            format!("found:   {file}, which `stickslip {writer}` writes, and no manifest.json");
        for command in ["summary", "report", "resume"] {
            // The page of a search is another one.
            if (command, directory) == ("report", "search") {
                continue;
            }
            let said = ["holds no results of `stickslip run`", &found, reader];
            scratch.refused(&format!("{command} {directory}"), &said);
        }
    }
}

/// Every command that reads results refuses what holds none of this version.
#[test]
fn what_holds_no_results_is_refused() {
    let scratch = Scratch::ran(small("seed: 5\n"));
    let commands =
        ["summary DIR", "report DIR", "resume DIR", "replay DIR 0", "merge DIR", "compare DIR DIR"];
    let refused = |directory: &str, parts: &[&str]| {
        for command in commands {
            scratch.refused(&command.replace("DIR", directory), &[parts, &["allowed: "]].concat());
        }
    };
    refused("nowhere", &["nowhere: this directory does not exist"]);
    refused("a.yaml", &["a.yaml: this is a file, not a directory of results", "the study small"]);
    scratch.refused("report a.yaml", &["`stickslip run a.yaml`", "results/small"]);
    let older = of_older_model(&scratch.manifest("out").to_string());
    scratch.write("out/manifest.json", older);
    refused("out", &["another version", "version 0 of the model"]);
}
