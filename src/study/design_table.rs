//! Reads tables of designs: one column per design variable and one design per row.

use std::path::Path;

use arrow_array::RecordBatchReader;

use super::error::{Fault, StudyError};
use super::file::read_file::read_bytes;
use super::file::table_input::Rows;
use super::file::values::Entry;
use super::plan::planned_study::Study;
use super::plan::variable::DesignValue;
use crate::tabular::{Cell, Cells, Limits, Refusal, check_name};

/// Locates faults for tables outside a study file, which need no place in one.
struct Nowhere;

impl super::error::Locate for Nowhere {
    fn refuse(
        &self,
        path: &super::file::key_path::KeyPath,
        _: super::error::Spot,
        fault: Fault,
    ) -> StudyError {
        StudyError::new(Path::new(""), None, path.to_string(), fault, None)
    }
}

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
        let cell = |entry| match entry {
            Some(Entry::Number(number)) => Cell::of_number(number),
            Some(Entry::Text(text)) => Cell::Text(text),
            None => Cell::Empty,
        };
        let cells = |row: Vec<Option<Entry>>| row.into_iter().map(cell).collect();
        let rows = rows.into_iter().map(cells).collect();
        self.designs_in(Path::new(name), |limits| Cells::of_rows(columns, rows, limits))
    }

    fn designs_in(
        &self,
        name: &Path,
        read: impl FnOnce(&Limits<'_>) -> Result<Cells, Refusal>,
    ) -> Result<Vec<Vec<DesignValue>>, StudyError> {
        let names: Vec<String> = self.variables.iter().map(|one| one.name.clone()).collect();
        self.check_designs(&names, Rows::in_file(name, read, &names)?)
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
            // The caller has checked that each variable has a column.
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

#[cfg(test)]
mod tests {
    use std::path::Path;
    use std::sync::Arc;

    use arrow_array::types::Int8Type;
    use arrow_array::{
        ArrayRef, BooleanArray, DictionaryArray, Int16Array, LargeStringArray, RecordBatch,
        RecordBatchIterator,
    };

    use super::{DesignValue, Study, StudyError};

    fn study() -> Study {
        let text = "
schema: 1
name: two
seed: 1
model: {kind: ball_balancer}
initial_conditions: {design: {monte_carlo: {samples: 2}}}
design:
  speed_rad_s: {from: -260, to: -140}
  material: {choices: {steel: {ball_mass_kg: 1.4e-4}, tin: {ball_mass_kg: 1.2e-4}}}
";
        Study::parse(Path::new("two.yaml"), text.to_owned()).unwrap()
    }

    fn read(columns: Vec<(&str, ArrayRef)>) -> Result<Vec<Vec<DesignValue>>, StudyError> {
        let batch = RecordBatch::try_from_iter(columns).unwrap();
        let batches = [Ok(batch.clone()), Ok(batch.clone())];
        study().designs_in_arrow("designs", RecordBatchIterator::new(batches, batch.schema()))
    }

    fn speeds() -> ArrayRef {
        Arc::new(Int16Array::from(vec![-150, -200]))
    }

    #[test]
    fn columns_may_have_any_order_and_encoding() {
        let words: DictionaryArray<Int8Type> = [Some("tin"), Some("steel")].into_iter().collect();
        let designs = read(vec![("material", Arc::new(words)), ("speed_rad_s", speeds())]).unwrap();
        let row = |speed, choice| vec![DesignValue::Number(speed), DesignValue::Choice(choice)];
        let (first, second) = (row(-150.0, 1), row(-200.0, 0));
        assert_eq!(designs, [first.clone(), second.clone(), first, second]);
    }

    #[test]
    fn errors_name_the_row_and_column() {
        let truths: ArrayRef = Arc::new(BooleanArray::from(vec![true, false]));
        let text = |words: [Option<&str>; 2]| -> ArrayRef {
            Arc::new(LargeStringArray::from(words.to_vec()))
        };
        for (columns, key, problem) in [
            (vec![("speed_rad_s", Arc::clone(&truths))], "column speed_rad_s", "wrong type"),
            (vec![("speed", truths)], "column speed", "unknown column"),
            (vec![("speed_rad_s", speeds())], "", "no column material"),
            (
                vec![("speed_rad_s", speeds()), ("material", text([Some("tin"), None]))],
                "row 2, column material",
                "an empty value",
            ),
            (
                vec![("speed_rad_s", speeds()), ("material", text([Some("tan"), Some("tin")]))],
                "row 1, column material",
                "not a choice",
            ),
        ] {
            let error = read(columns).unwrap_err();
            assert_eq!((error.key(), error.problem()), (key, problem), "{error}");
            assert_eq!(error.file(), Path::new("designs"));
        }
    }
}
