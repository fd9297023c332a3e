//! Pages of a column, one by one, each unpacked and checked before the Parquet library decodes it.
//!
//! The library takes memory for as many bytes as a page announces, unpacks gzip and Zstandard until their data end,
//! and takes memory for as many values as a dictionary announces. So it is told that nothing is packed: it hands out
//! packed pages, which are unpacked here in bounds, and which hold what they announce.

use std::sync::Arc;

use bytes::Bytes;
use parquet::basic::{Compression, Encoding, Type};
use parquet::column::page::{Page, PageIterator, PageMetadata, PageReader};
use parquet::errors::Result as ParquetResult;
use parquet::file::serialized_reader::SerializedPageReader;
use parquet::schema::types::ColumnDescPtr;

use super::delta::check_texts;
use super::error::Fault;
use super::source::Source;
use super::unpack::unpack;

/// What a page counts at least, bytes.
const LEAST_PAGE_BYTES: u64 = 1024;
/// The most numbers in the lists of a group of rows, on average and in all.
const MAX_LIST: i64 = 1024;
const MAX_IN_LISTS: i64 = 1 << 24;

/// The pages of a column in all groups of rows.
pub(super) struct Chunks {
    pub source: Arc<Source>,
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
                // A row of a list has any number of values, an empty one counted as one.
                most: match column.max_rep_level() {
                    0 => rows,
                    _ => rows.saturating_mul(MAX_LIST).min(rows.saturating_add(MAX_IN_LISTS)),
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

/// The pages of a column in a group of rows.
struct Pages {
    source: Arc<Source>,
    packed: SerializedPageReader<Source>,
    compression: Compression,
    column: ColumnDescPtr,
    /// How many rows there are, and values at most.
    rows: i64,
    most: i64,
    /// Values so far, and whether there was a dictionary.
    values: i64,
    dictionary: bool,
    peeked: Option<Page>,
}

fn unless(holds: bool, found: &str) -> Result<(), Fault> {
    if holds { Ok(()) } else { Err(Fault::damaged(found)) }
}

impl Pages {
    /// Unpacks and checks a page; none at the end of the column.
    fn check(&mut self, mut page: Option<Page>) -> Result<Option<Page>, Fault> {
        match &mut page {
            None => unless(self.values >= self.rows, "fewer values than rows")?,
            Some(Page::DictionaryPage { buf, num_values, encoding, .. }) => {
                self.unpack(buf, 0, true)?;
                let begins = !self.dictionary && self.values == 0;
                self.dictionary = true;
                // A text takes its length at least.
                let least = match self.column.physical_type() {
                    Type::INT64 | Type::DOUBLE => 8,
                    Type::INT96 => 12,
                    Type::FIXED_LEN_BYTE_ARRAY => self.column.type_length().max(1) as usize,
                    _ => 4,
                };
                let bytes = (*num_values as usize).checked_mul(least);
                let fits = bytes.is_some_and(|bytes| bytes <= buf.len());
                let known = matches!(encoding, Encoding::PLAIN | Encoding::PLAIN_DICTIONARY);
                unless(begins, "a dictionary that is not where its column begins")?;
                unless(fits, "a dictionary of more values than its page can hold")?;
                unless(known, "a dictionary in an unknown encoding")?;
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
            unless(self.values <= self.most, "more values than rows")?;
        }
        Ok(page)
    }

    /// Unpacks a page of which the first bytes, the levels of a newer one, are not packed.
    fn unpack(&self, bytes: &mut Bytes, levels: usize, is_packed: bool) -> Result<(), Fault> {
        // A page without values has nothing to unpack.
        if is_packed && self.compression != Compression::UNCOMPRESSED && bytes.len() > levels {
            let mut unpacked = bytes[..levels].to_vec();
            unpack(&bytes[levels..], self.compression, &mut unpacked)?;
            *bytes = unpacked.into();
        }
        self.source.pay((bytes.len() as u64).max(LEAST_PAGE_BYTES))
    }

    /// Checks the values of a page behind its levels.
    fn check_values(
        &self,
        bytes: &[u8],
        levels: usize,
        encoding: Encoding,
        most: u32,
    ) -> Result<(), Fault> {
        let values = bytes.get(levels..);
        let values = values.ok_or_else(|| Fault::damaged("a page that is cut off"))?;
        let coded = matches!(encoding, Encoding::PLAIN_DICTIONARY | Encoding::RLE_DICTIONARY);
        unless(!coded || self.dictionary, "values of a dictionary that is missing")?;
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
        self.check(page).map_err(|fault| self.source.refuse(fault))
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
