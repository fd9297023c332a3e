//! What a Parquet file says about itself, checked before anything is decoded.
//!
//! A small file may claim 2^60 rows, pages that unpack to gigabytes, dictionaries of 2^31 values, or a
//! schema so deep that reading it overflows the stack. The Parquet library takes memory as it is told
//! in some of these places; after these checks there is nothing left that it could be told.

use std::panic::{self, AssertUnwindSafe};

use bytes::Bytes;
use parquet::basic::{Compression, Type};
use parquet::file::metadata::{ColumnChunkMetaData, ParquetMetaData, RowGroupMetaData};
use parquet::file::reader::ChunkReader;

use super::error::Fault;
use super::node::MAX_FILE_BYTES;
use super::rows::{MAX_VALUES, too_many_values};
use super::thrift::Thrift;
use super::thrift_shape::{FOOTER, PAGE_HEADER};

/// The largest header of a page, bytes.
const MAX_HEADER_BYTES: usize = 16 * 1024;

/// How much a file may hold.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bounds {
    /// The largest footer, bytes, and the most values in it.
    footer_bytes: usize,
    footer_values: usize,
    /// How deep columns may be nested: 1 for flat ones, 3 for lists of numbers.
    depth: usize,
    /// The most rows.
    rows: usize,
    /// The most values of all columns, none if they are not all read at once.
    values: Option<usize>,
    /// The most values in a row of a column.
    values_in_row: i64,
    /// The most pages.
    pages: usize,
    /// The most bytes to which one page, and all of them, unpack.
    page_bytes: u64,
    unpacked_bytes: u64,
}

impl Bounds {
    /// Tables that a study names: flat, and read whole.
    pub const STUDY: Bounds = Bounds {
        footer_bytes: 4 * 1024 * 1024,
        footer_values: 200_000,
        depth: 1,
        rows: MAX_VALUES,
        values: Some(MAX_VALUES),
        values_in_row: 1,
        pages: 20_000,
        page_bytes: MAX_FILE_BYTES,
        unpacked_bytes: MAX_FILE_BYTES,
    };

    /// Tables of results, which are read in batches: what a part of half a million rows can need, with a
    /// study in its footer that is as large as studies may be.
    pub const RESULTS: Bounds = Bounds {
        footer_bytes: 96 * 1024 * 1024,
        footer_values: 1_000_000,
        depth: 3,
        rows: 1 << 20,
        values: None,
        values_in_row: 1024,
        pages: 500_000,
        page_bytes: 16 * 1024 * 1024,
        unpacked_bytes: 1 << 34,
    };
}

/// Calls the Parquet library, which has assertions that damaged files fail, such as a value that refers
/// to a dictionary's entry that is not there. What `call` changes must not be used after a fault.
///
/// # Errors
/// A fault where the library panics.
pub(crate) fn guarded<T>(call: impl FnOnce() -> T) -> Result<T, Fault> {
    // Nothing that is used later outlives the unwinding.
    panic::catch_unwind(AssertUnwindSafe(call))
        .map_err(|_| damaged("contents that the Parquet library stumbles over"))
}

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

/// Checks that a footer is there, that it can be read in one way only, and that columns are not too deep.
///
/// # Errors
/// What is wrong.
pub(crate) fn check_footer(bounds: Bounds, file: &impl ChunkReader) -> Result<(), Fault> {
    let not_ours = || damaged("a file that does not begin and end with PAR1");
    let end = file.len().checked_sub(8).filter(|end| *end >= 4).ok_or_else(not_ours)?;
    let read = |start, length| file.get_bytes(start, length).map_err(|_| not_ours());
    let (head, tail) = (read(0, 4)?, read(end, 8)?);
    let Some(([a, b, c, d], _)) =
        tail.split_first_chunk().filter(|(_, magic)| head == MAGIC[..] && *magic == MAGIC)
    else {
        return Err(not_ours());
    };
    let length = u32::from_le_bytes([*a, *b, *c, *d]) as usize;
    let most = bounds.footer_bytes;
    if length > most {
        let found = format!("a footer of {length} bytes");
        let allowed = format!("at most {most} bytes about the file");
        return Err(Fault::new("too large a footer", found, allowed));
    }
    let bytes = end.checked_sub(length as u64).and_then(|start| read(start, length).ok());
    let bytes = bytes.unwrap_or_default();
    let footer = Thrift::read_at_most(&bytes, bounds.footer_values).map(|(footer, _)| footer);
    let Some(footer) = footer.filter(|footer| FOOTER.fits(footer)) else {
        return Err(damaged("a footer that cannot be read, or of too many parts"));
    };
    if footer.items(2).first().is_none_or(|root| root.integer(5).is_none()) {
        return Err(damaged("a footer without columns"));
    }
    if !tree_fits(footer.items(2), bounds.depth) {
        let (found, allowed) = match bounds.depth {
            1 => ("columns within columns, or lists", "columns of numbers or text"),
            _ => ("columns within columns", "columns of numbers or text, or lists of them"),
        };
        return Err(Fault::new("wrong type", found, allowed));
    }
    Ok(())
}

/// Whether a schema, in which each element is followed by its children, is a tree of columns of at most
/// this depth below its root.
fn tree_fits(elements: &[Thrift<'_>], depth: usize) -> bool {
    // Children still to come of each element that is open.
    let mut open: Vec<i64> = Vec::new();
    for (index, element) in elements.iter().enumerate() {
        match open.last_mut() {
            Some(left) => *left -= 1,
            None if index > 0 => return false,
            None => {}
        }
        let children = element.integer(5).unwrap_or(0);
        if children < 0 || children > 0 && open.len() >= depth {
            return false;
        }
        open.push(children);
        while open.last() == Some(&0) {
            open.pop();
        }
    }
    open.is_empty()
}

/// Checks how much there is in these columns, and walks over all their pages without unpacking them.
/// Returns the number of rows.
///
/// # Errors
/// What is wrong.
pub(crate) fn check_pages(
    bounds: Bounds,
    file: &impl ChunkReader,
    metadata: &ParquetMetaData,
    columns: &[usize],
) -> Result<usize, Fault> {
    let mut rows = 0_usize;
    for group in metadata.row_groups() {
        let more = usize::try_from(group.num_rows()).map_err(|_| damaged("a number below 0"))?;
        rows = rows.saturating_add(more);
    }
    let values = rows.saturating_mul(columns.len().max(1));
    if bounds.values.is_some_and(|most| values > most) {
        return Err(too_many_values(format!("{rows} rows of {} columns", columns.len())));
    }
    if rows > bounds.rows {
        let allowed = format!("at most {} rows in a file", bounds.rows);
        return Err(Fault::new("too many rows", format!("{rows} rows"), allowed));
    }
    let mut walk = Walk { bounds, pages: 0, unpacked: 0 };
    for group in metadata.row_groups() {
        for index in columns {
            let column = group.columns().get(*index).ok_or_else(|| damaged("a missing column"))?;
            walk.column(&chunk(file, column)?, group, column)?;
        }
    }
    Ok(rows)
}

/// The pages of a column in a group of rows.
fn chunk(file: &impl ChunkReader, column: &ColumnChunkMetaData) -> Result<Bytes, Fault> {
    let outside = || damaged("a column outside of the file");
    let start = column.dictionary_page_offset().unwrap_or(column.data_page_offset());
    let range = u64::try_from(start).ok().zip(u64::try_from(column.compressed_size()).ok());
    let (start, length) = range
        .filter(|(start, length)| start.checked_add(*length).is_some_and(|end| end <= file.len()))
        .ok_or_else(outside)?;
    let length = usize::try_from(length).map_err(|_| outside())?;
    file.get_bytes(start, length).map_err(|_| outside())
}

struct Walk {
    bounds: Bounds,
    /// Pages so far, and bytes to which they unpack.
    pages: usize,
    unpacked: u64,
}

impl Walk {
    fn column(
        &mut self,
        pages: &[u8],
        group: &RowGroupMetaData,
        column: &ColumnChunkMetaData,
    ) -> Result<(), Fault> {
        let packed = column.compression();
        if !matches!(packed, Compression::UNCOMPRESSED | Compression::SNAPPY) {
            let found = format!("compression {packed}");
            let allowed = "SNAPPY, which is `compression=\"snappy\"` in many programs, or none";
            return Err(Fault::new("a compression that is not supported", found, allowed));
        }
        let rows = group.num_rows();
        // A row of a list has any number of values, an empty one counted as one.
        let list = column.column_descr().max_rep_level() > 0;
        let most = if list { rows.saturating_mul(self.bounds.values_in_row) } else { rows };
        let (mut rest, mut values, mut dictionary) = (pages, 0_i64, false);
        while !rest.is_empty() {
            let header = &rest[..rest.len().min(MAX_HEADER_BYTES)];
            let header = Thrift::read(header).filter(|(header, _)| PAGE_HEADER.fits(header));
            let (header, length) = header.ok_or_else(|| damaged("a page without a header"))?;
            let begins = values == 0 && !dictionary;
            let data = self.page(&header, column.column_type(), begins, dictionary)?;
            dictionary |= data.is_none();
            values = data.unwrap_or(0).saturating_add(values);
            refuse_unless(values <= most, "more values than rows")?;
            let size = header.integer(3).and_then(|size| usize::try_from(size).ok());
            rest = size
                .and_then(|size| rest.get(length..)?.get(size..))
                .ok_or_else(|| damaged("a page that is cut off"))?;
        }
        refuse_unless(values >= rows, "fewer values than rows")
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
        let Bounds { pages, page_bytes, unpacked_bytes, .. } = self.bounds;
        if unpacked > page_bytes || self.pages > pages || self.unpacked > unpacked_bytes {
            let found = format!("{} pages, unpacked {} bytes and more", self.pages, self.unpacked);
            let allowed = format!("at most {pages} pages and, unpacked, {unpacked_bytes} bytes");
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
