//! Tables that a study names or holds: header and rows, with the place of every value.

use std::collections::HashSet;
use std::fs;
use std::path::{Path, PathBuf};

use super::error::{Fault, Locate, Place, StudyError, list_names, shorten};
use super::file_values::{Entry, InlineTable, Table};
use super::key_path::KeyPath;
use super::node::MAX_FILE_BYTES;

/// A table with columns whose names are known to be allowed, each once.
pub(crate) struct Rows {
    /// Names of the columns.
    pub columns: Vec<String>,
    /// Rows with one value per column.
    pub rows: Vec<Vec<Entry>>,
    origin: Origin,
}

enum Origin {
    Inline(KeyPath),
    /// The file, and for each row its line in it.
    File(PathBuf, Vec<usize>),
}

impl Rows {
    /// Reads a table; `allowed` are the names that columns may have.
    ///
    /// # Errors
    /// A file that cannot be read, a ragged row, a column that is unknown or given twice, a value
    /// that is missing or not finite, a table without rows.
    pub fn read(
        locate: &dyn Locate,
        study_file: &Path,
        path: &KeyPath,
        table: &Table,
        allowed: &[String],
    ) -> Result<Rows, StudyError> {
        let rows = match table {
            Table::Inline(inline) => Rows::of_inline(locate, path, inline)?,
            Table::File(name) => {
                let folder = study_file.parent().unwrap_or(Path::new(""));
                Rows::of_file(locate, path, name, &folder.join(name))?
            }
        };
        rows.check_columns(locate, allowed)?;
        if rows.rows.is_empty() {
            let fault = Fault::new("a table without rows", "0 rows", "at least one row");
            return Err(rows.refuse(locate, None, None, fault));
        }
        Ok(rows)
    }

    fn of_inline(
        locate: &dyn Locate,
        path: &KeyPath,
        table: &InlineTable,
    ) -> Result<Rows, StudyError> {
        for (row, values) in table.rows.iter().enumerate() {
            if values.len() != table.columns.len() {
                let fault = ragged(values.len(), table.columns.len());
                return Err(locate.refuse_value(&path.key("rows").item(row), fault));
            }
        }
        Ok(Rows {
            columns: table.columns.clone(),
            rows: table.rows.clone(),
            origin: Origin::Inline(path.clone()),
        })
    }

    fn of_file(
        locate: &dyn Locate,
        path: &KeyPath,
        name: &str,
        file: &Path,
    ) -> Result<Rows, StudyError> {
        let text = read_text(file).map_err(|mut fault| {
            fault.problem = format!("the table cannot be read: {}", fault.problem);
            fault.found = Some(shorten(name));
            locate.refuse_value(path, fault)
        })?;
        let text = text.strip_prefix('\u{feff}').unwrap_or(&text);
        let mut reader = csv::ReaderBuilder::new()
            .has_headers(false)
            .flexible(true)
            .trim(csv::Trim::All)
            .comment(Some(b'#'))
            .from_reader(text.as_bytes());
        let mut columns: Vec<String> = Vec::new();
        let mut rows = Vec::new();
        let mut lines = Vec::new();
        for record in reader.records() {
            let record = record.map_err(|error| {
                let fault = Fault::new("not a table", shorten(&error.to_string()), "CSV");
                StudyError::about_file(file, fault)
            })?;
            let line = line_of(text, record.position());
            if columns.is_empty() {
                columns = record.iter().map(str::to_owned).collect();
                continue;
            }
            let row = rows.len();
            if record.len() != columns.len() {
                let fault = ragged(record.len(), columns.len());
                return Err(in_file(file, line, format!("row {}", row + 1), fault));
            }
            let values = record.iter().zip(&columns).map(|(value, column)| {
                entry(value).map_err(|fault| in_file(file, line, cell_name(row, column), fault))
            });
            rows.push(values.collect::<Result<Vec<Entry>, StudyError>>()?);
            lines.push(line);
        }
        if columns.is_empty() {
            let fault = Fault::new("the table is empty", "no header", "a line of column names");
            return Err(StudyError::about_file(file, fault));
        }
        Ok(Rows { columns, rows, origin: Origin::File(file.to_path_buf(), lines) })
    }

    fn check_columns(&self, locate: &dyn Locate, allowed: &[String]) -> Result<(), StudyError> {
        let mut seen = HashSet::new();
        for (index, column) in self.columns.iter().enumerate() {
            if !allowed.contains(column) {
                let fault =
                    Fault::new("unknown column", shorten(column), list_names(column, allowed));
                return Err(self.refuse(locate, None, Some(index), fault));
            }
            if !seen.insert(column) {
                let fault = Fault::new("a column given twice", column, "each column once");
                return Err(self.refuse(locate, None, Some(index), fault));
            }
        }
        Ok(())
    }

    /// The message for a fault in a row, a column, both, or the whole table.
    pub fn refuse(
        &self,
        locate: &dyn Locate,
        row: Option<usize>,
        column: Option<usize>,
        fault: Fault,
    ) -> StudyError {
        match &self.origin {
            Origin::Inline(path) => {
                let path = match (row, column) {
                    (Some(row), Some(column)) => path.key("rows").item(row).item(column),
                    (Some(row), None) => path.key("rows").item(row),
                    (None, Some(column)) => path.key("columns").item(column),
                    (None, None) => path.clone(),
                };
                locate.refuse_value(&path, fault)
            }
            Origin::File(file, lines) => {
                let name = column.and_then(|column| self.columns.get(column));
                let key = match (row, name) {
                    (Some(row), Some(name)) => cell_name(row, name),
                    (Some(row), None) => format!("row {}", row + 1),
                    (None, Some(name)) => format!("column {}", shorten(name)),
                    (None, None) => String::new(),
                };
                let line = row.and_then(|row| lines.get(row)).copied().unwrap_or(1);
                in_file(file, line, key, fault)
            }
        }
    }
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

fn cell_name(row: usize, column: &str) -> String {
    format!("row {}, column {}", row + 1, shorten(column))
}

fn in_file(file: &Path, line: usize, key: String, fault: Fault) -> StudyError {
    StudyError::new(file, Some(Place { line, column: 1 }), key, fault, None)
}

fn ragged(found: usize, columns: usize) -> Fault {
    Fault::new("a ragged row", format!("{found} values"), format!("{columns}, one per column"))
}

fn entry(text: &str) -> Result<Entry, Fault> {
    match text.parse::<f64>() {
        Ok(number) if number.is_finite() => Ok(Entry::Number(number)),
        Ok(_) => Err(Fault::new("not a finite number", shorten(text), "a finite number")),
        Err(_) if text.is_empty() => Err(Fault::new("an empty value", "nothing", "a number")),
        Err(_) => Ok(Entry::Text(text.to_owned())),
    }
}

/// Reads a text file of bounded size.
///
/// # Errors
/// What is wrong with the file: absent, a folder, too large, not UTF-8.
pub(crate) fn read_text(file: &Path) -> Result<String, Fault> {
    let unreadable = |error: std::io::Error| Fault {
        problem: error.to_string(),
        found: None,
        allowed: Some("a file that can be read".to_owned()),
    };
    let metadata = fs::metadata(file).map_err(unreadable)?;
    if !metadata.is_file() {
        let what = if metadata.is_dir() { "a directory" } else { "not a regular file" };
        return Err(Fault::new(format!("this is {what}"), what, "a text file"));
    }
    if metadata.len() > MAX_FILE_BYTES {
        let found = format!("{} bytes", metadata.len());
        let allowed = format!("at most {MAX_FILE_BYTES} bytes");
        return Err(Fault::new("the file is too large", found, allowed));
    }
    let bytes = fs::read(file).map_err(unreadable)?;
    String::from_utf8(bytes).map_err(|error| {
        let found = format!("a wrong byte at position {}", error.utf8_error().valid_up_to());
        Fault::new("the text is not UTF-8", found, "UTF-8")
    })
}
