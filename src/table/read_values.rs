//! Some rows of a table that is read, as columns of values of known types.

use std::path::PathBuf;

use super::table_error::TableError;
use crate::tabular::{Fault, Kind, Values};

/// Some rows.
#[derive(Clone, Debug, PartialEq)]
pub struct Batch {
    pub(super) file: PathBuf,
    /// The number of the first one, from 0.
    pub first_row: u64,
    /// How many there are.
    pub rows: usize,
    /// The columns that were asked for, in that order.
    pub columns: Vec<(String, Values)>,
}

macro_rules! typed {
    ($name:ident, $kind:ident, $value:ty, $meaning:literal) => {
        #[doc = $meaning]
        ///
        /// # Errors
        /// Where it was not asked for as such.
        pub fn $name(&self, column: &str) -> Result<&[Option<$value>], TableError> {
            match self.column(column)? {
                Values::$kind(values) => Ok(values),
                other => Err(self.wrong(column, other.kind().name(), Kind::$kind)),
            }
        }
    };
}

impl Batch {
    typed!(numbers, Number, f64, "A column of numbers.");
    typed!(counts, Count, u64, "A column of counts.");
    typed!(integers, Integer, i64, "A column of whole numbers with a sign.");
    typed!(truths, Truth, bool, "A column of yes or no.");
    typed!(texts, Text, String, "A column of words or text.");
    typed!(lists, Numbers, Vec<f64>, "A column of lists of numbers.");

    fn column(&self, name: &str) -> Result<&Values, TableError> {
        let found = self.columns.iter().find(|(column, _)| column == name);
        found.map(|(_, values)| values).ok_or_else(|| {
            let names: Vec<&str> = self.columns.iter().map(|(name, _)| name.as_str()).collect();
            let fault = Fault::new("not asked for", names.join(", "), "a column that is read");
            TableError::new(&self.file, Some(name), fault)
        })
    }

    fn wrong(&self, column: &str, found: &str, allowed: Kind) -> TableError {
        let fault = Fault::new("wrong type", format!("a column of {found}"), allowed.name());
        TableError::new(&self.file, Some(column), fault)
    }
}
