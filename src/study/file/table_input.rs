//! Reads the tables of a study, inline or from files, converts columns with a unit in brackets to SI units, and locates
//! each value for error messages.

use std::collections::HashSet;
use std::path::{Path, PathBuf};

use crate::study::error::{Fault, Location, StudyError, describe_number, list_names, shorten};
use crate::study::file::key_units::split_unit;
use crate::study::file::quantity::Conversion;
use crate::study::file::source::SourcePath;
use crate::study::file::table_folders::MAX_VALUES;
use crate::study::file::values::{Entry, InlineTable, TableKey};
use crate::tabular::{Cell, Cells, Limits, Refusal, check_name, ragged};

/// A table whose column names are valid and distinct.
pub(crate) struct Rows<'a> {
    /// The names of the columns.
    pub columns: Vec<String>,
    /// The rows, with one value per column.
    pub rows: Vec<Vec<Entry>>,
    origin: Origin<'a>,
}

enum Origin<'a> {
    Inline(SourcePath<'a>),
    File(TableFile),
}

/// The file that a table was read from.
struct TableFile {
    path: PathBuf,
    /// The line number of each row if the table comes from a text file.
    lines: Option<Vec<usize>>,
}

/// Returns the rows of a table of times and values, whose times grow from 0; `names` are those of its columns.
pub(in crate::study) fn values_over_time(
    path: &SourcePath<'_>,
    table: &TableKey,
    names: [String; 2],
) -> Result<Vec<[f64; 2]>, StudyError> {
    let read = Rows::read(path, table, &names)?;
    let numbers = read.numbers(&names)?;
    let mut rows: Vec<[f64; 2]> = Vec::new();
    for (row, values) in numbers.iter().enumerate() {
        let values = [values[0], values[1]];
        let sound = rows.last().map_or(values[0] == 0.0, |before| values[0] > before[0]);
        if !sound {
            let allowed = "0 in the first row, then later times";
            let fault =
                Fault::new("times do not ascend from 0", describe_number(values[0]), allowed);
            return Err(read.refuse(Some(row), read.column(&names[0]), fault));
        }
        rows.push(values);
    }
    if rows.len() < 2 {
        let fault = Fault::new("one row only", "1 row", "two rows or more");
        return Err(read.refuse(None, None, fault));
    }
    Ok(rows)
}

/// Creates a table from rows in memory, with one value per column, `None` if it is missing.
pub(crate) fn cells_in_memory(
    columns: Vec<String>,
    rows: Vec<Vec<Option<Entry>>>,
    limits: &Limits<'_>,
) -> Result<Cells, Refusal> {
    let cell = |entry| match entry {
        Some(Entry::Number(number)) => Cell::of_number(number),
        Some(Entry::Text(text)) => Cell::Text(text),
        None => Cell::Empty,
    };
    let cells = |row: Vec<Option<Entry>>| row.into_iter().map(cell).collect();
    let rows = rows.into_iter().map(cells).collect();
    Cells::of_rows(columns, rows, limits)
}

impl<'a> Rows<'a> {
    /// Reads a table; `allowed` contains the valid column names.
    ///
    /// # Errors
    /// Returns an error if the file cannot or must not be read, if a row has more or fewer values than there are columns,
    /// if a column is unknown or given twice, if a value is missing or not finite, or if the table has no rows.
    pub fn read(
        path: &SourcePath<'a>,
        table: &TableKey,
        allowed: &[String],
    ) -> Result<Rows<'a>, StudyError> {
        match table {
            TableKey::Inline(inline) => Rows::of_inline(path, inline, allowed),
            TableKey::File(name) => Rows::of_file(path, name, allowed),
        }
    }

    fn of_inline(
        path: &SourcePath<'a>,
        table: &InlineTable,
        allowed: &[String],
    ) -> Result<Rows<'a>, StudyError> {
        for (row, values) in table.rows.iter().enumerate() {
            if values.len() != table.columns.len() {
                let fault = ragged(values.len(), table.columns.len());
                return Err(path.key("rows").item(row).refuse_value(fault));
            }
        }
        let known = known_columns(&table.columns, allowed)
            .map_err(|(column, fault)| path.key("columns").item(column).refuse_value(fault))?;
        let mut rows = table.rows.clone();
        let columns = converted(known, &mut rows);
        Rows { columns, rows, origin: Origin::Inline(path.clone()) }.not_empty()
    }

    fn of_file(
        path: &SourcePath<'a>,
        name: &str,
        allowed: &[String],
    ) -> Result<Rows<'a>, StudyError> {
        let (file, bytes) = path.folders().read(name).map_err(|mut fault| {
            fault.problem = format!("the table cannot be read: {}", fault.problem);
            path.refuse_value(fault)
        })?;
        check_name(&file, "a name that ends in .csv or .parquet")
            .map_err(|fault| path.refuse_value(Fault { found: Some(shorten(name)), ..fault }))?;
        let rows = Rows::in_file(&file, |limits| Cells::read(&file, bytes, limits), allowed, None)?;
        path.folders()
            .count(rows.rows.len() * rows.columns.len())
            .map_err(|fault| path.refuse_value(fault))?;
        Ok(rows)
    }

    /// Reads a table outside the study file, called `name` in messages; `allowed` contains the valid column names, and
    /// `empty` is a missing value if there may be one.
    pub fn in_file(
        name: &Path,
        read: impl FnOnce(&Limits<'_>) -> Result<Cells, Refusal>,
        allowed: &[String],
        empty: Option<Entry>,
    ) -> Result<Rows<'a>, StudyError> {
        let columns = |columns: &[String]| known_columns(columns, allowed).map(|_| ());
        let refuse = |Refusal { line, row, column, fault }| {
            StudyError::new(name, line.map(at_line), key(row, column.as_deref()), *fault, None)
        };
        let limits = Limits { columns: &columns, values: MAX_VALUES };
        let Cells { columns, rows, lines } = read(&limits).map_err(refuse)?;
        let file = TableFile { path: name.to_owned(), lines };
        let entry = |row: usize, (cell, column): (Cell, &String)| {
            let fault = match cell {
                Cell::Number(number) => return Ok(Entry::Number(number)),
                Cell::Text(text) => return Ok(Entry::Text(text)),
                Cell::NotFinite(written) => not_finite(written),
                Cell::Empty => match &empty {
                    Some(entry) => return Ok(entry.clone()),
                    None => Fault::new("an empty value", "nothing", "a number"),
                },
            };
            Err(file.refuse(Some(row), Some(column), fault))
        };
        let entries = |(row, cells): (usize, Vec<Cell>)| {
            cells.into_iter().zip(&columns).map(|cell| entry(row, cell)).collect()
        };
        let mut rows: Vec<_> =
            rows.into_iter().enumerate().map(entries).collect::<Result<_, _>>()?;
        // The reader has called `known_columns` with the same names.
        let known = known_columns(&columns, allowed).map_err(|(column, fault)| {
            file.refuse(None, columns.get(column).map(String::as_str), fault)
        })?;
        let columns = converted(known, &mut rows);
        Rows { columns, rows, origin: Origin::File(file) }.not_empty()
    }

    fn not_empty(self) -> Result<Rows<'a>, StudyError> {
        if self.rows.is_empty() {
            let fault = Fault::new("a table without rows", "0 rows", "at least one row");
            return Err(self.refuse(None, None, fault));
        }
        Ok(self)
    }

    /// Returns the numbers of these columns in this order, row by row.
    ///
    /// # Errors
    /// Returns an error if the table lacks a column, or if a value is not a number.
    pub fn numbers(&self, names: &[String]) -> Result<Vec<Vec<f64>>, StudyError> {
        let column = |name: &String| {
            let fault = || {
                Fault::new("a missing column", self.column_names(), format!("a column `{name}`"))
            };
            self.column(name).ok_or_else(|| self.refuse(None, None, fault()))
        };
        let order = names.iter().map(column).collect::<Result<Vec<usize>, _>>()?;
        let number = |row: usize, column: usize| match &self.rows[row][column] {
            Entry::Number(number) => Ok(*number),
            Entry::Text(text) => {
                let found = format!("text {:?}", shorten(text));
                let fault = Fault::new("not a number", found, "a number");
                Err(self.refuse(Some(row), Some(column), fault))
            }
        };
        let numbers = |row| order.iter().map(|&column| number(row, column)).collect();
        (0..self.rows.len()).map(numbers).collect()
    }

    /// Returns the place of the column with this name.
    pub fn column(&self, name: &str) -> Option<usize> {
        self.columns.iter().position(|column| column == name)
    }

    /// Checks that the table has these columns; `allowed` says in words which columns it needs.
    pub fn check_has<'n>(
        &self,
        mut names: impl Iterator<Item = &'n str>,
        allowed: impl Fn() -> String,
    ) -> Result<(), StudyError> {
        let Some(name) = names.find(|name| self.column(name).is_none()) else { return Ok(()) };
        let fault = Fault::new(format!("no column {name}"), self.column_names(), allowed());
        Err(self.refuse(None, None, fault))
    }

    /// Returns the names of the columns, for messages.
    pub fn column_names(&self) -> String {
        match self.columns.len() {
            0 => "no columns".to_owned(),
            _ => self.columns.join(", "),
        }
    }

    /// Returns the error for a fault in a row, a column, a cell, or the whole table.
    pub fn refuse(&self, row: Option<usize>, column: Option<usize>, fault: Fault) -> StudyError {
        match &self.origin {
            Origin::Inline(path) => {
                let path = match (row, column) {
                    (Some(row), Some(column)) => path.key("rows").item(row).item(column),
                    (Some(row), None) => path.key("rows").item(row),
                    (None, Some(column)) => path.key("columns").item(column),
                    (None, None) => path.clone(),
                };
                path.refuse_value(fault)
            }
            Origin::File(file) => {
                let name = column.and_then(|column| self.columns.get(column));
                file.refuse(row, name.map(String::as_str), fault)
            }
        }
    }
}

impl TableFile {
    /// Returns the error for a fault in a row, a column, a cell, or the whole table.
    fn refuse(&self, row: Option<usize>, column: Option<&str>, fault: Fault) -> StudyError {
        let line = |lines: &Vec<usize>| row.and_then(|row| lines.get(row)).copied().unwrap_or(1);
        let place = self.lines.as_ref().map(line).map(at_line);
        StudyError::new(&self.path, place, key(row, column), fault, None)
    }
}

fn at_line(line: usize) -> Location {
    Location { line, column: 1 }
}

/// Returns the location of a row and a column for messages.
fn key(row: Option<usize>, column: Option<&str>) -> String {
    let row = row.map(|row| format!("row {}", row + 1));
    let column = column.map(|name| format!("column {}", shorten(name)));
    row.into_iter().chain(column).collect::<Vec<_>>().join(", ")
}

/// Returns the columns with these names.
fn known_columns(
    columns: &[String],
    allowed: &[String],
) -> Result<Vec<KnownColumn>, (usize, Fault)> {
    let mut seen = HashSet::new();
    let known = |(index, written): (usize, &String)| {
        let known = KnownColumn::of(written, allowed).map_err(|fault| (index, fault))?;
        if !seen.insert(known.name.clone()) {
            let fault = Fault::new("a column given twice", written, "each column once");
            return Err((index, fault));
        }
        Ok(known)
    };
    columns.iter().enumerate().map(known).collect()
}

/// Converts the numbers of all columns, and returns the SI names of the columns.
fn converted(known: Vec<KnownColumn>, rows: &mut [Vec<Entry>]) -> Vec<String> {
    for (index, column) in known.iter().enumerate() {
        column.convert(rows, index);
    }
    known.into_iter().map(|column| column.name).collect()
}

/// Returns the fault of a number that is not finite.
pub(crate) fn not_finite(written: String) -> Fault {
    Fault::new("not a finite number", written, "a finite number")
}

/// A column as the program knows it, such as `speed_rad_s` for `speed [rpm]`, and how its numbers become SI numbers.
struct KnownColumn {
    name: String,
    conversion: Option<Conversion>,
}

impl KnownColumn {
    /// Returns the column that a table calls by this name; `allowed` contains the SI names.
    fn of(written: &str, allowed: &[String]) -> Result<KnownColumn, Fault> {
        let plain = |name: &String| KnownColumn { name: name.clone(), conversion: None };
        if let Some(name) = allowed.iter().find(|name| *name == written) {
            return Ok(plain(name));
        }
        let unknown =
            || Fault::new("unknown column", shorten(written), list_names(written, allowed));
        let with_unit = written.trim().strip_suffix(']').and_then(|text| text.split_once('['));
        let (short, unit) = with_unit.ok_or_else(unknown)?;
        let (short, unit) = (short.trim(), unit.trim());
        let known = allowed.iter().find_map(|name| {
            let (without, si) = split_unit(name)?;
            (name == short || without == short).then_some((name, si))
        });
        let (name, si) = known.ok_or_else(unknown)?;
        let conversion = Conversion::new(unit, si).map_err(|fault| Fault {
            found: Some(format!("column {}", shorten(written))),
            ..fault
        })?;
        Ok(KnownColumn { name: name.clone(), conversion: Some(conversion) })
    }

    /// Converts the numbers of this column in all rows.
    fn convert(&self, rows: &mut [Vec<Entry>], column: usize) {
        let Some(conversion) = &self.conversion else { return };
        for row in rows {
            if let Some(Entry::Number(number)) = row.get_mut(column) {
                *number = conversion.of(*number);
            }
        }
    }
}
