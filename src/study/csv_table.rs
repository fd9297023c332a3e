//! Tables in CSV files: one header line, commas, comments after `#`.

use std::path::Path;

use super::error::{Fault, StudyError, shorten};
use super::file_values::Entry;
use super::read_file::to_text;
use super::rows::{
    MAX_VALUES, Rows, TableFile, check_number, empty_value, ragged, too_many_values,
};

/// Reads the table out of a file's bytes; `allowed` are the names that columns may have.
///
/// # Errors
/// Bytes that are no text, a file without a header, a column that is unknown or given twice, a ragged
/// row, a value that is missing or not finite, too many of them.
pub(crate) fn read(path: &Path, bytes: Vec<u8>, allowed: &[String]) -> Result<Rows, StudyError> {
    let mut file = TableFile::of_lines(path);
    let text = to_text(bytes).map_err(|fault| file.refuse_all(fault))?;
    let text = text.strip_prefix('\u{feff}').unwrap_or(&text);
    let mut reader = csv::ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .trim(csv::Trim::All)
        .comment(Some(b'#'))
        .from_reader(text.as_bytes());
    let mut columns: Vec<String> = Vec::new();
    let mut rows: Vec<Vec<Entry>> = Vec::new();
    for record in reader.records() {
        let record = record.map_err(|error| {
            file.refuse_all(Fault::new("not a table", shorten(&error.to_string()), "CSV"))
        })?;
        if columns.is_empty() {
            columns = record.iter().map(str::to_owned).collect();
            file.check_columns(&columns, allowed)?;
            continue;
        }
        let row = rows.len();
        file.begin_row(line_of(text, record.position()));
        if record.len() != columns.len() {
            return Err(file.refuse(Some(row), None, ragged(record.len(), columns.len())));
        }
        if (row + 1) * columns.len() > MAX_VALUES {
            let fault = too_many_values(format!("{} values and more", row * columns.len()));
            return Err(file.refuse(Some(row), None, fault));
        }
        let values = record.iter().zip(&columns).map(|(value, column)| {
            entry(value).map_err(|fault| file.refuse(Some(row), Some(column), fault))
        });
        rows.push(values.collect::<Result<Vec<Entry>, StudyError>>()?);
    }
    if columns.is_empty() {
        let fault = Fault::new("the table is empty", "no header", "a line of column names");
        return Err(file.refuse_all(fault));
    }
    Ok(Rows::in_file(columns, rows, file))
}

/// The line, counted from one, where a record starts: the reader's position is before the empty
/// lines and comments that it skipped.
fn line_of(text: &str, position: Option<&csv::Position>) -> usize {
    let Some(position) = position else { return 1 };
    let byte = usize::try_from(position.byte()).unwrap_or(0);
    let skipped = text
        .get(byte..)
        .unwrap_or_default()
        .lines()
        .take_while(|line| line.is_empty() || line.starts_with('#'))
        .count();
    usize::try_from(position.line()).unwrap_or(1) + skipped
}

fn entry(text: &str) -> Result<Entry, Fault> {
    match text.parse::<f64>() {
        Ok(number) => check_number(number, || shorten(text)),
        Err(_) if text.is_empty() => Err(empty_value()),
        Err(_) => Ok(Entry::Text(text.to_owned())),
    }
}
