//! Reads tables of designs: one column per design variable and one design per row.

use std::path::Path;

use arrow_array::RecordBatchReader;

use super::error::{Fault, StudyError};
use super::file::read_file::read_bytes;
use super::file::table_input::{Rows, cells_in_memory};
use super::file::values::Entry;
use super::plan::planned_study::Study;
use super::plan::variable::DesignValue;
use crate::tabular::{Cells, Limits, Refusal, check_name};

impl Study {
    /// Reads the designs in a file. Each design is valid at every point of the study.
    ///
    /// # Errors
    /// Returns the first fault with its row and column: an unreadable file, a column that is unknown, missing or given
    /// twice, a value outside its variable's range, or a design that is invalid at a point.
    pub fn designs(&self, path: &Path) -> Result<Vec<Vec<DesignValue>>, StudyError> {
        let refuse = |fault| StudyError::about_file(path, fault);
        let allowed = "a name that ends in .csv or .parquet, or - for standard input";
        check_name(path, allowed).map_err(refuse)?;
        let bytes = read_bytes(path).map_err(refuse)?;
        self.designs_in(path, |limits| Cells::read(path, bytes, limits))
    }

    /// Reads the designs in an Arrow table, called `name` in messages.
    ///
    /// # Errors
    /// Returns an error for the reasons given at [`Study::designs`].
    pub fn designs_in_arrow(
        &self,
        name: &str,
        reader: impl RecordBatchReader,
    ) -> Result<Vec<Vec<DesignValue>>, StudyError> {
        self.designs_in(Path::new(name), |limits| Cells::of_arrow(reader, limits))
    }

    /// Reads the designs in a table in memory, called `name` in messages. Each row has one value per column, `None` if it
    /// is missing.
    ///
    /// # Errors
    /// Returns an error for the reasons given at [`Study::designs`].
    pub fn designs_in_memory(
        &self,
        name: &str,
        columns: Vec<String>,
        rows: Vec<Vec<Option<Entry>>>,
    ) -> Result<Vec<Vec<DesignValue>>, StudyError> {
        self.designs_in(Path::new(name), |limits| cells_in_memory(columns, rows, limits))
    }

    fn designs_in(
        &self,
        name: &Path,
        read: impl FnOnce(&Limits<'_>) -> Result<Cells, Refusal>,
    ) -> Result<Vec<Vec<DesignValue>>, StudyError> {
        let names: Vec<String> = self.variables.iter().map(|one| one.name.clone()).collect();
        let rows = Rows::in_file(name, read, &names)?;
        let missing = names.iter().find(|name| !rows.columns.contains(name));
        if let Some(name) = missing {
            let found = rows.column_names();
            let problem = format!("no column {name}");
            let allowed = format!("a column for each variable: {}", names.join(", "));
            return Err(rows.refuse(None, None, Fault::new(problem, found, allowed)));
        }
        (0..rows.rows.len()).map(|row| self.design_of(&rows, row)).collect()
    }

    fn design_of(&self, rows: &Rows<'_>, row: usize) -> Result<Vec<DesignValue>, StudyError> {
        let mut values = Vec::with_capacity(self.variables.len());
        for variable in &self.variables {
            let column = rows.column(&variable.name);
            // The caller has checked that each variable has a column.
            let entry = column.and_then(|column| rows.rows[row].get(column));
            let value = match entry {
                Some(Entry::Number(number)) => variable.number(*number),
                Some(Entry::Text(word)) => variable.word(word),
                None => Err(Fault::new("an empty value", "nothing", variable.allowed())),
            };
            values.push(value.map_err(|fault| rows.refuse(Some(row), column, fault))?);
        }
        self.with_design(&values).map_err(|fault| rows.refuse(Some(row), None, fault))?;
        Ok(values)
    }
}
