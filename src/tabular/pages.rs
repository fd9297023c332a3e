//! Decompresses and checks each page of a column before the Parquet library decodes it.
//!
//! The size of a file does not bound the memory of the library (parquet 60.1). The files of `tests/fuzz/hostile.rs`, and two
//! others with the last two pages, have this effect if the library reads them without these checks:
//!
//! | page | file, bytes | memory of the library |
//! |---|---|---|
//! | a dictionary that announces 2^31 - 1 numbers | 133 | 16 GiB |
//! | a dictionary that announces 2^31 - 1 texts | 134 | 8 GiB |
//! | a list of 2^27 equal numbers in one row | 157 | 2 GiB |
//! | 1 GiB of zeros in gzip | 1,043,022 | 2 GiB |
//!
//! Moreover, the library cannot decompress Zstandard without a C compiler. This module therefore declares every column
//! uncompressed to the library, which then returns compressed pages. The pages are decompressed here within limits, and
//! checked to contain as many values as they announce; `text_lengths` checks texts.

use std::sync::Arc;

use bytes::Bytes;
use parquet::basic::{Compression, Encoding, Type};
use parquet::column::page::{Page, PageIterator, PageMetadata, PageReader};
use parquet::errors::Result as ParquetResult;
use parquet::file::serialized_reader::SerializedPageReader;
use parquet::schema::types::ColumnDescPtr;

use super::error::Fault;
use super::source::ParquetSource;
use super::text_lengths::check_texts;
use super::unpack::unpack;

/// The largest mean length of the lists in a row group, and the largest total length.
const MAX_LIST_LENGTH: i64 = 1024;
const MAX_LIST_VALUES: i64 = 1 << 24;

/// The pages of a column in all row groups.
pub(super) struct Chunks {
    pub source: Arc<ParquetSource>,
    pub column: usize,
    pub next_group: usize,
}

impl Iterator for Chunks {
    type Item = ParquetResult<Box<dyn PageReader>>;

    fn next(&mut self) -> Option<Self::Item> {
        let group = self.source.metadata.row_groups().get(self.next_group)?;
        self.next_group += 1;
        let chunk = group.columns().get(self.column)?;
        let plain = chunk.clone().into_builder().set_compression(Compression::UNCOMPRESSED);
        let source = Arc::clone(&self.source);
        let reader =
            plain.build().and_then(|chunk| SerializedPageReader::new(source, &chunk, 0, None));
        let rows = group.num_rows();
        let column = chunk.column_descr_ptr();
        Some(reader.map(|packed| -> Box<dyn PageReader> {
            Box::new(Pages {
                source: Arc::clone(&self.source),
                packed,
                compression: chunk.compression(),
                rows,
                // A list has any number of values; an empty list counts as one.
                max_values: match column.max_rep_level() {
                    0 => rows,
                    _ => rows
                        .saturating_mul(MAX_LIST_LENGTH)
                        .min(rows.saturating_add(MAX_LIST_VALUES)),
                },
                column,
                values: 0,
                dictionary: false,
                peeked: None,
            })
        }))
    }
}

impl PageIterator for Chunks {}

/// The pages of a column in one row group.
struct Pages {
    source: Arc<ParquetSource>,
    packed: SerializedPageReader<ParquetSource>,
    compression: Compression,
    column: ColumnDescPtr,
    /// The number of rows, and the largest number of values.
    rows: i64,
    max_values: i64,
    /// The number of values so far, and whether a dictionary page has been read: the library panics if one is missing.
    values: i64,
    dictionary: bool,
    peeked: Option<Page>,
}

fn ensure(holds: bool, found: &str) -> Result<(), Fault> {
    if holds { Ok(()) } else { Err(Fault::damaged(found)) }
}

impl Pages {
    /// Decompresses and checks a page; `None` is the end of the column.
    fn check(&mut self, mut page: Option<Page>) -> Result<Option<Page>, Fault> {
        match &mut page {
            None => ensure(self.values >= self.rows, "fewer values than rows")?,
            Some(Page::DictionaryPage { buf, num_values, .. }) => {
                self.unpack(buf, 0, true)?;
                self.dictionary = true;
                // The length of a text takes four bytes; the library checks the size of fixed-length values.
                let least = match self.column.physical_type() {
                    Type::INT64 | Type::DOUBLE => 8,
                    Type::FIXED_LEN_BYTE_ARRAY => 1,
                    _ => 4,
                };
                let bytes = (*num_values as usize).checked_mul(least);
                let fits = bytes.is_some_and(|bytes| bytes <= buf.len());
                ensure(fits, "a dictionary of more values than its page can hold")?;
                self.check_values(buf, 0, Encoding::PLAIN, *num_values)?;
            }
            Some(Page::DataPage { buf, num_values, encoding, .. }) => {
                self.unpack(buf, 0, true)?;
                let mut levels = 0;
                for deep in [self.column.max_rep_level(), self.column.max_def_level()] {
                    if deep > 0 {
                        let length = buf.get(levels..).and_then(|rest| rest.first_chunk());
                        let length = length.map_or(u32::MAX, |length| u32::from_le_bytes(*length));
                        levels = levels.saturating_add(4).saturating_add(length as usize);
                    }
                }
                self.check_values(buf, levels, *encoding, *num_values)?;
            }
            Some(Page::DataPageV2 {
                buf,
                num_values,
                encoding,
                def_levels_byte_len,
                rep_levels_byte_len,
                is_compressed,
                ..
            }) => {
                let levels = def_levels_byte_len.saturating_add(*rep_levels_byte_len) as usize;
                self.unpack(buf, levels, *is_compressed)?;
                self.check_values(buf, levels, *encoding, *num_values)?;
            }
        }
        if let Some(page) = page.as_ref().filter(|page| page.is_data_page()) {
            self.values = self.values.saturating_add(i64::from(page.num_values()));
            ensure(self.values <= self.max_values, "more values than rows")?;
        }
        Ok(page)
    }

    /// Decompresses a page. Its first `levels` bytes, the levels of a page of version 2, are never compressed.
    fn unpack(&self, bytes: &mut Bytes, levels: usize, is_packed: bool) -> Result<(), Fault> {
        // A page without values contains no compressed bytes.
        if is_packed && self.compression != Compression::UNCOMPRESSED && bytes.len() > levels {
            let mut unpacked = bytes[..levels].to_vec();
            unpack(&bytes[levels..], self.compression, &mut unpacked)?;
            *bytes = unpacked.into();
        }
        self.source.charge(bytes.len() as u64)
    }

    /// Checks the values of a page, which follow its levels.
    fn check_values(
        &self,
        bytes: &[u8],
        levels: usize,
        encoding: Encoding,
        most: u32,
    ) -> Result<(), Fault> {
        let values = bytes.get(levels..);
        let values = values.ok_or_else(|| Fault::damaged("a truncated page"))?;
        let coded = matches!(encoding, Encoding::PLAIN_DICTIONARY | Encoding::RLE_DICTIONARY);
        ensure(!coded || self.dictionary, "values of a missing dictionary")?;
        match (self.column.physical_type(), encoding) {
            (Type::BYTE_ARRAY, _) | (Type::FIXED_LEN_BYTE_ARRAY, Encoding::DELTA_BYTE_ARRAY) => {
                check_texts(encoding, values, most as usize)
            }
            _ => Ok(()),
        }
    }
}

impl Iterator for Pages {
    type Item = ParquetResult<Page>;

    fn next(&mut self) -> Option<Self::Item> {
        self.get_next_page().transpose()
    }
}

impl PageReader for Pages {
    fn get_next_page(&mut self) -> ParquetResult<Option<Page>> {
        if let Some(page) = self.peeked.take() {
            return Ok(Some(page));
        }
        let page = self.packed.get_next_page()?;
        self.check(page).map_err(|fault| self.source.store(fault))
    }

    fn peek_next_page(&mut self) -> ParquetResult<Option<PageMetadata>> {
        self.peeked = self.get_next_page()?;
        Ok(self.peeked.as_ref().map(|page| PageMetadata {
            num_rows: match page {
                Page::DataPageV2 { num_rows, .. } => Some(*num_rows as usize),
                _ => None,
            },
            num_levels: page.is_data_page().then_some(page.num_values() as usize),
            is_dict: page.is_dictionary_page(),
        }))
    }

    fn skip_next_page(&mut self) -> ParquetResult<()> {
        self.get_next_page().map(drop)
    }
}
