//! Reads CSV, Parquet and Arrow tables from any source in bounded memory and time.
//!
//! This module does not depend on studies or results. It checks the structure of a file, decodes batches of columns with
//! known types, and converts them to rows of cells or to columns of values.
//!
//! Read `values` and `cells` first: columns of values and rows of cells. `csv` reads text. For Parquet, `thrift`, `unpack`
//! and `text_lengths` check what the library is given, `source` and `pages` apply these checks, and `parquet` reads batches
//! of rows. `read_cells` chooses between the formats.

mod cells;
mod csv;
mod error;
mod pages;
mod parquet;
mod read_cells;
mod source;
mod text_lengths;
mod thrift;
mod unpack;
mod values;

pub(crate) use cells::{Cell, Cells, Limits, ragged};
pub(crate) use csv::to_text;
pub(crate) use error::{Fault, Refusal};
pub(crate) use parquet::{ParquetBatches, ParquetFile};
pub(crate) use read_cells::check_name;
pub use values::{ColumnValues, Kind};
