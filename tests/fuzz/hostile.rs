//! Small Parquet tables that make the Parquet library (60.1) take gigabytes, overflow the stack or run for hours.
//!
//! The program must refuse each of them in [`MEMORY`] and say why. The comments state what the library alone does.

use std::fs;
use std::path::Path;

use stickslip::study::Study;

/// Memory limit for one file, bytes. The library alone exceeds it with each file but `nesting` and `booleans`.
pub const MEMORY: usize = 128 << 20;

/// A file by name, and a part of the message about it.
type File = (&'static str, fn() -> Vec<u8>, &'static str);

pub const FILES: [File; 12] = [
    ("columns", columns, FOOTER),
    ("nesting", nesting, "wrong type\n  found:   columns within columns"),
    ("hidden_nesting", hidden_nesting, FOOTER),
    ("booleans", booleans, FOOTER),
    ("dictionary_of_numbers", dictionary_of_numbers, "a dictionary of more values"),
    ("dictionary_of_texts", dictionary_of_texts, "a dictionary of more values"),
    ("lengths", lengths, "a page that ends before its last text"),
    ("equal_lengths", equal_lengths, "a page that ends before its last text"),
    ("long_text", long_text, "the text is too long\n  found:   1000000 bytes"),
    ("shared_prefix", shared_prefix, "the text is too long\n  found:   1000000 bytes"),
    ("zeros", zeros, "too large when decompressed\n  found:   a page of 16777217 bytes"),
    ("many_zeros", many_zeros, "too large when decompressed\n  found:   larger pages"),
];

const FOOTER: &str = "not a readable Parquet file\n  found:   a footer";

/// Returns the message about a Parquet file as a sweep, or an empty text if it is accepted.
pub fn message(folder: &Path, file: &[u8]) -> String {
    fs::write(folder.join("table.parquet"), file).expect("the folder takes files");
    let text = "schema: 1\nname: a\nseed: 5\nmodel: {kind: ball_balancer}\n\
                initial_conditions: {design: {monte_carlo: {samples: 1}}}\n\
                sweep: [{table: table.parquet}]\n";
    let read = Study::parse(&folder.join("study.yaml"), text.to_owned());
    read.err().map_or_else(String::new, |error| error.to_string())
}

/// A group that announces 2^31 - 1 columns: 31 bytes for which the library allocates 16 GiB.
fn columns() -> Vec<u8> {
    with_footer(b"PAR1", &footer(&[&[0x1c, 0x48, 1, b'a'][..], &int(1, MOST), &[0]].concat(), &[]))
}

/// Columns in columns, 100,000 levels deep: the library overflows the stack, which ends the process.
fn nesting() -> Vec<u8> {
    let column = [0x48, 1, b'a', 0x15, 2, 0];
    let schema = [&[0xfc][..], &varint(100_000), &column.repeat(100_000)].concat();
    with_footer(b"PAR1", &footer(&schema, &[]))
}

/// Columns nested 100,000 deep, hidden in a field that the footer marks as a text. The library reads this field as a number.
fn hidden_nesting() -> Vec<u8> {
    let column = [0x48, 1, b'a', 0x15, 2, 0];
    let hidden = [&[0x28, 1, b'a', 0x15, 2, 0][..], &column.repeat(100_000)].concat();
    let first = [&[0x28][..], &varint(hidden.len() as u64), &hidden, &[0]].concat();
    let schema = [&[0xfc][..], &varint(100_000), &first, &[0].repeat(99_999)].concat();
    with_footer(b"PAR1", &footer(&schema, &[]))
}

/// A thousand lists that announce 2^31 - 1 Boolean values each, which take no bytes: the library skips them one by one, in
/// eight seconds per list.
fn booleans() -> Vec<u8> {
    let field = [&[0x19, 0xf1][..], &varint(MOST as u64)].concat();
    let unknown = [&[0x09, 0xc8, 1][..], &field[1..], &field.repeat(1000)].concat();
    with_footer(b"PAR1", &footer(&[0x1c, 0x48, 1, b'a', 0x15, 0, 0], &unknown))
}

/// A dictionary that announces 2^31 - 1 numbers: the library fills 16 GiB.
fn dictionary_of_numbers() -> Vec<u8> {
    let dictionary = Some((1.0_f64.to_le_bytes().to_vec(), MOST));
    Table { dictionary, encoding: DICTIONARY, ..Table::of_numbers(vec![1, 2, 0]) }.file()
}

/// A dictionary that announces 2^31 - 1 texts: the library allocates 8 GiB.
fn dictionary_of_texts() -> Vec<u8> {
    let dictionary = Some((text(1), MOST));
    Table { dictionary, encoding: DICTIONARY, ..Table::of_texts(vec![1, 2, 0]) }.file()
}

/// A page that announces the lengths of 2^33 texts: the allocation of 32 GiB fails, which ends the process.
fn lengths() -> Vec<u8> {
    let body = [varint(128), varint(4), varint(1 << 33), zigzag(1), vec![0; 64]].concat();
    Table { encoding: DELTA_LENGTHS, ..Table::of_texts(body) }.file()
}

/// A page with the lengths of 2^30 texts in one block without bits: the library fills 4 GiB.
fn equal_lengths() -> Vec<u8> {
    let block = [varint(1 << 32), varint(1), varint(1 << 30), zigzag(0), zigzag(0), vec![0; 64]];
    Table { encoding: DELTA_LENGTHS, ..Table::of_texts(block.concat()) }.file()
}

const ROWS: usize = 1024;
const LONG: usize = 1_000_000;

/// A dictionary with one text of 1 MB, to which 1024 rows refer: the library copies it for each of them, up to 4 GiB for a
/// text of 16 MB.
fn long_text() -> Vec<u8> {
    let indices = [vec![1], varint((ROWS as u64) << 1), vec![0]].concat();
    let dictionary = Some((text(LONG), 1));
    Table { dictionary, encoding: DICTIONARY, rows: ROWS as i64, ..Table::of_texts(indices) }.file()
}

/// A text of 1 MB that 1023 others repeat as their prefix.
fn shared_prefix() -> Vec<u8> {
    let long = |first: usize, others: usize| {
        differences(&[vec![first as i32], vec![others as i32; ROWS - 1]].concat())
    };
    let body = [long(0, LONG), long(LONG, 0), vec![b'x'; LONG]].concat();
    Table { encoding: DELTA_TEXTS, rows: ROWS as i64, ..Table::of_texts(body) }.file()
}

/// A page of 400 kB in Zstandard, which decompresses to 13 GB. The library decompresses Zstandard up to the size that the page
/// announces, at most 2 GiB, and gzip without a limit: it allocates 2 GiB for a page of 1 MB.
fn zeros() -> Vec<u8> {
    Table { compression: ZSTANDARD, ..Table::of_numbers(zstandard(100_000)) }.file()
}

/// Five pages of 16 MiB with one number each.
fn many_zeros() -> Vec<u8> {
    Table { compression: ZSTANDARD, pages: 5, ..Table::of_numbers(zstandard(128)) }.file()
}

/// Returns zeros in Zstandard: each block of four bytes expands to 128 kB.
fn zstandard(blocks: usize) -> Vec<u8> {
    let block = |last: u32| {
        let header = (128 << 10) << 3 | 1 << 1 | last;
        [&header.to_le_bytes()[..3], &[0]].concat()
    };
    let frame = [0x28, 0xb5, 0x2f, 0xfd, 0, 0x58];
    [&frame[..], &block(0).repeat(blocks - 1), &block(1)].concat()
}

const MOST: i64 = i32::MAX as i64;
// Numbers of physical types, encodings and compressions in `parquet.thrift`.
const DOUBLE: i64 = 5;
const BYTES: i64 = 6;
const PLAIN: i64 = 0;
const DELTA_LENGTHS: i64 = 6;
const DELTA_TEXTS: i64 = 7;
const DICTIONARY: i64 = 8;
const ZSTANDARD: i64 = 6;

struct Table {
    column: &'static str,
    kind: i64,
    compression: i64,
    encoding: i64,
    /// The number of rows in a page.
    rows: i64,
    /// The bytes of a dictionary page and the number of values that it announces.
    dictionary: Option<(Vec<u8>, i64)>,
    /// A page, and how often it occurs.
    page: Vec<u8>,
    pages: usize,
}

impl Table {
    fn of_numbers(page: Vec<u8>) -> Table {
        let (column, kind) = ("speed_rad_s", DOUBLE);
        let (rows, dictionary, pages) = (1, None, 1);
        Table { column, kind, compression: 0, encoding: PLAIN, rows, dictionary, page, pages }
    }

    fn of_texts(page: Vec<u8>) -> Table {
        Table { column: "normal_force", kind: BYTES, ..Table::of_numbers(page) }
    }

    fn file(self) -> Vec<u8> {
        let Table { kind, encoding, rows, .. } = self;
        let page = |page_type, bytes: &[u8], header: &[Vec<u8>]| {
            let length = bytes.len() as i64;
            [int(1, page_type), int(1, length), int(1, length), header.concat(), bytes.to_vec()]
                .concat()
        };
        let name = [&[0x18, self.column.len() as u8][..], self.column.as_bytes()].concat();
        let mut pages = b"PAR1".to_vec();
        let mut start_of_dictionary = Vec::new();
        if let Some((bytes, values)) = &self.dictionary {
            start_of_dictionary = long(2, 4);
            let header = [vec![0x4c], int(1, *values), int(1, PLAIN), vec![0, 0]];
            pages.extend(page(2, bytes, &header));
        }
        let start = pages.len() as i64;
        let levels = [int(1, 3), int(1, 3)].concat();
        let header = [vec![0x2c], int(1, rows), int(1, encoding), levels, vec![0, 0]];
        pages.extend(page(0, &self.page, &header).repeat(self.pages));
        let (size, rows) = (pages.len() as i64 - 4, rows * self.pages as i64);

        let root = [0x2c, 0x48, 1, b'a', 0x15, 2, 0].to_vec();
        // Field 6 marks texts.
        let text = if kind == BYTES { int(2, 0) } else { Vec::new() };
        let schema = [root, int(1, kind), int(2, 0), name.clone(), text, vec![0]].concat();
        let column = [
            [int(1, kind), vec![0x19, 0x15], zigzag(encoding), vec![0x19], name].concat(),
            [int(1, self.compression), long(1, rows), long(1, size), long(1, size)].concat(),
            [long(2, start), start_of_dictionary, vec![0]].concat(),
        ];
        let chunk = [long(2, 4), vec![0x1c], column.concat(), vec![0]].concat();
        let group = [vec![0x19, 0x1c], chunk, long(1, size), long(1, rows), vec![0]].concat();
        let footer = [int(1, 1), vec![0x19], schema, long(1, rows), vec![0x19, 0x1c], group];
        with_footer(&pages, &[footer.concat(), vec![0]].concat())
    }
}

/// Returns a footer with this schema, no rows, and more fields.
fn footer(schema: &[u8], more: &[u8]) -> Vec<u8> {
    [&int(1, 1), &[0x19][..], schema, &[0x16, 0, 0x19, 0x0c], more, &[0]].concat()
}

/// Returns a file that consists of these pages and this footer.
fn with_footer(pages: &[u8], footer: &[u8]) -> Vec<u8> {
    [pages, footer, &(footer.len() as u32).to_le_bytes(), b"PAR1"].concat()
}

/// Returns a text of this length in the plain encoding.
fn text(length: usize) -> Vec<u8> {
    [&(length as u32).to_le_bytes()[..], &b"x".repeat(length)].concat()
}

/// Returns numbers in the encoding of differences, each of 32 bits.
fn differences(numbers: &[i32]) -> Vec<u8> {
    let head = [varint(128), varint(4), varint(numbers.len() as u64), zigzag(numbers[0].into())];
    let steps: Vec<i32> = numbers.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let block = |steps: &[i32]| {
        let padded = steps.iter().chain(&[0; 128]).take(128);
        let packed: Vec<u8> = padded.flat_map(|step| step.to_le_bytes()).collect();
        [vec![0], vec![32; 4], packed].concat()
    };
    [head.concat(), steps.chunks(128).flat_map(block).collect()].concat()
}

/// Integer fields of 32 and 64 bits in Thrift's compact protocol, `step` fields after the previous one.
fn int(step: u8, value: i64) -> Vec<u8> {
    [vec![step << 4 | 5], zigzag(value)].concat()
}

fn long(step: u8, value: i64) -> Vec<u8> {
    [vec![step << 4 | 6], zigzag(value)].concat()
}

fn zigzag(value: i64) -> Vec<u8> {
    varint((value << 1 ^ value >> 63) as u64)
}

fn varint(mut value: u64) -> Vec<u8> {
    let mut bytes = Vec::new();
    while value > 0x7f {
        bytes.push(value as u8 | 0x80);
        value >>= 7;
    }
    bytes.push(value as u8);
    bytes
}
