//! `stickslip summary`: the points of results as printed by `run`, and with all their columns.

use std::fs::{self, File};

use arrow::array::RecordBatch;
use arrow::datatypes::DataType;
use parquet::arrow::ArrowWriter;
use parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use serde_json::{Value, json};
use stickslip::engine::Lock;

use super::support::{
    AT_ONCE, Scratch, assert_has, counts, json_lines, numbers, study_text, words,
};

/// Three points with text parameters, an audit and failures.
pub const REST: &str = "sweep: [{zip: {speed_rad_s: [-160.0, -200.0, -216.3772], \
                    friction_coefficient: [2.75e-3, 2.75e-5, 1.0e-3], \
                    normal_force: [lagrange, newton, lagrange]}}]\n\
                    audit: {fraction: 0.5}\n\
                    uncertain: {ball_mass_kg: {normal: {mean: 1.4e-4, std_dev: 1.4e-4}}}\n";

pub fn study(samples: u32, end_time_s: f64, rest: &str) -> String {
    study_text("short", &format!("{{monte_carlo: {{samples: {samples}}}}}"), end_time_s, rest)
}

/// Returns a finished study in `out`, and the output of `run`.
pub fn finished() -> (Scratch, String) {
    let scratch = Scratch::with(study(20, 0.5, REST));
    let ended = scratch.ended("run a.yaml --out out", 3);
    (scratch, ended.out)
}

#[test]
fn the_table_is_the_one_that_run_prints() {
    let (scratch, printed) = finished();
    let points = scratch.table("out", "points");
    let sum = |name| counts(&points, name).iter().sum::<u64>();
    let [failed, flips, audited] = ["failed_runs", "audit_flips", "audited_runs"].map(sum);
    assert!(failed > 0 && audited > 0);
    let title = format!(
        "short: stickslip {}, seed 5, all 60 runs finished, {failed} failed ({failed} \
         invalid_parameters), {flips} of {audited} audited runs flipped",
        env!("CARGO_PKG_VERSION")
    );
    let before = scratch.files();
    let ended = scratch.stickslip("summary out");
    assert_eq!((ended.code, ended.err.as_str()), (Some(0), ""));
    assert_eq!(ended.out, format!("{title}\n\n{printed}"));
    // The same cells in Markdown.
    let markdown = scratch.well("summary out --format markdown");
    let (first, table) = markdown.split_once("\n\n").unwrap();
    assert_eq!(first, title);
    let lines: Vec<&str> = table.lines().collect();
    // The header has one line here and two on a terminal; a blank line precedes the sentences.
    let sentences = printed.lines().count() - 5;
    assert!(sentences > 0, "{printed}");
    assert_eq!(lines.len(), 2 + 3 + 2 * sentences);
    assert!(lines[1].replace("| --: ", "") == "|", "{}", lines[1]);
    for (line, printed) in lines[2..5].iter().zip(printed.lines().skip(2)) {
        let cells = line.trim_matches('|').split('|').map(str::trim).collect::<Vec<_>>();
        assert_eq!(cells.join(" "), printed.split_whitespace().collect::<Vec<_>>().join(" "));
        assert_eq!(cells.len(), lines[0].trim_matches('|').split('|').count());
    }
    assert_eq!(scratch.files(), before);
    // The first numbers of a line are the residual vibration in µm, as in `points.parquet`, and the sentence below counts the
    // points at which most runs vibrate more than without balls.
    let columns = ["amplitude_p50_m", "amplitude_p95_m", "amplitude_without_balls_m"];
    for (point, line) in printed.lines().skip(2).take(3).enumerate() {
        // The number of the point and three swept parameters precede them.
        let cells: Vec<f64> = line
            .split_whitespace()
            .skip(4)
            .take(3)
            .map(|cell| cell.parse().expect("a number"))
            .collect();
        for (name, cell) in columns.iter().zip(cells) {
            let value = 1e6 * numbers(&points, name)[point].expect("a value");
            assert!((cell / value - 1.0).abs() < 0.01, "{name}: {cell} and {value}\n{printed}");
        }
    }
    let worse = numbers(&points, "worse_than_without_balls_fraction");
    let mostly =
        |holds: fn(f64) -> bool| worse.iter().filter(|part| holds(part.expect("a value"))).count();
    let said = match (mostly(|part| part > 0.5), mostly(|part| part < 0.5)) {
        (0, 3) => "At all 3 points most runs vibrate less than ".to_owned(),
        (0, _) => "At none of the 3 points ".to_owned(),
        (more, _) => format!("At {more} of 3 points most runs vibrate more than "),
    };
    assert_has(&printed, &[said]);
    let json: Value = scratch.stickslip("run a.yaml --out out --json").json();
    assert_eq!(json["failures"], json!({"invalid_parameters": failed}));
    for (point, worse) in worse.iter().enumerate() {
        let row = &json["points"][point];
        assert_eq!(row["worse_than_without_balls_fraction"], json!(worse));
    }
}

#[test]
fn a_complete_study_that_is_run_again_shows_its_points() {
    let (scratch, printed) = finished();
    let again = scratch.stickslip("run a.yaml --out out");
    assert_eq!((again.code, &again.out), (Some(3), &printed));
    assert_has(&again.err, &["out already holds all 60 runs of this study: nothing to do"]);
    assert_eq!(scratch.stickslip("resume out").out, printed);
    let report = |arguments: &str| -> Value { scratch.stickslip(arguments).json() };
    let fresh = report("run a.yaml --out other --json");
    let again = report("run a.yaml --out other --json");
    let keys = ["study", "out", "runs_planned", "runs_finished", "interrupted"];
    let whole = [json!("short"), json!("other"), json!(60), json!(60), json!(false)];
    assert_eq!(keys.map(|key| fresh[key].clone()), whole);
    assert_eq!(fresh["points"].as_array().map(Vec::len), Some(3));
    assert_eq!(
        (&fresh["points"][1]["speed_rad_s"], &fresh["points"][1]["runs"]),
        (&json!(-200.0), &json!(20))
    );
    assert_eq!(again["points"], fresh["points"]);
    let flags = ["already_complete", "interrupted"].map(|key| again[key].clone());
    assert_eq!(flags, [json!(true), json!(false)]);
    assert_eq!(scratch.stickslip("run a.yaml --out out --quiet").out, "");
}

/// Blocks have no equilibrium set, and a required precision is reported each time.
#[test]
fn other_models_and_a_precision() {
    let rest = "model: {kind: block_on_spring, parameters: {mass_kg: 1, stiffness_n_m: 100, \
                normal_force_n: 10, friction_coefficient: 0.1}}\n\
                sweep: [{grid: {stiffness_n_m: [50, 100]}}]\n\
                precision: {equilibrium_fraction: 0.1, max_runs: 64}\n";
    let text = study(16, 10.0, rest)
        .replace("initial_conditions: {", "initial_conditions: {box: {position_m: [-0.1, 0.1]}, ");
    let scratch = Scratch::with(text);
    let ended = scratch.ended("run a.yaml --out out", 0);
    let again = scratch.stickslip("run a.yaml --out out");
    assert_eq!(again.out, ended.out);
    let line = |text: &str| {
        text.lines().find(|line| line.starts_with("the half width")).map(str::to_owned)
    };
    assert!(line(&ended.err).is_some());
    let header: Vec<&str> = ended.out.lines().nth(1).unwrap().split_whitespace().collect();
    assert_eq!(header[..3], ["point", "stiffness_n_m", "rest"], "no vibration: {}", ended.out);
    assert_eq!(line(&again.err), line(&ended.err));
    assert!(scratch.well("summary out").ends_with(&ended.out));
}

#[test]
fn csv_and_json_hold_every_column_to_the_last_digit() {
    let (scratch, _) = finished();
    let points = scratch.table("out", "points");
    let ended = scratch.stickslip("summary out --format csv");
    assert_eq!(ended.code, Some(0));
    assert_has(&ended.err, &["short: stickslip ", "all 60 runs finished"]);
    let mut reader = csv::Reader::from_reader(ended.out.as_bytes());
    let names: Vec<String> = reader.headers().unwrap().iter().map(str::to_owned).collect();
    let records: Vec<csv::StringRecord> = reader.records().map(Result::unwrap).collect();
    let text = scratch.well("summary out --format json");
    let document: Value = serde_json::from_str(&text).unwrap();
    let lines: Vec<&str> = text.lines().filter(|line| line.contains("\"point_id\"")).collect();
    let keys = ["study", "seed", "shard", "runs_planned", "runs_finished", "complete"];
    let facts = keys.map(|key| document[key].clone());
    assert_eq!(facts, [json!("short"), 5.into(), "1/1".into(), 60.into(), 60.into(), true.into()]);
    let objects = document["points"].as_array().unwrap();
    assert_eq!((records.len(), objects.len(), lines.len()), (3, 3, 3));

    let schema = points.schema();
    let fields: Vec<&String> = schema.fields().iter().map(|field| field.name()).collect();
    assert_eq!(names.iter().collect::<Vec<_>>(), fields);
    for (index, field) in schema.fields().iter().enumerate() {
        let name = field.name();
        let cells: Vec<Value> = match field.data_type() {
            DataType::Float64 => numbers(&points, name).into_iter().map(|n| json!(n)).collect(),
            DataType::UInt64 => counts(&points, name).into_iter().map(|n| json!(n)).collect(),
            DataType::Boolean => vec![Value::Null; 3],
            _ => words(&points, name).into_iter().map(|text| json!(text)).collect(),
        };
        for ((cell, record), line) in cells.iter().zip(&records).zip(&lines) {
            // Compared as text: this JSON reader may be off in the last digit.
            let written = format!("\"{name}\":{cell}");
            let rest = line.split_once(&written).map(|(_, rest)| rest);
            assert!(rest.is_some_and(|rest| rest.starts_with([',', '}'])), "{written}\n{line}");
            match cell {
                Value::Null => assert_eq!(&record[index], "", "{name}"),
                Value::String(text) => assert_eq!(&record[index], text, "{name}"),
                Value::Number(number) => {
                    assert_eq!(record[index].parse().ok(), number.as_f64(), "{name}");
                }
                _ => panic!("{name}"),
            }
        }
    }
}

#[test]
fn as_many_points_as_are_asked_for() {
    let speeds: Vec<String> = (0..45).map(|n| format!("-{}.0", 160 + n)).collect();
    let sweep = format!("sweep: [{{grid: {{speed_rad_s: [{}]}}}}]\n", speeds.join(", "));
    let scratch = Scratch::with(study(1, AT_ONCE, &sweep));
    let printed = scratch.well("run a.yaml --out out");
    let (_, sentence) = printed.split_once("\n... and 5 more points in points.parquet\n").unwrap();
    assert!(sentence.starts_with("At ") && sentence.contains(" 45 points "), "{sentence}");
    // A remedy and the number of undecided runs follow.
    assert_eq!(sentence.lines().count(), 3);
    assert!(scratch.well("summary out").ends_with(&format!("\n\n{printed}")));
    for (points, lines) in [("all", 45), ("45", 45), ("44", 44), ("1", 1)] {
        for (format, around) in [("table", 7), ("markdown", 10), ("csv", 1)] {
            let text = scratch.well(&format!("summary out --format {format} --points {points}"));
            let others = match 45 - lines {
                1 => "1 more point in".to_owned(),
                others => format!("{others} more points in"),
            };
            let more = text.contains(&format!("... and {others} points.parquet"));
            assert_eq!(more, lines < 45 && format != "csv", "{format}\n{text}");
            let note = match (more, format) {
                (false, _) => 0,
                (true, "table") => 1,
                (true, _) => 2,
            };
            assert_eq!(text.lines().count(), lines + around + note, "{format}\n{text}");
        }
        let document = scratch.well(&format!("summary out --format json --points {points}"));
        let document: Value = serde_json::from_str(&document).unwrap();
        assert_eq!(document["points"].as_array().map(Vec::len), Some(lines));
    }
    assert_eq!(scratch.well("summary out --format csv").lines().count(), 1 + 45);
    for number in ["-1", "0"] {
        let found = format!("found \"{number}\"");
        let wrong = ["--points", &found, "allowed: all, or a whole number from 1"];
        scratch.refused(&format!("summary out --points {number}"), &wrong);
    }
    scratch.refused("summary out --format html", &["--format", "csv", "markdown"]);
}

#[test]
fn interrupted_results_say_what_is_missing() {
    let scratch = Scratch::with(study(20, 0.5, REST));
    let said = ["out of time (--max-seconds) after 0 of 60 runs", "the same command continues"];
    let stopped = scratch.tells("run a.yaml --out out --max-seconds 0 --json", 130, &said).json();
    assert_eq!((&stopped["interrupted"], &stopped["runs_finished"]), (&json!(true), &json!(0)));
    assert_eq!(scratch.table("out", "runs").num_rows(), 0);
    let text = scratch.well("summary out");
    let said = "0 of 60 runs finished, 60 are missing (`stickslip resume out` continues), 0 failed";
    assert_has(&text, &[said]);
    assert_eq!(text.lines().count(), 4, "no point has a run: {text}");
    let document = scratch.json("summary out --format json");
    assert_eq!((&document["complete"], &document["points"]), (&json!(false), &json!([])));
    // A part of a study is labelled as such.
    scratch.stickslip("run a.yaml --out part --shard 2/3 -q");
    scratch.prints("summary part", &["seed 5, shard 2/3, all 20 runs finished"]);
    // A part without any runs.
    scratch.write("b.yaml", study(1, AT_ONCE, ""));
    let titles = ["1/2", "2/2"].map(|shard| {
        scratch.well(&format!("run b.yaml --out {0} --shard {shard}", &shard[..1]));
        let text = scratch.well(&format!("summary {}", &shard[..1]));
        text.lines().next().unwrap().split(", ").nth(3).unwrap().to_owned()
    });
    assert!(titles.contains(&"all 0 runs finished".to_owned()), "{titles:?}");
    assert!(titles.contains(&"all 1 run finished".to_owned()), "{titles:?}");
}

#[test]
fn a_study_whose_runs_have_all_failed() {
    let rest = "uncertain: {ball_mass_kg: {normal: {mean: -1, std_dev: 1.0e-3}}}\n";
    let scratch = Scratch::with(study(2, AT_ONCE, rest));
    let ended = scratch.tells("run a.yaml --out out", 3, &["2 of 2 runs failed"]);
    let said = ["all 2 runs finished, 2 failed (", "invalid_parameters)", "  0/2  "];
    let text = scratch.prints("summary out", &said);
    assert!(text.ends_with(&ended.out));
}

/// Removes the tables and marks them as missing in the manifest, as after a kill.
pub fn kill(scratch: &Scratch) {
    let mut manifest = scratch.manifest("out");
    for name in manifest["files"].as_object().unwrap().keys().filter(|name| *name != "study.yaml") {
        fs::remove_file(scratch.path("out").join(name)).unwrap();
    }
    manifest["complete"] = false.into();
    manifest["files"] = json!({});
    scratch.write("out/manifest.json", manifest.to_string());
}

/// A killed study is summarised from its finished runs, and the directory is not changed.
#[test]
fn a_killed_study_is_summarised() {
    let (scratch, printed) = finished();
    kill(&scratch);
    let before = scratch.files();
    let ended = scratch.stickslip("summary out");
    assert_eq!((ended.code, ended.err.as_str()), (Some(0), ""));
    let said =
        ["60 of 60 runs finished, 0 are missing", "if it is not running, `stickslip resume out`"];
    assert_has(&ended.out, &said);
    assert!(ended.out.ends_with(&printed), "{}", ended.out);
    assert_eq!(scratch.files(), before);
    fs::remove_dir_all(scratch.path("out/chunks")).unwrap();
    scratch.prints("summary out", &["0 of 60 runs finished", "points 0 to 2 are incomplete"]);
    // What the command says is true.
    assert_eq!(scratch.stickslip("resume out").code, Some(3));
    assert!(scratch.well("summary out").ends_with(&printed));
}

/// While another process holds the lock and writes a line of the list, the finished chunks are summarised.
#[test]
fn a_running_study_is_summarised() {
    let sweep = "sweep: [{grid: {speed_rad_s: [-160.0, -200.0, -216.0]}}]\n";
    let scratch = Scratch::ran(study(700, AT_ONCE, sweep));
    kill(&scratch);
    // The list up to the first chunk, and the beginning of another line.
    let list = scratch.chunks("out").join("manifest.jsonl");
    let entries = json_lines(&fs::read_to_string(&list).expect("a list"));
    let kept: Vec<&Value> =
        entries.iter().filter(|entry| entry["last_run"].as_u64().unwrap() < 1024).collect();
    let runs: u64 = kept.iter().map(|entry| entry["runs"].as_u64().unwrap()).sum();
    assert_eq!(runs, 1024);
    let text: String = kept.iter().map(|entry| format!("{entry}\n")).collect();
    fs::write(&list, format!("{text}{{\"chunk\":")).unwrap();
    let lock = Lock::take(scratch.path("out/chunks/lock"), &scratch.path("out")).unwrap();
    let before = scratch.files();
    let ended = scratch.stickslip("summary out");
    assert_eq!((ended.code, ended.err.as_str()), (Some(0), ""));
    let said = ["1024 of 2100 runs finished, 1076 are missing", "points 1 and 2 are incomplete"];
    assert_has(&ended.out, &said);
    let json = scratch.json("summary out --format json");
    assert_eq!((&json["runs_finished"], &json["points_incomplete"]), (&1024.into(), &2.into()));
    let of_points: Vec<&Value> =
        json["points"].as_array().unwrap().iter().map(|point| &point["runs"]).collect();
    assert_eq!(of_points, [&json!(700), &json!(324)]);
    // The directory has no table of points.
    let first = scratch.well("summary out --points 1");
    let more = "... and 1 more point with finished runs; `--points all` prints them";
    assert!(first.contains(more) && !first.contains("parquet"), "{first}");
    scratch.well("report out --out a.html");
    let page = scratch.text("a.html");
    assert!(!page.contains(" threads, in"), "a killed study does not know its threads");
    assert_has(&page, &["1076 of 2100 runs are missing (51.2 %); points 1 and 2 are incomplete"]);
    fs::remove_file(scratch.path("a.html")).unwrap();
    assert_eq!(scratch.files(), before);
    for command in ["run a.yaml --out out", "resume out"] {
        let busy = ["out: another process is writing into this directory", "allowed: wait"];
        assert_eq!(scratch.tells(command, 1, &busy).out, "");
    }
    drop(lock);
}

/// Rewrites a table with other columns, and updates its size and hash in the manifest.
pub fn rewrite(scratch: &Scratch, name: &str, change: impl Fn(RecordBatch) -> RecordBatch) {
    let entry = format!("{name}.parquet");
    let path = scratch.path("out").join(&entry);
    let reader = ParquetRecordBatchReaderBuilder::try_new(File::open(&path).unwrap()).unwrap();
    let pairs = reader.metadata().file_metadata().key_value_metadata().unwrap().clone();
    let kept: Vec<KeyValue> = pairs.into_iter().filter(|pair| pair.key == "stickslip").collect();
    let batch = change(reader.build().unwrap().next().unwrap().unwrap());
    let properties = WriterProperties::builder().set_key_value_metadata(Some(kept)).build();
    let file = File::create(&path).unwrap();
    let mut writer = ArrowWriter::try_new(file, batch.schema(), Some(properties)).unwrap();
    writer.write(&batch).unwrap();
    writer.close().unwrap();
    scratch.list_again("out", &entry);
}

/// Returns a table without one of its columns.
pub fn without(batch: RecordBatch, name: &str) -> RecordBatch {
    let index = batch.schema().index_of(name).unwrap();
    let kept: Vec<usize> = (0..batch.num_columns()).filter(|other| *other != index).collect();
    batch.project(&kept).unwrap()
}

#[test]
fn tables_that_are_not_as_they_should_be_are_refused() {
    let (scratch, printed) = finished();
    rewrite(&scratch, "points", |batch| batch);
    assert!(scratch.well("summary out").ends_with(&printed));
    rewrite(&scratch, "points", |batch| without(batch, "ci_low"));
    let said = ["points.parquet: column ci_low: there is no such column", "columns ", "of numbers"];
    scratch.refused("summary out", &said);
    let bytes = scratch.bytes("out/points.parquet");
    scratch.write("out/points.parquet", &bytes[1..]);
    scratch.refused("summary out", &["points.parquet: this is not the file that was written"]);
    fs::remove_file(scratch.path("out/points.parquet")).unwrap();
    scratch.refused(
        "summary out",
        &["points.parquet: this is not the file", "`stickslip resume out`"],
    );
}
