//! A scratch directory, the program in it, and its tables as record batches.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Display;
use std::fs::{self, DirEntry, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::thread;

use arrow::array::{ArrayRef, AsArray, RecordBatch};
use arrow::compute::concat_batches;
use arrow::datatypes::{DataType, Float64Type, Int32Type, UInt64Type};
use parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder;
use stickslip::classification::MODEL_VERSION;
use stickslip::table::FileEntry;
use tempfile::TempDir;

use crate::support::rows;
pub use crate::support::{assert_has, parse};

/// The data files of an output directory; their bytes depend only on the study.
pub const DATA_FILES: [&str; 7] = [
    "runs.parquet",
    "points.parquet",
    "time_to_rest.parquet",
    "cycles.parquet",
    "equilibria.parquet",
    "equilibrium_histogram.parquet",
    "study.yaml",
];

/// End time of runs whose motion does not matter, s.
pub const AT_ONCE: f64 = 1.0e-5;

/// A directory that is removed at the end of the test.
pub struct Scratch(TempDir);

#[derive(Debug)]
pub struct Ended {
    pub code: Option<i32>,
    pub out: String,
    pub err: String,
}

impl Scratch {
    pub fn new() -> Self {
        Scratch(TempDir::new().unwrap())
    }

    /// Returns a directory with the study `a.yaml`.
    pub fn with(study: impl AsRef<[u8]>) -> Self {
        let scratch = Scratch::new();
        scratch.write("a.yaml", study);
        scratch
    }

    /// Returns a directory with the study `a.yaml` and its results in `out`.
    #[track_caller]
    pub fn ran(study: impl AsRef<[u8]>) -> Self {
        let scratch = Scratch::with(study);
        scratch.well("run a.yaml --out out");
        scratch
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub fn write(&self, name: &str, content: impl AsRef<[u8]>) -> PathBuf {
        let path = self.path(name);
        fs::write(&path, content).unwrap();
        path
    }

    /// Returns the program with these arguments, separated by blanks, in this directory.
    pub fn command(&self, arguments: &str) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_stickslip"));
        command.args(arguments.split_whitespace()).current_dir(self.0.path());
        command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
        command
    }

    /// Runs the program to its end.
    pub fn stickslip(&self, arguments: &str) -> Ended {
        Ended::of(self.command(arguments).output().unwrap())
    }

    /// Runs the program, which must succeed, and returns its standard output.
    #[track_caller]
    pub fn well(&self, arguments: &str) -> String {
        self.ended(arguments, 0).out
    }

    /// Runs the program, which must succeed and print JSON.
    #[track_caller]
    pub fn json(&self, arguments: &str) -> serde_json::Value {
        self.ended(arguments, 0).json()
    }

    /// Runs the program, which must end with this exit code.
    #[track_caller]
    pub fn ended(&self, arguments: &str, code: i32) -> Ended {
        let ended = self.stickslip(arguments);
        assert_eq!(ended.code, Some(code), "{arguments}\n{}{}", ended.out, ended.err);
        ended
    }

    /// Runs the program, which must refuse with exit code 2, print no data, change no file, and
    /// mention all of `parts`.
    #[track_caller]
    pub fn refused(&self, arguments: &str, parts: &[impl AsRef<str>]) {
        let before = self.files();
        let ended = self.stickslip(arguments);
        assert_eq!((ended.code, ended.out.as_str()), (Some(2), ""), "{arguments}\n{}", ended.err);
        for part in parts.iter().map(AsRef::as_ref) {
            assert!(ended.err.contains(part), "{arguments}: no {part:?} in\n{}", ended.err);
        }
        assert_eq!(self.files(), before, "{arguments} has changed files");
    }

    /// Runs the program, with this input, to its end.
    pub fn fed(&self, arguments: &str, input: impl Into<Vec<u8>>) -> Ended {
        let mut child = self.command(arguments).stdin(Stdio::piped()).spawn().expect("it starts");
        let (mut stdin, input) = (child.stdin.take().expect("a pipe"), input.into());
        // Written by another thread, because the pipe may fill before answers are read.
        let writer = thread::spawn(move || stdin.write_all(&input).expect("it reads its input"));
        let ended = Ended::of(child.wait_with_output().expect("it ends"));
        writer.join().expect("all input is written");
        ended
    }

    /// Checks that a command refuses each row of a table of arguments, and mentions the other fields of the row.
    #[track_caller]
    pub fn refuses(&self, command: &str, table: &str) {
        for row in rows(table) {
            self.refused(&format!("{command} {}", row[0]), &row[1..]);
        }
    }

    /// Runs the program, which must end with this exit code and mention all of `parts` on standard error.
    #[track_caller]
    pub fn tells(&self, arguments: &str, code: i32, parts: &[impl Display]) -> Ended {
        let ended = self.ended(arguments, code);
        assert_has(&ended.err, parts);
        ended
    }

    /// Runs the program, which must succeed and print all of `parts`, and returns its standard output.
    #[track_caller]
    pub fn prints(&self, arguments: &str, parts: &[impl Display]) -> String {
        let text = self.well(arguments);
        assert_has(&text, parts);
        text
    }

    #[track_caller]
    pub fn text(&self, name: &str) -> String {
        String::from_utf8(self.bytes(name)).expect("UTF-8")
    }

    #[track_caller]
    pub fn bytes(&self, name: &str) -> Vec<u8> {
        fs::read(self.path(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
    }

    /// Returns every file below this directory with its content.
    pub fn files(&self) -> BTreeMap<PathBuf, Vec<u8>> {
        let mut files = BTreeMap::new();
        let mut folders = vec![self.0.path().to_owned()];
        while let Some(folder) = folders.pop() {
            for entry in fs::read_dir(folder).unwrap() {
                let path = entry.unwrap().path();
                if path.is_dir() {
                    files.insert(path.clone(), Vec::new());
                    folders.push(path);
                } else {
                    let content = fs::read(&path).unwrap();
                    files.insert(path, content);
                }
            }
        }
        files
    }

    /// Returns the names in a directory.
    pub fn names(&self, directory: &str) -> BTreeSet<String> {
        let entries = fs::read_dir(self.path(directory)).expect("a directory");
        let name = |entry: io::Result<DirEntry>| entry.expect("an entry").file_name();
        entries.map(|entry| name(entry).into_string().expect("UTF-8")).collect()
    }

    /// Returns a table of an output directory.
    #[track_caller]
    pub fn table(&self, directory: &str, name: &str) -> RecordBatch {
        table(&self.path(directory).join(format!("{name}.parquet")))
    }

    #[track_caller]
    pub fn manifest(&self, directory: &str) -> serde_json::Value {
        serde_json::from_str(&self.text(&format!("{directory}/manifest.json"))).expect("JSON")
    }

    /// Updates the entry of a file in the manifest to its current content.
    pub fn list_again(&self, directory: &str, name: &str) {
        let entry = FileEntry::of(&self.path(directory).join(name), None).unwrap();
        let mut manifest = self.manifest(directory);
        manifest["files"][name]["bytes"] = entry.bytes.into();
        manifest["files"][name]["sha256"] = entry.sha256.into();
        self.write(&format!("{directory}/manifest.json"), manifest.to_string());
    }

    /// Returns the folder of finished chunks in an output directory, which must be unique.
    #[track_caller]
    pub fn chunks(&self, directory: &str) -> PathBuf {
        let entries = fs::read_dir(self.path(directory).join("chunks")).expect("a folder");
        let paths = entries.map(|entry| entry.expect("an entry").path());
        let folders: Vec<PathBuf> = paths.filter(|path| path.is_dir()).collect();
        let [folder] = &folders[..] else { panic!("one folder: {folders:?}") };
        folder.clone()
    }

    pub fn data(&self, directory: &str) -> Vec<Vec<u8>> {
        DATA_FILES.map(|name| self.bytes(&format!("{directory}/{name}"))).to_vec()
    }
}

impl Ended {
    /// Returns the standard output, which must be JSON.
    #[track_caller]
    pub fn json(&self) -> serde_json::Value {
        serde_json::from_str(&self.out).expect("JSON")
    }

    pub fn of(output: Output) -> Self {
        let text = |bytes| String::from_utf8(bytes).unwrap();
        Ended { code: output.status.code(), out: text(output.stdout), err: text(output.stderr) }
    }
}

/// Parses each line of a text as JSON.
#[track_caller]
pub fn json_lines(text: &str) -> Vec<serde_json::Value> {
    text.lines().map(|line| serde_json::from_str(line).expect("JSON")).collect()
}

/// Returns provenance text of an older version of the model.
pub fn of_older_model(text: &str) -> String {
    let written = format!("\"model_version\":{MODEL_VERSION}");
    assert!(text.contains(&written), "{text}");
    text.replace(&written, "\"model_version\":0")
}

/// Returns the text of a study: a name, a design, an end time, and further lines.
pub fn study_text(name: &str, design: &str, end_time_s: f64, rest: &str) -> String {
    let model = if rest.contains("model:") { "" } else { "model: {kind: ball_balancer}\n" };
    format!(
        "schema: 1\nname: {name}\nseed: 5\n{model}initial_conditions: {{design: {design}}}\n\
         simulation: {{end_time_s: {end_time_s:e}}}\n{rest}"
    )
}

/// Returns a table as one batch, from a Parquet file or a directory of its parts.
#[track_caller]
pub fn table(path: &Path) -> RecordBatch {
    if path.is_dir() {
        let entries = fs::read_dir(path).unwrap().map(|entry| entry.unwrap().path());
        let parts: BTreeSet<PathBuf> = entries.collect();
        let parts: Vec<RecordBatch> = parts.iter().map(|part| table(part)).collect();
        return concat_batches(&parts[0].schema(), &parts).unwrap();
    }
    let file = File::open(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    let reader = ParquetRecordBatchReaderBuilder::try_new(file).unwrap();
    let schema = reader.schema().clone();
    let batches: Vec<RecordBatch> = reader.build().unwrap().map(Result::unwrap).collect();
    concat_batches(&schema, &batches).unwrap()
}

pub fn names(table: &RecordBatch) -> Vec<String> {
    table.schema().fields().iter().map(|field| field.name().clone()).collect()
}

#[track_caller]
pub fn column<'a>(table: &'a RecordBatch, name: &str) -> &'a ArrayRef {
    table.column_by_name(name).unwrap_or_else(|| panic!("no column {name}"))
}

#[track_caller]
pub fn numbers(table: &RecordBatch, name: &str) -> Vec<Option<f64>> {
    column(table, name).as_primitive::<Float64Type>().iter().collect()
}

/// Returns a column of counts without missing values.
#[track_caller]
pub fn counts(table: &RecordBatch, name: &str) -> Vec<u64> {
    column(table, name).as_primitive::<UInt64Type>().values().to_vec()
}

/// Returns a column of text, plain or dictionary-encoded.
#[track_caller]
pub fn words(table: &RecordBatch, name: &str) -> Vec<Option<String>> {
    let column = column(table, name);
    let strings = match column.data_type() {
        DataType::Utf8 => column.as_string::<i32>().iter().map(|text| text.map(str::to_owned)),
        _ => {
            let words = column.as_dictionary::<Int32Type>();
            let words = words.downcast_dict::<arrow::array::StringArray>().unwrap();
            return words.into_iter().map(|text| text.map(str::to_owned)).collect();
        }
    };
    strings.collect()
}

/// Returns one row of a table as text, without the named columns.
pub fn row(table: &RecordBatch, index: usize, without: &[&str]) -> Vec<(String, String)> {
    let options = arrow::util::display::FormatOptions::default().with_null("null");
    let fields = table.schema();
    fields
        .fields()
        .iter()
        .zip(table.columns())
        .filter(|(field, _)| !without.contains(&field.name().as_str()))
        .map(|(field, column)| {
            let cells =
                arrow::util::display::ArrayFormatter::try_new(column.as_ref(), &options).unwrap();
            (field.name().clone(), cells.value(index).to_string())
        })
        .collect()
}
