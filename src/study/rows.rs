//! Tables that a study names or holds: columns and rows, with the place of every value.

use std::collections::HashSet;
use std::path::{Path, PathBuf};

use super::csv_table;
use super::error::{Fault, Locate, Place, StudyError, list_names, shorten};
use super::file_values::{Entry, InlineTable, Table};
use super::key_path::KeyPath;
use super::parquet_table;
use super::table_folders::TableFolders;

/// The most values that all sweeps and tables of a study may hold together.
pub(crate) const MAX_VALUES: usize = 1_000_000;

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
    File(TableFile),
}

/// The file that a table was read from.
pub(crate) struct TableFile {
    path: PathBuf,
    /// In a file of lines, the line of each row.
    lines: Option<Vec<usize>>,
}

impl Rows {
    /// Reads a table; `allowed` are the names that columns may have.
    ///
    /// # Errors
    /// A file that cannot or must not be read, a ragged row, a column that is unknown or given twice,
    /// a value that is missing or not finite, a table without rows.
    pub fn read(
        locate: &dyn Locate,
        folders: &TableFolders,
        path: &KeyPath,
        table: &Table,
        allowed: &[String],
    ) -> Result<Rows, StudyError> {
        let rows = match table {
            Table::Inline(inline) => Rows::of_inline(locate, path, inline, allowed)?,
            Table::File(name) => Rows::of_file(locate, folders, path, name, allowed)?,
        };
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
        allowed: &[String],
    ) -> Result<Rows, StudyError> {
        for (row, values) in table.rows.iter().enumerate() {
            if values.len() != table.columns.len() {
                let fault = ragged(values.len(), table.columns.len());
                return Err(locate.refuse_value(&path.key("rows").item(row), fault));
            }
        }
        check_columns(&table.columns, allowed).map_err(|(column, fault)| {
            locate.refuse_value(&path.key("columns").item(column), fault)
        })?;
        Ok(Rows {
            columns: table.columns.clone(),
            rows: table.rows.clone(),
            origin: Origin::Inline(path.clone()),
        })
    }

    fn of_file(
        locate: &dyn Locate,
        folders: &TableFolders,
        path: &KeyPath,
        name: &str,
        allowed: &[String],
    ) -> Result<Rows, StudyError> {
        let (file, bytes) = folders.read(name).map_err(|mut fault| {
            fault.problem = format!("the table cannot be read: {}", fault.problem);
            locate.refuse_value(path, fault)
        })?;
        let extension = file.extension().and_then(|extension| extension.to_str());
        let rows = match extension.map(str::to_ascii_lowercase).as_deref() {
            Some("csv") => csv_table::read(&file, bytes, allowed),
            Some("parquet") => parquet_table::read(&file, bytes, allowed),
            _ => {
                let fault = Fault::new(
                    "neither a CSV nor a Parquet file by its name",
                    shorten(name),
                    "a name that ends in .csv or .parquet",
                );
                Err(locate.refuse_value(path, fault))
            }
        }?;
        folders
            .count(rows.rows.len() * rows.columns.len())
            .map_err(|fault| locate.refuse_value(path, fault))?;
        Ok(rows)
    }

    /// A table that a file holds.
    pub fn in_file(columns: Vec<String>, rows: Vec<Vec<Entry>>, file: TableFile) -> Rows {
        Rows { columns, rows, origin: Origin::File(file) }
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
            Origin::File(file) => {
                let name = column.and_then(|column| self.columns.get(column));
                file.refuse(row, name.map(String::as_str), fault)
            }
        }
    }
}

impl TableFile {
    /// A file of lines.
    pub fn of_lines(path: &Path) -> TableFile {
        TableFile { path: path.to_path_buf(), lines: Some(Vec::new()) }
    }

    /// A file without lines, in which rows have numbers only.
    pub fn without_lines(path: &Path) -> TableFile {
        TableFile { path: path.to_path_buf(), lines: None }
    }

    /// Notes the line of the next row.
    pub fn begin_row(&mut self, line: usize) {
        self.lines.get_or_insert_default().push(line);
    }

    /// The message for a fault in a row, a column by its name, both, or the whole table.
    pub fn refuse(&self, row: Option<usize>, column: Option<&str>, fault: Fault) -> StudyError {
        let key = match (row, column) {
            (Some(row), Some(name)) => format!("row {}, column {}", row + 1, shorten(name)),
            (Some(row), None) => format!("row {}", row + 1),
            (None, Some(name)) => format!("column {}", shorten(name)),
            (None, None) => String::new(),
        };
        let place = self.lines.as_ref().map(|lines| {
            let line = row.and_then(|row| lines.get(row)).copied().unwrap_or(1);
            Place { line, column: 1 }
        });
        StudyError::new(&self.path, place, key, fault, None)
    }

    /// The message for a fault in the file as such.
    pub fn refuse_all(&self, fault: Fault) -> StudyError {
        StudyError::about_file(&self.path, fault)
    }

    /// Checks the names of the columns.
    ///
    /// # Errors
    /// A column that is unknown or given twice.
    pub fn check_columns(&self, columns: &[String], allowed: &[String]) -> Result<(), StudyError> {
        check_columns(columns, allowed).map_err(|(column, fault)| {
            self.refuse(None, columns.get(column).map(String::as_str), fault)
        })
    }
}

/// The first column that is unknown or given twice.
fn check_columns(columns: &[String], allowed: &[String]) -> Result<(), (usize, Fault)> {
    let mut seen = HashSet::new();
    for (index, column) in columns.iter().enumerate() {
        if !allowed.contains(column) {
            let fault = Fault::new("unknown column", shorten(column), list_names(column, allowed));
            return Err((index, fault));
        }
        if !seen.insert(column) {
            let fault = Fault::new("a column given twice", column, "each column once");
            return Err((index, fault));
        }
    }
    Ok(())
}

/// A row with more or fewer values than there are columns.
pub(crate) fn ragged(found: usize, columns: usize) -> Fault {
    Fault::new("a ragged row", format!("{found} values"), format!("{columns}, one per column"))
}

/// A table with more values than a study may hold.
pub(crate) fn too_many_values(found: String) -> Fault {
    Fault::new("too many values", found, format!("at most {MAX_VALUES} in all tables of a study"))
}

/// A number that a file holds.
///
/// # Errors
/// A number that is not finite, shown as it is `written`.
pub(crate) fn check_number(number: f64, written: impl Fn() -> String) -> Result<Entry, Fault> {
    if number.is_finite() {
        return Ok(Entry::Number(number));
    }
    Err(Fault::new("not a finite number", written(), "a finite number"))
}

/// A cell that holds nothing.
pub(crate) fn empty_value() -> Fault {
    Fault::new("an empty value", "nothing", "a number")
}
