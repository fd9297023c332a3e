//! Checks the structure of Parquet footers and page headers, which use Thrift's compact protocol.
//!
//! The Parquet library (60.1) trusts footers in four ways. It allocates memory for as many columns as a group announces, up
//! to 2^31. It recurses at each level of nested columns. It skips lists of Boolean values, which take no bytes, one by one.
//! Decoded values take 15 times as much memory as their bytes, or more. A file of 31 bytes thus makes the library allocate
//! 16 GiB, one of 600 kB ends the process, and one of 7 kB occupies it for hours (`tests/fuzz/hostile.rs`).
//!
//! These checks need the type of every known field, because the library decodes a known field with its expected type even if
//! the file states another one: a schema could otherwise be hidden in a text, where only the library finds it.
//!
//! Sources: Apache Thrift, `doc/specs/thrift-compact-protocol.md`; Apache Parquet, `parquet.thrift` of format 2.12.

use super::error::Fault;

/// The deepest nesting of values (a footer needs seven levels) and of columns (1 for flat columns, 3 for lists).
const MAX_DEPTH: usize = 12;
const MAX_COLUMN_DEPTH: usize = 3;
/// The largest number of columns in a group.
const MAX_COLUMNS: i64 = 100_000;
/// The largest number of values in a footer or in the header of a page.
const MAX_VALUES: usize = 1_000_000;

/// The expected type of a value.
#[derive(Clone, Copy)]
enum ThriftType {
    Boolean,
    /// The number of columns in a group, a 32-bit integer.
    Children,
    /// A value of this Thrift type that is neither Boolean, nor a list, nor a struct.
    Of(u8),
    List(&'static ThriftType),
    /// The known fields by their number; unknown fields are allowed.
    Struct(&'static [(i16, ThriftType)]),
}

use ThriftType::{Boolean, Children, List, Of, Struct};

const BYTE: ThriftType = Of(3);
const SHORT: ThriftType = Of(4);
const INT: ThriftType = Of(5);
const LONG: ThriftType = Of(6);
const DOUBLE: ThriftType = Of(7);
const BINARY: ThriftType = Of(8);
const LIST: u8 = 9;
const STRUCT: u8 = 12;

#[rustfmt::skip]
mod shapes {
    use super::{BINARY, BYTE, Children, DOUBLE, INT, LONG, List, SHORT, ThriftType, Struct, Boolean};

    const EMPTY: ThriftType = Struct(&[]);
    const UNIT: ThriftType = Struct(&[(1, EMPTY), (2, EMPTY), (3, EMPTY)]);
    const TIME: ThriftType = Struct(&[(1, Boolean), (2, UNIT)]);
    const LOGICAL_TYPE: ThriftType = Struct(&[
        (1, EMPTY), (2, EMPTY), (3, EMPTY), (4, EMPTY), (5, Struct(&[(1, INT), (2, INT)])), (6, EMPTY),
        (7, TIME), (8, TIME), (10, Struct(&[(1, BYTE), (2, Boolean)])), (11, EMPTY), (12, EMPTY), (13, EMPTY),
        (14, EMPTY), (15, EMPTY), (16, Struct(&[(1, BYTE)])), (17, Struct(&[(1, BINARY)])),
        (18, Struct(&[(1, BINARY), (2, INT)])),
    ]);
    const SCHEMA_ELEMENT: ThriftType = Struct(&[
        (1, INT), (2, INT), (3, INT), (4, BINARY), (5, Children), (6, INT), (7, INT), (8, INT), (9, INT),
        (10, LOGICAL_TYPE),
    ]);
    const KEY_VALUE: ThriftType = Struct(&[(1, BINARY), (2, BINARY)]);
    const STATISTICS: ThriftType = Struct(&[
        (1, BINARY), (2, BINARY), (3, LONG), (4, LONG), (5, BINARY), (6, BINARY), (7, Boolean), (8, Boolean),
        (9, LONG),
    ]);
    const BOX: ThriftType = Struct(&[
        (1, DOUBLE), (2, DOUBLE), (3, DOUBLE), (4, DOUBLE), (5, DOUBLE), (6, DOUBLE), (7, DOUBLE), (8, DOUBLE),
    ]);
    const COLUMN: ThriftType = Struct(&[
        (1, INT), (2, List(&INT)), (3, List(&BINARY)), (4, INT), (5, LONG), (6, LONG), (7, LONG),
        (8, List(&KEY_VALUE)), (9, LONG), (10, LONG), (11, LONG), (12, STATISTICS),
        (13, List(&Struct(&[(1, INT), (2, INT), (3, INT)]))), (14, LONG), (15, INT),
        (16, Struct(&[(1, LONG), (2, List(&LONG)), (3, List(&LONG))])),
        (17, Struct(&[(1, BOX), (2, List(&INT))])),
    ]);
    const COLUMN_CHUNK: ThriftType = Struct(&[
        (1, BINARY), (2, LONG), (3, COLUMN), (4, LONG), (5, INT), (6, LONG), (7, INT), (8, EMPTY), (9, BINARY),
    ]);
    const ROW_GROUP: ThriftType = Struct(&[
        (1, List(&COLUMN_CHUNK)), (2, LONG), (3, LONG), (4, List(&Struct(&[(1, INT), (2, Boolean), (3, Boolean)]))),
        (5, LONG), (6, LONG), (7, SHORT),
    ]);
    pub const FOOTER: ThriftType = Struct(&[
        (1, INT), (2, List(&SCHEMA_ELEMENT)), (3, LONG), (4, List(&ROW_GROUP)), (5, List(&KEY_VALUE)),
        (6, BINARY), (7, List(&UNIT)), (8, EMPTY), (9, BINARY),
    ]);
    pub const PAGE_HEADER: ThriftType = Struct(&[
        (1, INT), (2, INT), (3, INT), (4, INT),
        (5, Struct(&[(1, INT), (2, INT), (3, INT), (4, INT)])),
        (6, EMPTY),
        (7, Struct(&[(1, INT), (2, INT), (3, Boolean)])),
        (8, Struct(&[(1, INT), (2, INT), (3, INT), (4, INT), (5, INT), (6, INT), (7, Boolean)])),
    ]);
}

use shapes::{FOOTER, PAGE_HEADER};

/// Checks the footer of a file.
pub(super) fn check_footer(bytes: &[u8]) -> Result<(), Fault> {
    let mut reader = ThriftReader::new(bytes);
    match reader.value(STRUCT, Some(FOOTER), MAX_DEPTH) {
        Some(_) => Ok(()),
        None if reader.too_deep => {
            let allowed = "columns of numbers or text, or lists of them";
            Err(Fault::new("wrong type", "columns within columns", allowed))
        }
        None => Err(Fault::damaged("a footer that is damaged or has too many parts")),
    }
}

/// Returns the length of the page header at the start of these bytes.
pub(super) fn page_header(bytes: &[u8]) -> Result<usize, Fault> {
    let mut reader = ThriftReader::new(bytes);
    let read = reader.value(STRUCT, Some(PAGE_HEADER), MAX_DEPTH);
    read.map(|_| bytes.len() - reader.bytes.len())
        .ok_or_else(|| Fault::damaged("a page without a readable header"))
}

struct ThriftReader<'a> {
    /// The bytes still to be read, and the largest number of values in them.
    bytes: &'a [u8],
    values_left: usize,
    /// The number of columns still missing in each open group of columns.
    open_groups: Vec<i64>,
    too_deep: bool,
}

impl<'a> ThriftReader<'a> {
    fn new(bytes: &'a [u8]) -> Self {
        ThriftReader { bytes, values_left: MAX_VALUES, open_groups: Vec::new(), too_deep: false }
    }

    /// Reads a value of this type and shape. Returns its number, or 0 if it is not an integer.
    fn value(&mut self, kind: u8, shape: Option<ThriftType>, depth: usize) -> Option<i64> {
        self.values_left = self.values_left.checked_sub(1)?;
        let depth = depth.checked_sub(1)?;
        let fits = match shape {
            None => true,
            Some(Boolean) => matches!(kind, 1 | 2),
            Some(Children) => kind == 5,
            Some(Of(wanted)) => kind == wanted,
            Some(List(_)) => kind == LIST,
            Some(Struct(_)) => kind == STRUCT,
        };
        match kind {
            _ if !fits => None,
            1 | 2 => Some(0),
            3 => self.take(1).map(|_| 0),
            4 => i16::try_from(self.zig_zag()?).ok().map(i64::from),
            5 => i32::try_from(self.zig_zag()?).ok().map(i64::from),
            6 => self.zig_zag(),
            7 => self.take(8).map(|_| 0),
            8 => {
                let length = self.length()?;
                self.take(length).map(|_| 0)
            }
            LIST => self.list(shape, depth),
            STRUCT => self.fields(shape, depth),
            _ => None,
        }
    }

    fn list(&mut self, shape: Option<ThriftType>, depth: usize) -> Option<i64> {
        let header = *self.take(1)?.first()?;
        let length = match header >> 4 {
            15 => self.length()?,
            length => usize::from(length),
        };
        // Boolean fields take no bytes, and Parquet has no lists of Boolean values.
        if length > 0 && matches!(header & 0x0f, 1 | 2) || length > self.bytes.len() {
            return None;
        }
        let of = if let Some(List(of)) = shape { Some(*of) } else { None };
        (0..length).try_fold(0, |_, _| self.value(header & 0x0f, of, depth).map(|_| 0))
    }

    fn fields(&mut self, shape: Option<ThriftType>, depth: usize) -> Option<i64> {
        let known = if let Some(Struct(known)) = shape { known } else { &[] };
        let (mut last, mut children) = (0_i16, 0);
        loop {
            let header = *self.take(1)?.first()?;
            if header == 0 {
                break;
            }
            // Field numbers must increase.
            last = match header >> 4 {
                0 => i16::try_from(self.zig_zag()?).ok().filter(|number| *number > last)?,
                step => last.checked_add(i16::from(step))?,
            };
            let shape = known.iter().find(|(number, _)| *number == last).map(|(_, shape)| *shape);
            let value = self.value(header & 0x0f, shape, depth)?;
            if matches!(shape, Some(Children)) {
                children = value;
            }
        }
        let is_column = known.iter().any(|(_, shape)| matches!(shape, Children));
        if is_column { self.column(children) } else { Some(0) }
    }

    /// Counts an element of the schema; each element precedes its children.
    fn column(&mut self, children: i64) -> Option<i64> {
        if let Some(left) = self.open_groups.last_mut() {
            *left -= 1;
        }
        self.too_deep = children > 0 && self.open_groups.len() >= MAX_COLUMN_DEPTH;
        if self.too_deep || !(0..=MAX_COLUMNS).contains(&children) {
            return None;
        }
        self.open_groups.push(children);
        while self.open_groups.last() == Some(&0) {
            self.open_groups.pop();
        }
        Some(0)
    }

    fn take(&mut self, length: usize) -> Option<&[u8]> {
        let (taken, rest) = self.bytes.split_at_checked(length)?;
        self.bytes = rest;
        Some(taken)
    }

    /// Reads a length, which is below 2^31 as in the library.
    fn length(&mut self) -> Option<usize> {
        i32::try_from(self.varint()?).ok()?.try_into().ok()
    }

    fn zig_zag(&mut self) -> Option<i64> {
        self.varint().map(signed)
    }

    fn varint(&mut self) -> Option<u64> {
        let (value, length) = varint(self.bytes)?;
        self.take(length)?;
        Some(value)
    }
}

/// Decodes a zigzag number, which has its sign in the lowest bit.
pub(super) fn signed(value: u64) -> i64 {
    (value >> 1) as i64 ^ -((value & 1) as i64)
}

/// Decodes a varint: groups of seven bits, the lowest first. Returns the number and its length in bytes.
pub(super) fn varint(bytes: &[u8]) -> Option<(u64, usize)> {
    let mut value = 0_u64;
    for (place, byte) in bytes.iter().enumerate().take(10) {
        let bits = u64::from(byte & 0x7f);
        // The tenth byte contributes one bit.
        if place == 9 && bits > 1 {
            return None;
        }
        value |= bits << (7 * place);
        if byte & 0x80 == 0 {
            return Some((value, place + 1));
        }
    }
    None
}
