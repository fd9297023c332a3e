//! Opens Parquet files and reads them batch by batch in bounded memory.
//!
//! A small file may claim 2^60 rows, pages that decompress to gigabytes, dictionaries of 2^31 values, or a schema so deeply
//! nested that reading it overflows the stack. The sizes in a file are therefore checked before memory is allocated: its
//! footer in `source` and `thrift`, each page in `pages`, the number of rows and the types here. The Parquet library decodes
//! the rest.

use std::fs::File;
use std::sync::Arc;

use arrow_array::RecordBatch;
use arrow_schema::{DataType, Schema, SchemaRef};
use bytes::Bytes;
use parquet::arrow::arrow_reader::{
    ParquetRecordBatchReader, RowGroups, RowSelection, RowSelector,
};
use parquet::arrow::{ProjectionMask, parquet_to_arrow_field_levels, parquet_to_arrow_schema};
use parquet::column::page::PageIterator;
use parquet::errors::Result as ParquetResult;
use parquet::file::metadata::{KeyValue, ParquetMetaData, RowGroupMetaData};

use super::error::{Fault, guarded};
use super::pages::Chunks;
use super::source::{ByteLocation, ParquetSource};
use super::values::Kind;

/// The number of rows in a batch.
const BATCH: usize = 1024;
/// The largest number of rows in a file: twice the size of a part of a results table.
const MAX_ROWS: u64 = 1 << 20;
/// The longest fixed-length values, which are decimal numbers, bytes.
const MAX_FIXED_BYTES: i32 = 32;
/// The largest decompressed size of the pages of a file, bytes: an allowance for each value and one for the file.
const UNPACKED_PER_VALUE: u64 = 256;
const UNPACKED: u64 = 64 * 1024 * 1024;

/// A Parquet file.
pub(crate) struct ParquetFile {
    source: Arc<ParquetSource>,
    schema: SchemaRef,
}

impl ParquetFile {
    /// Opens a file in memory.
    pub fn in_memory(bytes: Vec<u8>) -> Result<ParquetFile, Fault> {
        Self::new(ByteLocation::Memory(Bytes::from(bytes)))
    }

    /// Opens a file on disk.
    pub fn on_disk(file: File) -> Result<ParquetFile, Fault> {
        Self::new(ByteLocation::Disk(file))
    }

    fn new(place: ByteLocation) -> Result<ParquetFile, Fault> {
        let source = Arc::new(ParquetSource::new(place)?);
        let schema = arrow_schema(&source.metadata, None)?;
        Ok(ParquetFile { source, schema })
    }

    /// Returns the number of rows that the file claims to have.
    pub fn rows(&self) -> u64 {
        let rows = |group: &RowGroupMetaData| u64::try_from(group.num_rows()).unwrap_or(u64::MAX);
        self.source.metadata.row_groups().iter().map(rows).fold(0, u64::saturating_add)
    }

    /// Returns the columns of the file, with the types that follow from the Parquet types alone.
    pub fn schema(&self) -> &SchemaRef {
        &self.schema
    }

    /// Returns the columns with the Arrow types and metadata that the writing program stored in the file.
    pub fn written_schema(&self) -> Result<SchemaRef, Fault> {
        arrow_schema(&self.source.metadata, self.key_values())
    }

    /// Returns the file's metadata under a key.
    pub fn metadata(&self, key: &str) -> Option<&str> {
        self.key_values()?.iter().find(|pair| pair.key == key)?.value.as_deref()
    }

    fn key_values(&self) -> Option<&Vec<KeyValue>> {
        self.source.metadata.file_metadata().key_value_metadata()
    }

    /// Reads some columns, in the order of the file, with the types of `types`, a schema of this file.
    pub fn batches(&self, columns: &[usize], types: &Schema) -> Result<ParquetBatches, Fault> {
        self.select(columns, types, None)
    }

    /// Reads one row with the types of `types`, a schema of this file.
    pub fn row(&self, row: u64, types: &Schema) -> Result<Option<RecordBatch>, Fault> {
        let all: Vec<usize> = (0..self.schema.fields().len()).collect();
        self.select(&all, types, Some(row))?.next().transpose()
    }

    fn select(
        &self,
        columns: &[usize],
        types: &Schema,
        row: Option<u64>,
    ) -> Result<ParquetBatches, Fault> {
        let rows = self.rows();
        if rows > MAX_ROWS {
            let allowed = format!("at most {MAX_ROWS} rows in a file");
            return Err(Fault::new("too many rows", format!("{rows} rows"), allowed));
        }
        let described = self.source.metadata.file_metadata().schema_descr();
        let long = described.columns().iter().any(|leaf| leaf.type_length() > MAX_FIXED_BYTES);
        let kinds = columns.iter().map(|column| self.schema.field(*column).data_type());
        if let Some(kind) = kinds.into_iter().find(|kind| long || Kind::of(kind).is_none()) {
            return Err(wrong_type(kind));
        }
        let values = rows.saturating_mul(columns.len() as u64);
        self.source.set_budget(values.saturating_mul(UNPACKED_PER_VALUE).saturating_add(UNPACKED));
        let mask = ProjectionMask::roots(described, columns.iter().copied());
        let open = || {
            let levels = parquet_to_arrow_field_levels(described, mask, Some(types.fields()))?;
            let groups = FileRowGroups(Arc::clone(&self.source));
            let before = |row| RowSelector::skip(usize::try_from(row).unwrap_or(usize::MAX));
            let row = row.map(|row| RowSelection::from(vec![before(row), RowSelector::select(1)]));
            ParquetRecordBatchReader::try_new_with_row_groups(&levels, &groups, BATCH, row)
        };
        let reader = guarded(open)?.map_err(|error| self.source.fault(&error.to_string()))?;
        let (source, rows_left) = (Arc::clone(&self.source), row.map_or(rows, |_| 1));
        Ok(ParquetBatches { source, reader: Some(reader), rows_left })
    }
}

fn arrow_schema(
    metadata: &ParquetMetaData,
    key_values: Option<&Vec<KeyValue>>,
) -> Result<SchemaRef, Fault> {
    let columns = metadata.file_metadata().schema_descr();
    let schema = guarded(|| parquet_to_arrow_schema(columns, key_values))?;
    schema.map(Arc::new).map_err(|error| Fault::damaged(&error.to_string()))
}

/// Returns the fault of a column with an unsupported type.
fn wrong_type(kind: &DataType) -> Fault {
    let allowed = "columns of numbers, text, Boolean values or lists of numbers";
    Fault::new("wrong type", format!("a column of {kind}"), allowed)
}

/// The row groups of a file, for the Parquet library.
struct FileRowGroups(Arc<ParquetSource>);

impl RowGroups for FileRowGroups {
    fn num_rows(&self) -> usize {
        self.row_groups().map(|group| usize::try_from(group.num_rows()).unwrap_or(0)).sum()
    }

    fn column_chunks(&self, column: usize) -> ParquetResult<Box<dyn PageIterator>> {
        Ok(Box::new(Chunks { source: Arc::clone(&self.0), column, next_group: 0 }))
    }

    fn row_groups(&self) -> Box<dyn Iterator<Item = &RowGroupMetaData> + '_> {
        Box::new(self.0.metadata.row_groups().iter())
    }

    fn metadata(&self) -> &ParquetMetaData {
        &self.0.metadata
    }
}

/// The rows of some columns, in order.
pub(crate) struct ParquetBatches {
    source: Arc<ParquetSource>,
    /// `None` after the end and after a fault.
    reader: Option<ParquetRecordBatchReader>,
    /// The number of rows still to be read.
    rows_left: u64,
}

impl ParquetBatches {
    fn advance(&mut self) -> Result<Option<RecordBatch>, Fault> {
        let Some(mut reader) = self.reader.take() else { return Ok(None) };
        let batch = guarded(|| reader.next())?.transpose();
        let batch = batch.map_err(|error| self.source.fault(&error.to_string()))?;
        let rows = batch.as_ref().map_or(0, |batch| batch.num_rows() as u64);
        let left = self.rows_left.checked_sub(rows).filter(|left| batch.is_some() || *left == 0);
        self.rows_left = left.ok_or_else(|| {
            Fault::damaged("a number of values that differs from the number of rows")
        })?;
        self.reader = batch.is_some().then_some(reader);
        Ok(batch)
    }
}

impl Iterator for ParquetBatches {
    type Item = Result<RecordBatch, Fault>;

    fn next(&mut self) -> Option<Self::Item> {
        self.advance().transpose()
    }
}
