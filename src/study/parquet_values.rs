//! Values of a Parquet column, some at a time, and what they mean.

use parquet::basic::{ConvertedType, LogicalType};
use parquet::column::reader::ColumnReaderImpl;
use parquet::data_type::DataType;
use parquet::errors::ParquetError;
use parquet::schema::types::ColumnDescriptor;

use super::error::{Fault, shorten};
use super::parquet_bounds::damaged;

/// The next values of a column that is no list, one per row and at most so many; none where one is
/// missing.
///
/// # Errors
/// What the library says, and a column that has come to its end.
pub(crate) fn next_values<T: DataType>(
    column: &mut ColumnReaderImpl<T>,
    most: usize,
) -> Result<Vec<Option<T::T>>, Fault> {
    let (mut levels, mut values) = (Vec::new(), Vec::new());
    let read = column.read_records(most, Some(&mut levels), None, &mut values);
    let (records, _, _) = read.map_err(|error| said(&error))?;
    if records == 0 {
        return Err(damaged("fewer values than rows"));
    }
    // A column in which none may be missing has no levels; elsewhere 1 says that a value is there.
    let mut values = values.into_iter();
    let value = |index| {
        let there = levels.get(index).is_none_or(|level| *level > 0);
        if there { values.next() } else { None }
    };
    Ok((0..records).map(value).collect())
}

/// The next lists of a column of lists, at most so many; none where a list is missing or has a value
/// that is.
///
/// # Errors
/// What the library says, and a column that has come to its end.
pub(crate) fn next_lists<T: DataType>(
    column: &mut ColumnReaderImpl<T>,
    most: usize,
) -> Result<Vec<Option<Vec<T::T>>>, Fault> {
    let (mut levels, mut repeated, mut values) = (Vec::new(), Vec::new(), Vec::new());
    let read = column.read_records(most, Some(&mut levels), Some(&mut repeated), &mut values);
    let (records, _, _) = read.map_err(|error| said(&error))?;
    if records == 0 || levels.len() != repeated.len() {
        return Err(damaged("fewer values than rows"));
    }
    let mut lists: Vec<Option<Vec<T::T>>> = Vec::with_capacity(records);
    let mut values = values.into_iter();
    // Levels of a list that may be missing, of values that may be: 0 no list, 1 an empty one, 2 no
    // value, 3 a value. A row begins where nothing repeats.
    for (level, again) in levels.into_iter().zip(repeated) {
        if again == 0 {
            lists.push((level > 0).then(Vec::new));
        }
        let value = if level == 3 { values.next() } else { None };
        match (lists.last_mut(), value) {
            (Some(Some(list)), Some(value)) => list.push(value),
            (Some(list), None) if level == 2 => *list = None,
            _ => {}
        }
    }
    if lists.len() == records { Ok(lists) } else { Err(damaged("a list that does not begin")) }
}

/// What a column's values mean beyond their type.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Annotation {
    /// Nothing.
    None,
    /// Whole numbers with a sign.
    Signed,
    /// Whole numbers without one.
    Unsigned,
    /// Text.
    Text,
    /// Something else.
    Other,
}

impl Annotation {
    /// Of a column.
    pub fn of(column: &ColumnDescriptor) -> Annotation {
        use ConvertedType as Old;
        match (column.logical_type_ref(), column.converted_type()) {
            (Some(LogicalType::Integer(kind)), _) if kind.is_signed => Annotation::Signed,
            (Some(LogicalType::Integer(_)), _) => Annotation::Unsigned,
            (Some(LogicalType::String | LogicalType::Enum), _) => Annotation::Text,
            (Some(_), _) => Annotation::Other,
            (None, Old::NONE) => Annotation::None,
            (None, Old::INT_8 | Old::INT_16 | Old::INT_32 | Old::INT_64) => Annotation::Signed,
            (None, Old::UINT_8 | Old::UINT_16 | Old::UINT_32 | Old::UINT_64) => {
                Annotation::Unsigned
            }
            (None, Old::UTF8 | Old::ENUM) => Annotation::Text,
            (None, _) => Annotation::Other,
        }
    }
}

/// A column's type in the format's own words.
pub(crate) fn described(column: &ColumnDescriptor) -> String {
    let physical = column.physical_type();
    let found = match (column.logical_type_ref(), column.converted_type()) {
        (Some(logical), _) => format!("{physical}, {logical:?}"),
        (None, ConvertedType::NONE) => physical.to_string(),
        (None, converted) => format!("{physical}, {converted}"),
    };
    shorten(&found)
}

/// What the library says.
pub(crate) fn said(error: &ParquetError) -> Fault {
    damaged(shorten(&error.to_string()))
}
