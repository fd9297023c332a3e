//! Standard output, which holds data only and whose reader may stop reading, messages on standard error, and new tables.

use std::io::{self, Write};
use std::path::Path;

use super::exit::CliError;
use crate::sanitize::{harmless, harmless_json};
use crate::table::TableWriter;
use crate::table::column::Column;

/// Whether standard output still has a reader.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reader {
    /// The reader took the text.
    Reading,
    /// The reader has closed its end, as `| head` does; further output is pointless.
    Gone,
}

/// Writes text to standard output, without terminal control characters.
///
/// # Errors
/// Returns an error if standard output cannot be written to, except when its reader has gone.
pub fn print(text: &str) -> io::Result<Reader> {
    write(&harmless(text))
}

/// Writes JSON to standard output, with terminal control characters escaped.
///
/// # Errors
/// Returns an error if standard output cannot be written to, except when its reader has gone.
pub fn print_json(json: &str) -> io::Result<Reader> {
    write(&harmless_json(json))
}

/// Writes a message to standard error, without terminal control characters. Ignores write errors, such as from a
/// closed terminal, so that the computation continues; `eprintln` would panic.
pub fn print_message(message: &str) {
    let line = harmless(message).replace('\t', " ") + "\n";
    // A single write keeps the lines of several threads apart.
    let _ = io::stderr().lock().write_all(line.as_bytes());
}

fn write(text: &str) -> io::Result<Reader> {
    let mut out = io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(Reader::Gone),
        result => result.map(|()| Reader::Reading),
    }
}

/// Endings of names whose files are expected to have another format than Parquet.
const OTHER_FORMATS: [&str; 5] = ["csv", "tsv", "json", "xlsx", "xls"];

/// Starts a table in a new Parquet file, which the user has named.
///
/// # Errors
/// Returns an error if the name is one of another format, or if the file exists or cannot be created.
pub fn new_table<R>(
    path: &Path,
    columns: Vec<Column<R>>,
    provenance: &str,
) -> Result<TableWriter<R>, CliError> {
    let refused =
        |problem: String, allowed| CliError::Usage(format!("{problem}\n  allowed: {allowed}"));
    if path.exists() {
        let problem = format!("{}: exists already", path.display());
        return Err(refused(problem, "the name of a new file"));
    }
    let ending = path.extension().and_then(|ending| ending.to_str()).unwrap_or_default();
    if OTHER_FORMATS.iter().any(|other| ending.eq_ignore_ascii_case(other)) {
        let problem = format!("{}: the file is written as Parquet", path.display());
        let found = format!("a name that ends in .{ending}");
        let allowed = format!(
            "a name that ends in .parquet, such as {}",
            path.with_extension("parquet").display()
        );
        return Err(CliError::refusal(problem, found, allowed));
    }
    let allowed = "the name of a new file in a directory that can be written to";
    TableWriter::create(path, columns, provenance)
        .map_err(|error| refused(error.to_string(), allowed))
}

/// Returns cells as one line of CSV.
///
/// # Errors
/// Returns an error if the cells cannot be written.
pub fn csv_line(cells: impl IntoIterator<Item = String>) -> io::Result<String> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(cells)?;
    let bytes = writer.into_inner().map_err(|error| io::Error::other(error.to_string()))?;
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}
