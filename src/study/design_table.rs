//! Tables of designs: CSV, Parquet or from memory, columns named as variables, one design per row.

use std::path::Path;

use super::csv_table;
use super::error::{Fault, StudyError, shorten};
use super::file_values::Entry;
use super::parquet_table;
use super::plan::Study;
use super::read_file::read_bytes;
use super::rows::{
    MAX_VALUES, Rows, TableFile, check_number, empty_value, ragged, too_many_values,
};
use super::variable::DesignValue;

/// Faults of tables in files need no study file to be placed in.
struct Nowhere;

impl super::error::Locate for Nowhere {
    fn refuse(
        &self,
        path: &super::key_path::KeyPath,
        _: super::error::Spot,
        fault: Fault,
    ) -> StudyError {
        StudyError::new(Path::new(""), None, path.to_string(), fault, None)
    }
}

impl Study {
    /// The designs in a table; each makes physical sense at every point.
    ///
    /// # Errors
    /// The first thing that is wrong, with row and column: a file that cannot be read, a column that is
    /// unknown, missing or given twice, a value that its variable does not have.
    pub fn designs(&self, path: &Path) -> Result<Vec<Vec<DesignValue>>, StudyError> {
        let extension = path.extension().and_then(|extension| extension.to_str());
        let read = match extension.map(str::to_ascii_lowercase).as_deref() {
            Some("csv") => csv_table::read,
            Some("parquet") => parquet_table::read,
            _ => {
                let found = shorten(&path.display().to_string());
                let allowed = "a name that ends in .csv or .parquet, or - for standard input";
                let problem = "neither a CSV nor a Parquet file by its name";
                return Err(StudyError::about_file(path, Fault::new(problem, found, allowed)));
            }
        };
        let bytes = read_bytes(path).map_err(|fault| StudyError::about_file(path, fault))?;
        let names: Vec<String> = self.variables.iter().map(|one| one.name.clone()).collect();
        self.check_designs(&names, read(path, bytes, &names)?)
    }

    /// The designs in a table that is in memory, with one value per column in each row, none where it is
    /// missing; messages call the table `name`.
    ///
    /// # Errors
    /// As for [`Study::designs`].
    pub fn designs_in_memory(
        &self,
        name: &str,
        columns: Vec<String>,
        rows: Vec<Vec<Option<Entry>>>,
    ) -> Result<Vec<Vec<DesignValue>>, StudyError> {
        let table = TableFile::without_lines(Path::new(name));
        let names: Vec<String> = self.variables.iter().map(|one| one.name.clone()).collect();
        table.check_columns(&columns, &names)?;
        if rows.len().saturating_mul(columns.len()) > MAX_VALUES {
            let found = format!("{} rows of {} values", rows.len(), columns.len());
            return Err(table.refuse_all(too_many_values(found)));
        }
        let checked = |(index, row): (usize, Vec<Option<Entry>>)| {
            if row.len() != columns.len() {
                return Err(table.refuse(Some(index), None, ragged(row.len(), columns.len())));
            }
            let cell = |(value, column): (Option<Entry>, &String)| {
                let entry = match value {
                    None => Err(empty_value()),
                    Some(Entry::Number(number)) => check_number(number, || number.to_string()),
                    Some(text) => Ok(text),
                };
                entry.map_err(|fault| table.refuse(Some(index), Some(column), fault))
            };
            row.into_iter().zip(&columns).map(cell).collect()
        };
        let rows = rows.into_iter().enumerate().map(checked).collect::<Result<_, _>>()?;
        self.check_designs(&names, Rows::in_file(columns, rows, table))
    }

    fn check_designs(
        &self,
        names: &[String],
        rows: Rows,
    ) -> Result<Vec<Vec<DesignValue>>, StudyError> {
        if rows.rows.is_empty() {
            let fault = Fault::new("a table without rows", "0 rows", "at least one row");
            return Err(rows.refuse(&Nowhere, None, None, fault));
        }
        let missing = names.iter().find(|name| !rows.columns.contains(name));
        if let Some(name) = missing {
            let found = rows.columns.join(", ");
            let problem = format!("no column {name}");
            let allowed = format!("a column for each variable: {}", names.join(", "));
            return Err(rows.refuse(&Nowhere, None, None, Fault::new(problem, found, allowed)));
        }
        (0..rows.rows.len()).map(|row| self.design_of(&rows, row)).collect()
    }

    fn design_of(&self, rows: &Rows, row: usize) -> Result<Vec<DesignValue>, StudyError> {
        let mut values = Vec::with_capacity(self.variables.len());
        for variable in &self.variables {
            let column = rows.columns.iter().position(|name| *name == variable.name);
            // A column for each variable has been found.
            let entry = column.and_then(|column| rows.rows[row].get(column));
            let value = match entry {
                Some(Entry::Number(number)) => variable.number(*number),
                Some(Entry::Text(word)) => variable.word(word),
                None => Err(Fault::new("an empty value", "nothing", variable.allowed())),
            };
            values.push(value.map_err(|fault| rows.refuse(&Nowhere, Some(row), column, fault))?);
        }
        self.with_design(&values).map_err(|fault| rows.refuse(&Nowhere, Some(row), None, fault))?;
        Ok(values)
    }
}
