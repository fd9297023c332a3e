//! Values in Thrift's compact protocol, the form of what Parquet files say about themselves.
//!
//! The Parquet library reads them, too; here they are read first, in bounds, and only in the one form
//! in which everybody writes them. The library reads some malformed ones with many steps per byte or
//! with a level of recursion per byte, and some in another way than their types say.
//!
//! Source: Apache Thrift, `doc/specs/thrift-compact-protocol.md`.

/// The most values in one piece, and how deep they may be nested.
const MAX_VALUES: usize = 200_000;
const MAX_DEPTH: usize = 12;

/// A value.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Thrift<'a> {
    /// Yes or no.
    Truth(bool),
    /// A whole number of 8 bits.
    Byte(i8),
    /// A whole number of 16 bits.
    Short(i16),
    /// A whole number of 32 bits.
    Int(i32),
    /// A whole number of 64 bits.
    Long(i64),
    /// A number.
    Double(f64),
    /// Bytes or text.
    Binary(&'a [u8]),
    /// A list.
    List(Vec<Thrift<'a>>),
    /// Fields by ascending number.
    Struct(Vec<(i16, Thrift<'a>)>),
}

impl<'a> Thrift<'a> {
    /// Reads a struct from the beginning of some bytes, and says how many it takes.
    ///
    /// Nothing for what is no such struct, or holds too many values, or too deep ones, or fields in
    /// disorder, or kinds of values that do not occur in Parquet's footers and page headers.
    pub fn read(bytes: &'a [u8]) -> Option<(Thrift<'a>, usize)> {
        Self::read_at_most(bytes, MAX_VALUES)
    }

    /// The same with another bound on the number of values.
    pub fn read_at_most(bytes: &'a [u8], values: usize) -> Option<(Thrift<'a>, usize)> {
        let mut reader = Reader { bytes, position: 0, left: values };
        let value = reader.value(STRUCT, MAX_DEPTH)?;
        Some((value, reader.position))
    }

    /// The field of this number, if this is a struct that has it.
    pub fn field(&self, number: i16) -> Option<&Thrift<'a>> {
        let Thrift::Struct(fields) = self else { return None };
        fields.iter().find(|(other, _)| *other == number).map(|(_, value)| value)
    }

    /// The field of this number as a whole number.
    pub fn integer(&self, number: i16) -> Option<i64> {
        match self.field(number)? {
            Thrift::Byte(value) => Some(i64::from(*value)),
            Thrift::Short(value) => Some(i64::from(*value)),
            Thrift::Int(value) => Some(i64::from(*value)),
            Thrift::Long(value) => Some(*value),
            _ => None,
        }
    }

    /// The field of this number as a list; empty where there is none.
    pub fn items(&self, number: i16) -> &[Thrift<'a>] {
        match self.field(number) {
            Some(Thrift::List(items)) => items,
            _ => &[],
        }
    }
}

const TRUE: u8 = 1;
const FALSE: u8 = 2;
const BYTE: u8 = 3;
const SHORT: u8 = 4;
const INT: u8 = 5;
const LONG: u8 = 6;
const DOUBLE: u8 = 7;
const BINARY: u8 = 8;
const LIST: u8 = 9;
const STRUCT: u8 = 12;

struct Reader<'a> {
    bytes: &'a [u8],
    position: usize,
    /// How many values may still be read.
    left: usize,
}

impl<'a> Reader<'a> {
    fn value(&mut self, kind: u8, depth: usize) -> Option<Thrift<'a>> {
        self.left = self.left.checked_sub(1)?;
        let depth = depth.checked_sub(1)?;
        match kind {
            TRUE => Some(Thrift::Truth(true)),
            FALSE => Some(Thrift::Truth(false)),
            BYTE => Some(Thrift::Byte(i8::from_le_bytes(self.array()?))),
            SHORT => Some(Thrift::Short(self.zig_zag()?.try_into().ok()?)),
            INT => Some(Thrift::Int(self.zig_zag()?.try_into().ok()?)),
            LONG => Some(Thrift::Long(self.zig_zag()?)),
            DOUBLE => Some(Thrift::Double(f64::from_le_bytes(self.array()?))),
            BINARY => {
                let length = self.length()?;
                Some(Thrift::Binary(self.take(length)?))
            }
            LIST => self.list(depth),
            STRUCT => self.fields(depth),
            _ => None,
        }
    }

    fn list(&mut self, depth: usize) -> Option<Thrift<'a>> {
        let [header] = self.array()?;
        let kind = header & 0x0f;
        let length = match header >> 4 {
            15 => self.length()?,
            length => usize::from(length),
        };
        if length == 0 {
            return Some(Thrift::List(Vec::new()));
        }
        // Truths are fields' types and not bytes; in lists they are, and occur nowhere here.
        if matches!(kind, TRUE | FALSE) || length > self.bytes.len() - self.position {
            return None;
        }
        let items: Option<Vec<_>> = (0..length).map(|_| self.value(kind, depth)).collect();
        items.map(Thrift::List)
    }

    fn fields(&mut self, depth: usize) -> Option<Thrift<'a>> {
        let mut fields = Vec::new();
        let mut last = 0_i16;
        loop {
            let [header] = self.array()?;
            if header == 0 {
                return Some(Thrift::Struct(fields));
            }
            // A number that is written out, not as a step from the last one, is a step too large.
            let number = match header >> 4 {
                0 => {
                    let number: i16 = self.zig_zag()?.try_into().ok()?;
                    (i32::from(number) > i32::from(last) + 15).then_some(number)?
                }
                step => last.checked_add(i16::from(step))?,
            };
            fields.push((number, self.value(header & 0x0f, depth)?));
            last = number;
        }
    }

    fn take(&mut self, length: usize) -> Option<&'a [u8]> {
        let end = self.position.checked_add(length)?;
        let taken = self.bytes.get(self.position..end)?;
        self.position = end;
        Some(taken)
    }

    fn array<const N: usize>(&mut self) -> Option<[u8; N]> {
        self.take(N)?.try_into().ok()
    }

    fn length(&mut self) -> Option<usize> {
        // As the library counts: lengths of 2^31 and more are none.
        i32::try_from(self.varint()?).ok()?.try_into().ok()
    }

    fn zig_zag(&mut self) -> Option<i64> {
        let value = self.varint()?;
        Some((value >> 1) as i64 ^ -((value & 1) as i64))
    }

    fn varint(&mut self) -> Option<u64> {
        let mut value = 0_u64;
        for place in 0..10 {
            let [byte] = self.array()?;
            let bits = u64::from(byte & 0x7f);
            // The tenth byte has one bit left.
            if place == 9 && bits > 1 {
                return None;
            }
            value |= bits << (7 * place);
            if byte & 0x80 == 0 {
                return Some(value);
            }
        }
        None
    }
}
