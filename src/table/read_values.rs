//! Some rows of a table that is read, as columns of values of known types.

use std::path::PathBuf;

use parquet::basic::Type;
use parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use parquet::data_type::{ByteArray, DataType};
use parquet::schema::types::ColumnDescriptor;

use super::read::TableError;
use crate::study::{Annotation, Fault, next_lists, next_values};

/// The longest text of a cell, bytes.
const MAX_TEXT_BYTES: usize = 16 * 1024;

/// What a column holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Numbers.
    Number,
    /// Counts and numbers of things.
    Count,
    /// Whole numbers with a sign.
    Integer,
    /// Yes or no.
    Truth,
    /// Words or text.
    Text,
    /// Lists of numbers.
    Numbers,
}

impl Kind {
    /// In words.
    pub fn name(self) -> &'static str {
        match self {
            Kind::Number => "numbers",
            Kind::Count => "whole numbers from 0",
            Kind::Integer => "whole numbers with a sign",
            Kind::Truth => "truths",
            Kind::Text => "text",
            Kind::Numbers => "lists of numbers",
        }
    }

    pub(super) fn of(column: &ColumnDescriptor) -> Option<Kind> {
        use Annotation as A;
        let levels = (column.max_rep_level(), column.max_def_level());
        match (column.physical_type(), Annotation::of(column), levels) {
            (Type::DOUBLE, A::None, (0, 0 | 1)) => Some(Kind::Number),
            (Type::DOUBLE, A::None, (1, 3)) => Some(Kind::Numbers),
            (Type::INT32 | Type::INT64, A::Unsigned, (0, 0 | 1)) => Some(Kind::Count),
            (Type::INT32 | Type::INT64, A::Signed | A::None, (0, 0 | 1)) => Some(Kind::Integer),
            (Type::BOOLEAN, A::None, (0, 0 | 1)) => Some(Kind::Truth),
            (Type::BYTE_ARRAY, A::Text, (0, 0 | 1)) => Some(Kind::Text),
            _ => None,
        }
    }
}

/// Values of a column, none where one is missing.
#[derive(Clone, Debug, PartialEq)]
pub enum Values {
    /// Numbers.
    Number(Vec<Option<f64>>),
    /// Counts and numbers of things.
    Count(Vec<Option<u64>>),
    /// Whole numbers with a sign.
    Integer(Vec<Option<i64>>),
    /// Yes or no.
    Truth(Vec<Option<bool>>),
    /// Words or text.
    Text(Vec<Option<String>>),
    /// Lists of numbers.
    Numbers(Vec<Option<Vec<f64>>>),
}

impl Values {
    /// What they are.
    pub fn kind(&self) -> Kind {
        match self {
            Values::Number(_) => Kind::Number,
            Values::Count(_) => Kind::Count,
            Values::Integer(_) => Kind::Integer,
            Values::Truth(_) => Kind::Truth,
            Values::Text(_) => Kind::Text,
            Values::Numbers(_) => Kind::Numbers,
        }
    }
}

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

/// The next values of a column of this kind, as many as there are rows.
pub(super) fn next(column: &mut ColumnReader, kind: Kind, rows: usize) -> Result<Values, Fault> {
    use ColumnReader as C;
    Ok(match (kind, column) {
        (Kind::Number, C::DoubleColumnReader(column)) => {
            Values::Number(all(column, rows, |value| Ok(*value))?)
        }
        (Kind::Numbers, C::DoubleColumnReader(column)) => {
            let mut lists = Vec::with_capacity(rows);
            while lists.len() < rows {
                lists.extend(next_lists(column, rows - lists.len())?);
            }
            Values::Numbers(lists)
        }
        (Kind::Count, C::Int64ColumnReader(column)) => {
            Values::Count(all(column, rows, |value| Ok(*value as u64))?)
        }
        (Kind::Count, C::Int32ColumnReader(column)) => {
            Values::Count(all(column, rows, |value| Ok(u64::from(*value as u32)))?)
        }
        (Kind::Integer, C::Int64ColumnReader(column)) => {
            Values::Integer(all(column, rows, |value| Ok(*value))?)
        }
        (Kind::Integer, C::Int32ColumnReader(column)) => {
            Values::Integer(all(column, rows, |value| Ok(i64::from(*value)))?)
        }
        (Kind::Truth, C::BoolColumnReader(column)) => {
            Values::Truth(all(column, rows, |value| Ok(*value))?)
        }
        (Kind::Text, C::ByteArrayColumnReader(column)) => Values::Text(all(column, rows, text)?),
        (kind, _) => return Err(Fault::new("wrong type", "another type", kind.name())),
    })
}

fn all<T: DataType, V>(
    column: &mut ColumnReaderImpl<T>,
    rows: usize,
    convert: impl Fn(&T::T) -> Result<V, Fault>,
) -> Result<Vec<Option<V>>, Fault> {
    let mut values = Vec::with_capacity(rows);
    while values.len() < rows {
        for value in next_values(column, rows - values.len())? {
            values.push(value.as_ref().map(&convert).transpose()?);
        }
    }
    Ok(values)
}

fn text(value: &ByteArray) -> Result<String, Fault> {
    if value.len() > MAX_TEXT_BYTES {
        let allowed = format!("at most {MAX_TEXT_BYTES} bytes");
        return Err(Fault::new("too long a text", format!("{} bytes", value.len()), allowed));
    }
    let text = value.as_utf8().map(str::to_owned);
    text.map_err(|_| Fault::new("the text is not UTF-8", "other bytes", "UTF-8"))
}
