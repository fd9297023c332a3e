//! Foreign text is escaped on the terminal: escape sequences, bidirectional marks, megabytes, and
//! arguments in suggested commands.

use std::fs;
use std::sync::Arc;

use arrow::array::{ArrayRef, RecordBatch, StringArray};
use arrow::datatypes::{Field, Schema};
use serde_json::json;

use super::evaluate::{BALLS, BLOCK};
use super::summary::{finished, kill, rewrite};
use super::support::{AT_ONCE, Scratch, assert_has, json_lines, study_text};

/// Sets the title, clears the screen, hides text, reverses its direction, and imitates another
/// message.
const EVIL: &str = "a\u{1b}]0;title\u{7}\u{1b}[2J\u{9b}8m\u{202e}\r\u{7f}\u{0}\nerror: all is lost";

fn is_acted_on(c: char) -> bool {
    (c.is_control() && c != '\n') || matches!(c, '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

/// Asserts that a text contains no control sequence and no foreign line.
#[track_caller]
fn assert_harmless(text: &str, what: &str) {
    assert!(!text.chars().any(is_acted_on), "{what}: {text:?}");
    assert!(!text.lines().any(|line| line.starts_with("error: all is lost")), "{what}: {text}");
}

/// Asserts that a command is refused without foreign text, in a few lines.
#[track_caller]
fn assert_refused(scratch: &Scratch, command: &str) -> String {
    let ended = scratch.stickslip(command);
    assert_eq!((ended.code, ended.out.as_str()), (Some(2), ""), "{command}: {}", ended.err);
    assert_harmless(&ended.err, command);
    assert!(ended.err.len() < 4000, "{command}: {} bytes", ended.err.len());
    ended.err
}

fn evil() -> String {
    format!("{EVIL}{}", "x".repeat(100_000))
}

#[test]
fn texts_of_a_manifest() {
    let scratch = Scratch::with(study_text("a", "{monte_carlo: {samples: 3}}", AT_ONCE, ""));
    scratch.write("b.yaml", study_text("b", "{monte_carlo: {samples: 4}}", AT_ONCE, "seed: 9\n"));
    scratch.well("run a.yaml --out out -q");
    let right = scratch.manifest("out");
    for key in ["study", "study_hash", "version", "commit", "host", "shard"] {
        for (text, model_version) in [(evil(), 1), (evil(), 0), (EVIL.to_owned(), 1)] {
            let mut manifest = right.clone();
            manifest[key] = text.into();
            if model_version == 0 {
                manifest["model_version"] = 0.into();
            }
            scratch.write("out/manifest.json", manifest.to_string());
            for command in [
                "summary out",
                "report out",
                "replay out 0",
                "resume out",
                "run a.yaml --out out",
                "run b.yaml --out out",
                "merge out --out whole",
            ] {
                assert_refused(&scratch, command);
            }
        }
    }
    // Names of files and labels, and an invalid manifest.
    for manifest in [
        right
            .to_string()
            .replace("time_to_rest.parquet", &json!(EVIL).to_string().replace('"', "")),
        right.to_string().replace("undecided", &json!(EVIL).to_string().replace('"', "")),
        json!({"format": evil()}).to_string(),
        json!(evil()).to_string(),
    ] {
        assert_ne!(manifest, right.to_string());
        scratch.write("out/manifest.json", manifest);
        assert_refused(&scratch, "summary out");
        assert_refused(&scratch, "resume out");
    }
}

/// In every suggested command, a shard is two numbers and a directory is one word.
#[test]
fn commands_to_paste() {
    let text = study_text("a", "{monte_carlo: {samples: 3}}", AT_ONCE, "");
    let scratch = Scratch::with(&text);
    scratch.well("run a.yaml --shard 1/2 --out out -q");
    let edited = text.replace("seed: 5", "seed: 6");
    scratch.write("out/study.yaml", edited);
    let right = scratch.manifest("out");
    assert_has(&assert_refused(&scratch, "summary out"), &["--out out --shard 1/2`"]);
    for shard in ["1/2; touch pwned", "$(touch pwned)", "3/2", "0/1", "1/2 ", "01/2", ""] {
        let mut manifest = right.clone();
        manifest["shard"] = shard.into();
        scratch.write("out/manifest.json", manifest.to_string());
        let said = assert_refused(&scratch, "summary out");
        assert!(!said.contains("--shard") && said.contains("allowed: K/N"), "{said}");
    }
    scratch.write("out/manifest.json", right.to_string());
    fs::rename(scratch.path("out"), scratch.path("$(touch_pwned);'x'")).unwrap();
    let said = assert_refused(&scratch, "summary $(touch_pwned);'x'");
    let word = r"'$(touch_pwned);'\''x'\'''";
    assert_has(&said, &[format!("--out {word} --shard 1/2`")]);
    let (scratch, _) = finished();
    kill(&scratch);
    fs::rename(scratch.path("out"), scratch.path("a;b")).unwrap();
    scratch.prints("summary a;b", &["`stickslip resume 'a;b'`"]);
}

/// Returns a column of texts.
pub fn texts(values: usize, text: &str) -> ArrayRef {
    Arc::new(StringArray::from(vec![text; values]))
}

/// Returns the batch with a column replaced or added.
pub fn with(batch: &RecordBatch, name: &str, column: ArrayRef) -> RecordBatch {
    let schema = batch.schema();
    let mut fields: Vec<Arc<Field>> = schema.fields().iter().cloned().collect();
    let mut columns = batch.columns().to_vec();
    let field = Arc::new(Field::new(name, column.data_type().clone(), true));
    match schema.index_of(name) {
        Ok(index) => (fields[index], columns[index]) = (field, column),
        Err(_) => {
            fields.push(field);
            columns.push(column);
        }
    }
    RecordBatch::try_new(Arc::new(Schema::new(fields)), columns).unwrap()
}

#[test]
fn names_of_columns_and_texts_in_tables() {
    let (scratch, _) = finished();
    rewrite(&scratch, "points", |batch| {
        let batch = with(&batch, "ci_method", texts(batch.num_rows(), EVIL));
        with(&batch, EVIL, texts(batch.num_rows(), EVIL))
    });
    // Longer than messages and pages show, but allowed in a table.
    let long = format!("{EVIL}{}", "x".repeat(10_000));
    rewrite(&scratch, "runs", |batch| with(&batch, "error", texts(batch.num_rows(), &long)));
    for format in ["table", "markdown", "csv", "json"] {
        let ended = scratch.ended(&format!("summary out --format {format}"), 0);
        assert!(!ended.out.chars().any(is_acted_on), "{format}: {:?}", ended.out);
        assert_harmless(&ended.err, format);
        if format == "json" {
            // The escaped text has the same meaning.
            let document = ended.json();
            assert_eq!(document["points"][0]["ci_method"], EVIL);
        }
    }
    let replayed = scratch.tells("replay out 0", 1, &["NOT equal to its row"]);
    assert_harmless(&replayed.err, "replay");
    assert!(replayed.err.len() < 4000, "{} bytes", replayed.err.len());
    scratch.well("report out");
    let page = scratch.text("out-report.html");
    assert!(!page.contains(['\u{1b}', '\u{9b}', '\u{202e}', '\0']), "the page");
    assert!(!page.contains(&"x".repeat(1000)), "the page has all of a foreign text");
}

#[cfg(unix)]
#[test]
fn names_of_files() {
    let scratch = Scratch::with(study_text("a", "{monte_carlo: {samples: 3}}", AT_ONCE, ""));
    let search = "optimize: {minimize: stop, designs: 12}\n";
    scratch.write("block.yaml", format!("{BLOCK}{search}"));
    scratch.well("run a.yaml --out out -q");
    let name = EVIL.replace('\0', "");
    fs::create_dir(scratch.path("full")).unwrap();
    scratch.write(&format!("full/{name}"), "x");
    for command in [
        "run a.yaml --out full",
        "optimize block.yaml --out full",
        "equilibria a.yaml --out full",
        "replay out 0 --out full",
    ] {
        assert_refused(&scratch, command);
    }
    // A folder beside those of finished runs.
    fs::create_dir(scratch.path("out/chunks").join(&name)).unwrap();
    scratch.write(&format!("out/chunks/{name}/manifest.jsonl"), "damaged\n");
    scratch.write("b.yaml", study_text("a", "{monte_carlo: {samples: 4}}", AT_ONCE, ""));
    let ended = scratch.stickslip("run b.yaml --out out");
    assert_has(&ended.err, &["line 1 is damaged"]);
    assert_harmless(&ended.err, "run");
}

#[test]
fn studies_and_their_tables() {
    let scratch = Scratch::new();
    let text = study_text("a", "{monte_carlo: {samples: 3}}", AT_ONCE, "");
    let quoted = json!(EVIL).to_string();
    let long = json!(evil()).to_string();
    for wrong in [
        text.replace("name: a", &format!("name: {quoted}")),
        text.replace("name: a", &format!("name: {long}")),
        format!("{text}{quoted}: 1\n"),
        text.replace("kind: ball_balancer", &format!("kind: {quoted}")),
        text.replace(
            "kind: ball_balancer",
            &format!("kind: ball_balancer, parameters: {{{long}: 1}}"),
        ),
        format!("{text}sweep: [{{zip: {{speed_rad_s: {quoted}}}}}]\n"),
        format!("{text}sweep: [{{table: {quoted}}}]\n"),
        format!("{text}# \u{1b}[2J\n]\n"),
    ] {
        scratch.write("wrong.yaml", wrong);
        assert_refused(&scratch, "check wrong.yaml");
    }
    scratch.write("block.yaml", BLOCK);
    let cell = format!("\"{}\"", EVIL.replace('\0', ""));
    for table in [format!("stiffness_n_m\n{cell}\n"), format!("{cell}\n20\n")] {
        scratch.write("designs.csv", table);
        assert_refused(&scratch, "evaluate block.yaml --designs designs.csv --out r.parquet");
    }
}

#[test]
fn requests() {
    let scratch = Scratch::new();
    scratch.write("balls.yaml", BALLS);
    let requests = [
        json!({"id": EVIL, "speed_rad_s": -200, "balls": 1, "material": "steel"}),
        json!({"id": EVIL, "speed_rad_s": -200, "balls": 1, "material": EVIL}),
        json!({"id": EVIL, EVIL: 1}),
    ];
    let input = requests.map(|request| format!("{request}\n")).concat();
    let ended = scratch.fed("evaluate balls.yaml --designs -", input);
    assert_harmless(&ended.err, "requests");
    assert!(!ended.out.chars().any(is_acted_on), "{:?}", ended.out);
    let answers = json_lines(&ended.out);
    assert_eq!(answers.len(), 3);
    // An identifier is returned unchanged.
    assert!(answers.iter().all(|answer| answer["id"] == EVIL));
    assert_eq!(answers[0].get("error"), None, "{}", answers[0]);
}

/// The files of a search, and the provenance in tables.
#[test]
fn lists_of_files_and_provenance() {
    let scratch = Scratch::new();
    let search = "optimize: {minimize: stop, designs: 12}\n";
    scratch.write("block.yaml", format!("{BLOCK}{search}"));
    scratch.well("optimize block.yaml --out search -q");
    let right = scratch.text("search/files.json");
    for wrong in [
        right.replace("finalists.parquet", &json!(EVIL).to_string().replace('"', "")),
        json!(evil()).to_string(),
        json!({"format": evil()}).to_string(),
    ] {
        scratch.write("search/files.json", wrong);
        assert_refused(&scratch, "optimize block.yaml --out search");
    }
    let (scratch, _) = finished();
    let path = scratch.path("out/points.parquet");
    // Metadata of the same length, so that the file remains readable.
    let bytes = fs::read(&path).unwrap();
    let hash = scratch.manifest("out")["study_hash"].as_str().unwrap().to_owned();
    let mut other = bytes.clone();
    for place in 0..bytes.len() - hash.len() {
        if bytes[place..].starts_with(hash.as_bytes()) {
            other[place..place + 12].copy_from_slice(b"\\u001b]0;aab");
        }
    }
    assert_ne!(other, bytes);
    fs::write(&path, &other).unwrap();
    scratch.list_again("out", "points.parquet");
    assert_has(&assert_refused(&scratch, "summary out"), &["points.parquet: this is not a table"]);
}
