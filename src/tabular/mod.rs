//! Tables in files and in memory: CSV, Parquet and Arrow, read in bounds, whoever has written them.
//!
//! The ground floor of reading: it knows nothing of studies and results. Bytes become bounded facts about the file,
//! these become batches of columns of known types, and these cells of rows or columns of values.

mod cells;
mod csv;
mod delta;
mod error;
mod guard;
mod pages;
mod parquet;
mod read_cells;
mod source;
mod thrift;
mod unpack;
mod values;

pub(crate) use cells::{Cell, Cells, Limits, ragged};
pub(crate) use csv::to_text;
pub(crate) use error::{Fault, Refusal};
pub(crate) use parquet::{Batches, ParquetFile};
pub(crate) use read_cells::check_name;
pub use values::{Kind, Values};
