//! Tables in Parquet files: columns of numbers or text, named as a CSV file's.

use std::path::Path;

use bytes::Bytes;
use parquet::basic::Type;
use parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use parquet::data_type::{ByteArray, DataType};
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::schema::types::ColumnDescriptor;

use super::error::{Fault, StudyError};
use super::file_values::Entry;
use super::parquet_bounds::{Bounds, check_footer, check_pages, guarded};
use super::parquet_values::{Annotation, described, next_values, said};
use super::rows::{Rows, TableFile, check_number, empty_value};

/// Values of a column that are decoded at a time.
const BATCH: usize = 1024;

/// The longest text of a cell, bytes; no parameter has a word as long.
const MAX_TEXT_BYTES: usize = 256;

/// Reads the table out of a file's bytes; `allowed` are the names that columns may have.
///
/// # Errors
/// Bytes that are no Parquet file, or one that unpacks to too much; a column that is unknown, given
/// twice, or neither of numbers nor of text; a value that is missing or not finite, too many of them.
pub(crate) fn read(path: &Path, bytes: Vec<u8>, allowed: &[String]) -> Result<Rows, StudyError> {
    let file = TableFile::without_lines(path);
    let read = guarded(|| decode(&file, bytes, allowed));
    let (columns, rows) = read.map_err(|fault| file.refuse_all(fault))??;
    Ok(Rows::in_file(columns, rows, file))
}

fn decode(
    file: &TableFile,
    bytes: Vec<u8>,
    allowed: &[String],
) -> Result<(Vec<String>, Vec<Vec<Entry>>), StudyError> {
    let refuse = |fault| file.refuse_all(fault);
    let bytes = Bytes::from(bytes);
    check_footer(Bounds::STUDY, &bytes).map_err(refuse)?;
    let reader = SerializedFileReader::new(bytes.clone()).map_err(|error| refuse(said(&error)))?;
    let schema = reader.metadata().file_metadata().schema_descr();
    let columns: Vec<String> =
        schema.columns().iter().map(|column| column.name().to_owned()).collect();
    file.check_columns(&columns, allowed)?;
    for (descriptor, name) in schema.columns().iter().zip(&columns) {
        check_type(descriptor).map_err(|fault| file.refuse(None, Some(name), fault))?;
    }
    let all: Vec<usize> = (0..columns.len()).collect();
    let row_count = check_pages(Bounds::STUDY, &bytes, reader.metadata(), &all).map_err(refuse)?;
    let mut rows: Vec<Vec<Entry>> = Vec::with_capacity(row_count);
    rows.resize_with(row_count, || Vec::with_capacity(columns.len()));
    let mut first = 0;
    for group in 0..reader.num_row_groups() {
        let group = reader.get_row_group(group).map_err(|error| refuse(said(&error)))?;
        // Not below 0 and, with those before, not above the number of rows: it has been counted.
        let count = usize::try_from(group.metadata().num_rows()).unwrap_or(0);
        let rows = rows.get_mut(first..first + count).unwrap_or_default();
        for (index, name) in columns.iter().enumerate() {
            let column = group.get_column_reader(index).map_err(|error| refuse(said(&error)))?;
            let unsigned = Annotation::of(&schema.column(index)) == Annotation::Unsigned;
            read_column(Place { file, name, first }, column, unsigned, rows)?;
        }
        first += count;
    }
    Ok((columns, rows))
}

/// Where values come from.
#[derive(Clone, Copy)]
struct Place<'a> {
    file: &'a TableFile,
    name: &'a str,
    /// The row of the first value.
    first: usize,
}

fn read_column(
    place: Place<'_>,
    column: ColumnReader,
    unsigned: bool,
    rows: &mut [Vec<Entry>],
) -> Result<(), StudyError> {
    let number = |number: f64| check_number(number, || number.to_string());
    match column {
        ColumnReader::DoubleColumnReader(column) => {
            read_values(place, column, rows, |v| number(*v))
        }
        ColumnReader::FloatColumnReader(column) => {
            read_values(place, column, rows, |v| number(f64::from(*v)))
        }
        ColumnReader::Int32ColumnReader(column) => read_values(place, column, rows, |v| {
            number(if unsigned { f64::from(*v as u32) } else { f64::from(*v) })
        }),
        ColumnReader::Int64ColumnReader(column) => read_values(place, column, rows, |v| {
            number(if unsigned { *v as u64 as f64 } else { *v as f64 })
        }),
        ColumnReader::ByteArrayColumnReader(column) => read_values(place, column, rows, text),
        _ => Err(place.file.refuse(None, Some(place.name), wrong_type("another type"))),
    }
}

fn read_values<T: DataType>(
    place: Place<'_>,
    mut column: ColumnReaderImpl<T>,
    rows: &mut [Vec<Entry>],
    entry: impl Fn(&T::T) -> Result<Entry, Fault>,
) -> Result<(), StudyError> {
    let mut done = 0;
    while done < rows.len() {
        let most = BATCH.min(rows.len() - done);
        let values =
            next_values(&mut column, most).map_err(|fault| place.file.refuse_all(fault))?;
        for (index, value) in values.iter().enumerate() {
            let row = done + index;
            let entry =
                value.as_ref().map_or_else(|| Err(empty_value()), &entry).map_err(|fault| {
                    place.file.refuse(Some(place.first + row), Some(place.name), fault)
                })?;
            if let Some(cells) = rows.get_mut(row) {
                cells.push(entry);
            }
        }
        done += values.len();
    }
    Ok(())
}

fn text(value: &ByteArray) -> Result<Entry, Fault> {
    if value.len() > MAX_TEXT_BYTES {
        let found = format!("{} bytes", value.len());
        return Err(Fault::new(
            "too long a text",
            found,
            format!("at most {MAX_TEXT_BYTES} bytes"),
        ));
    }
    match value.as_utf8() {
        Ok("") => Err(empty_value()),
        Ok(text) => Ok(Entry::Text(text.to_owned())),
        Err(_) => Err(Fault::new("the text is not UTF-8", "other bytes", "UTF-8")),
    }
}

/// Columns of numbers and of text only: no truths, dates, decimals, nor raw bytes.
fn check_type(column: &ColumnDescriptor) -> Result<(), Fault> {
    let (physical, annotation) = (column.physical_type(), Annotation::of(column));
    let fits = match physical {
        Type::DOUBLE | Type::FLOAT => annotation == Annotation::None,
        Type::INT32 | Type::INT64 => {
            matches!(annotation, Annotation::None | Annotation::Signed | Annotation::Unsigned)
        }
        Type::BYTE_ARRAY => annotation == Annotation::Text,
        _ => false,
    };
    if fits && column.max_rep_level() == 0 && column.max_def_level() <= 1 {
        return Ok(());
    }
    Err(wrong_type(&described(column)))
}

fn wrong_type(found: &str) -> Fault {
    Fault::new("wrong type", format!("a column of {found}"), "a column of numbers or of text")
}
