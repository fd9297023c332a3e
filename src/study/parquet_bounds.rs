//! What a Parquet file says about itself, checked before anything is decoded.
//!
//! A small file may claim 2^60 rows, pages that unpack to gigabytes, dictionaries of 2^31 values, or a
//! schema so deep that reading it overflows the stack. The Parquet library takes memory as it is told
//! in some of these places; after these checks there is nothing left that it could be told.

use parquet::basic::{Compression, Type};
use parquet::file::metadata::{ColumnChunkMetaData, ParquetMetaData, RowGroupMetaData};

use super::error::Fault;
use super::node::MAX_FILE_BYTES;
use super::rows::{MAX_VALUES, too_many_values};
use super::thrift::Thrift;
use super::thrift_shape::{FOOTER, PAGE_HEADER};

/// The largest footer and the largest header of a page, bytes.
const MAX_FOOTER_BYTES: usize = 4 * 1024 * 1024;
const MAX_HEADER_BYTES: usize = 16 * 1024;

/// The most pages of a file.
const MAX_PAGES: usize = 20_000;

/// At the beginning and at the end of a file.
const MAGIC: &[u8; 4] = b"PAR1";

/// Numbers in the format: kinds of pages, and encodings.
const DATA_PAGE: i64 = 0;
const DICTIONARY_PAGE: i64 = 2;
const DATA_PAGE_V2: i64 = 3;
const PLAIN: i64 = 0;
const PLAIN_DICTIONARY: i64 = 2;
const RLE_DICTIONARY: i64 = 8;

/// A file that is no Parquet file, or a damaged one.
pub(crate) fn damaged(found: impl Into<String>) -> Fault {
    Fault::new("not a readable Parquet file", found, "a Parquet file that is whole")
}

fn refuse_unless(condition: bool, found: &str) -> Result<(), Fault> {
    if condition { Ok(()) } else { Err(damaged(found)) }
}

/// Checks that a footer is there, that it can be read in one way only, and that columns are flat.
///
/// # Errors
/// What is wrong.
pub(crate) fn check_footer(bytes: &[u8]) -> Result<(), Fault> {
    let tail = bytes.last_chunk::<8>().filter(|tail| tail.ends_with(MAGIC));
    let tail = tail.filter(|_| bytes.starts_with(MAGIC) && bytes.len() >= 12);
    let Some([a, b, c, d, ..]) = tail else {
        return Err(damaged("a file that does not begin and end with PAR1"));
    };
    let length = u32::from_le_bytes([*a, *b, *c, *d]) as usize;
    if length > MAX_FOOTER_BYTES {
        let found = format!("a footer of {length} bytes");
        let allowed = format!("at most {MAX_FOOTER_BYTES} bytes about the file");
        return Err(Fault::new("too large a footer", found, allowed));
    }
    let end = bytes.len() - 8;
    let footer = end.checked_sub(length).and_then(|start| bytes.get(start..end));
    let footer = footer.and_then(Thrift::read).map(|(footer, _)| footer);
    let Some(footer) = footer.filter(|footer| FOOTER.fits(footer)) else {
        return Err(damaged("a footer that cannot be read, or of too many parts"));
    };
    let Some((root, columns)) = footer.items(2).split_first() else {
        return Err(damaged("a footer without columns"));
    };
    let flat = columns.iter().all(|column| column.integer(5).is_none_or(|children| children == 0));
    if !flat || root.integer(5) != i64::try_from(columns.len()).ok() {
        let allowed = "columns of numbers or text";
        return Err(Fault::new("wrong type", "columns within columns, or lists", allowed));
    }
    Ok(())
}

/// Checks how much there is, and walks over all pages without unpacking them. Returns the number of
/// rows.
///
/// # Errors
/// What is wrong.
pub(crate) fn check_pages(bytes: &[u8], metadata: &ParquetMetaData) -> Result<usize, Fault> {
    let columns = metadata.file_metadata().schema_descr().num_columns();
    let mut rows = 0_usize;
    for group in metadata.row_groups() {
        let more = usize::try_from(group.num_rows()).map_err(|_| damaged("a number below 0"))?;
        rows = rows.saturating_add(more);
    }
    if rows.saturating_mul(columns.max(1)) > MAX_VALUES {
        return Err(too_many_values(format!("{rows} rows of {columns} columns")));
    }
    let mut walk = Walk { bytes, pages: 0, unpacked: 0 };
    for group in metadata.row_groups() {
        group.columns().iter().try_for_each(|column| walk.column(group, column))?;
    }
    Ok(rows)
}

struct Walk<'a> {
    bytes: &'a [u8],
    /// Pages so far, and bytes to which they unpack.
    pages: usize,
    unpacked: u64,
}

impl Walk<'_> {
    fn column(
        &mut self,
        group: &RowGroupMetaData,
        column: &ColumnChunkMetaData,
    ) -> Result<(), Fault> {
        let packed = column.compression();
        if !matches!(packed, Compression::UNCOMPRESSED | Compression::SNAPPY) {
            let found = format!("compression {packed}");
            let allowed = "SNAPPY, which is `compression=\"snappy\"` in many programs, or none";
            return Err(Fault::new("a compression that is not supported", found, allowed));
        }
        let start = column.dictionary_page_offset().unwrap_or(column.data_page_offset());
        let range = usize::try_from(start).ok().zip(usize::try_from(column.compressed_size()).ok());
        let pages = range
            .and_then(|(start, length)| self.bytes.get(start..)?.get(..length))
            .ok_or_else(|| damaged("a column outside of the file"))?;
        let rows = group.num_rows();
        let (mut rest, mut values, mut dictionary) = (pages, 0_i64, false);
        while !rest.is_empty() {
            let header = &rest[..rest.len().min(MAX_HEADER_BYTES)];
            let header = Thrift::read(header).filter(|(header, _)| PAGE_HEADER.fits(header));
            let (header, length) = header.ok_or_else(|| damaged("a page without a header"))?;
            let begins = values == 0 && !dictionary;
            let data = self.page(&header, column.column_type(), begins, dictionary)?;
            dictionary |= data.is_none();
            values += data.unwrap_or(0);
            refuse_unless(values <= rows, "more values than rows")?;
            let size = header.integer(3).and_then(|size| usize::try_from(size).ok());
            rest = size
                .and_then(|size| rest.get(length..)?.get(size..))
                .ok_or_else(|| damaged("a page that is cut off"))?;
        }
        refuse_unless(values == rows, "fewer values than rows")
    }

    /// Checks the header of a page. Returns the number of values; none of a dictionary, which must be
    /// where a column begins.
    fn page(
        &mut self,
        header: &Thrift<'_>,
        kind: Type,
        begins: bool,
        dictionary: bool,
    ) -> Result<Option<i64>, Fault> {
        self.pages += 1;
        let unpacked = header.integer(2).and_then(|size| u64::try_from(size).ok());
        let unpacked = unpacked.ok_or_else(|| damaged("a page without a size"))?;
        self.unpacked = self.unpacked.saturating_add(unpacked);
        if self.pages > MAX_PAGES || self.unpacked > MAX_FILE_BYTES {
            let found = format!("{} pages, unpacked {} bytes and more", self.pages, self.unpacked);
            let allowed =
                format!("at most {MAX_PAGES} pages and, unpacked, {MAX_FILE_BYTES} bytes");
            return Err(Fault::new("the file is too large when unpacked", found, allowed));
        }
        let (about, encoding) = match header.integer(1) {
            Some(DATA_PAGE) => (header.field(5), 2),
            Some(DICTIONARY_PAGE) => (header.field(7), 2),
            Some(DATA_PAGE_V2) => (header.field(8), 4),
            _ => return Err(damaged("a page of unknown kind")),
        };
        let about = about.ok_or_else(|| damaged("a page without a description"))?;
        let values = about.integer(1).filter(|values| *values >= 0);
        let values = values.ok_or_else(|| damaged("a page without a number of values"))?;
        let encoding = about.integer(encoding);
        if header.integer(1) == Some(DICTIONARY_PAGE) {
            // A text takes its length at least.
            let least = if matches!(kind, Type::INT64 | Type::DOUBLE) { 8 } else { 4 };
            let fits = u64::try_from(values).is_ok_and(|values| values * least <= unpacked);
            refuse_unless(begins, "a dictionary that is not where its column begins")?;
            refuse_unless(fits, "a dictionary of more values than its page can hold")?;
            refuse_unless(
                matches!(encoding, Some(PLAIN | PLAIN_DICTIONARY)),
                "a dictionary in an unknown encoding",
            )?;
            return Ok(None);
        }
        match encoding {
            Some(PLAIN) => Ok(Some(values)),
            Some(PLAIN_DICTIONARY | RLE_DICTIONARY) => {
                refuse_unless(dictionary, "values of a dictionary that is missing")?;
                Ok(Some(values))
            }
            // Some of the others unpack a page to any size.
            _ => {
                let found = format!("encoding {} of the format", encoding.unwrap_or(-1));
                let allowed = "the encodings PLAIN and RLE_DICTIONARY";
                Err(Fault::new("an encoding that is not supported", found, allowed))
            }
        }
    }
}
