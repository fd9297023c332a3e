//! Reads tables of designs: one column per design variable and one design per row.

use super::error::{Fault, StudyError};
use super::file::table_input::Rows;
use super::file::values::Entry;
use super::plan::planned_study::Study;
use super::plan::variable::DesignValue;
use super::table_source::TableSource;

impl Study {
    /// Reads the designs in a table: a file, also `-` for standard input, an Arrow table, or rows. Each design is valid at
    /// every point of the study.
    ///
    /// # Errors
    /// Returns the first fault with its row and column: an unreadable file, a column that is unknown, missing or given
    /// twice, a value outside its variable's range, or a design that is invalid at a point.
    pub fn designs<'a>(
        &self,
        table: impl Into<TableSource<'a>>,
    ) -> Result<Vec<Vec<DesignValue>>, StudyError> {
        let allowed = "a name that ends in .csv or .parquet, or - for standard input";
        let (name, read) = table.into().open(allowed)?;
        let names: Vec<String> =
            self.variables().iter().map(|variable| variable.name.clone()).collect();
        let rows = Rows::in_file(name, read, &names, None)?;
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
        let mut values = Vec::with_capacity(self.variables().len());
        for variable in self.variables() {
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
