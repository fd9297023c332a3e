//! How a command ends and prints: exit codes, standard output, which holds data only and whose reader may stop reading, messages
//! on standard error, CSV, and facts in words and as JSON.

use std::io::{self, Write};

use serde_json::Value;

pub use crate::engine::CommandError as CliError;
use crate::engine::StoreError;
use crate::sanitize::{harmless, harmless_json};
use crate::table::ResultsError;
use crate::table::column::{Column, batch, cell_text};

/// The end of a command that did its work.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// Success.
    Well,
    /// Finished, but some runs failed.
    RunsFailed,
    /// Stopped because more runs failed than `--on-failure` allows.
    TooManyFailed,
    /// `check --strict` has warned.
    Warned,
    /// An expectation of the study is not met.
    ExpectationNotMet,
    /// A replayed run differs from its row.
    NotReproduced,
    /// Interrupted; all finished runs are on disk.
    Interrupted,
}

impl End {
    /// Returns the exit code.
    pub fn code(self) -> u8 {
        match self {
            End::Well => 0,
            End::TooManyFailed => 1,
            End::NotReproduced => 1,
            End::Warned => 2,
            End::RunsFailed => 3,
            End::ExpectationNotMet => 4,
            End::Interrupted => 130,
        }
    }
}

impl CliError {
    /// Returns the exit code: 2 if the user can fix the cause in the study or on the command line, otherwise 1.
    pub fn code(&self) -> u8 {
        match self {
            CliError::Study(_) | CliError::Usage(_) | CliError::Table(_) => 2,
            CliError::Results(ResultsError::Occupied { .. } | ResultsError::Unusable { .. }) => 2,
            CliError::Store(StoreError::Unusable(_)) => 2,
            CliError::Results(ResultsError::Write(_))
            | CliError::Store(
                StoreError::Unwritten { .. } | StoreError::Busy { .. } | StoreError::Lost { .. },
            )
            | CliError::Write(_)
            | CliError::Threads(_)
            | CliError::Output(_) => 1,
        }
    }
}

/// Whether standard output still has a reader.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OutputReader {
    /// The reader took the text.
    Reading,
    /// The reader has closed its end, as `| head` does; further output is pointless.
    Gone,
}

/// Writes text to standard output, without terminal control characters.
pub fn print(text: &str) -> io::Result<OutputReader> {
    write(&harmless(text))
}

/// Writes JSON to standard output, with terminal control characters escaped.
pub fn print_json(json: &str) -> io::Result<OutputReader> {
    write(&harmless_json(json))
}

/// Prints the result of a command: as indented JSON if that is asked for, and otherwise as text.
pub fn print_result(
    as_json: bool,
    json: impl FnOnce() -> Value,
    text: impl FnOnce() -> String,
) -> io::Result<OutputReader> {
    if as_json { print_json(&format!("{:#}\n", json())) } else { print(&text()) }
}

/// Writes a message to standard error, without terminal control characters. Ignores write errors, such as from a
/// closed terminal, so that the computation continues; `eprintln` would panic.
pub fn print_message(message: &str) {
    let line = harmless(message).replace('\t', " ") + "\n";
    // A single write keeps the lines of several threads apart.
    let _ = io::stderr().lock().write_all(line.as_bytes());
}

fn write(text: &str) -> io::Result<OutputReader> {
    let mut out = io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(OutputReader::Gone),
        result => result.map(|()| OutputReader::Reading),
    }
}

/// Returns cells as one line of CSV.
pub fn csv_line(cells: impl IntoIterator<Item = String>) -> io::Result<String> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(cells)?;
    let bytes = writer.into_inner().map_err(|error| io::Error::other(error.to_string()))?;
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}

/// Returns the names of columns as one line of CSV.
pub fn csv_header<R>(columns: &[Column<R>]) -> io::Result<String> {
    csv_line(columns.iter().map(|column| column.name().to_owned()))
}

/// Returns rows as lines of CSV, with every bit of a number; a missing value is an empty cell.
pub fn csv_rows<R>(columns: &[Column<R>], rows: &[R]) -> io::Result<String> {
    let batch = batch(columns, rows).map_err(io::Error::other)?;
    let line = |row| csv_line(batch.columns().iter().map(|column| cell_text(column, row, "")));
    (0..rows.len()).map(line).collect()
}

/// Facts of a study for people, each with a name and words, and the same facts as JSON.
pub(super) struct StudyFacts {
    pub(super) words: Vec<(&'static str, String)>,
    pub(super) json: Value,
}
