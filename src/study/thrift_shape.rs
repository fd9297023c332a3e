//! What the fields of Parquet's footers and page headers are.
//!
//! The Parquet library reads a field that it knows as what it should be, whatever type is written
//! beside it. Where both agree there is one way to read a file, and what has been checked is what the
//! library reads. Fields that are not listed here the library skips.
//!
//! Source: Apache Parquet, `parquet.thrift` of format 2.12.

use super::thrift::Thrift;

/// What a value must be.
pub(crate) enum Shape {
    /// Yes or no.
    Truth,
    /// A whole number of 8 bits.
    Byte,
    /// A whole number of 16 bits.
    Short,
    /// A whole number of 32 bits, or one of a few choices.
    Int,
    /// A whole number of 64 bits.
    Long,
    /// A number.
    Double,
    /// Bytes or text.
    Binary,
    /// A list of values alike.
    List(&'static Shape),
    /// Fields by their number; others may be there, too.
    Struct(&'static [(i16, Shape)]),
}

use Shape::{Binary, Byte, Double, Int, List, Long, Short, Struct, Truth};

impl Shape {
    /// Whether a value is of this shape.
    pub fn fits(&self, value: &Thrift<'_>) -> bool {
        match (self, value) {
            (Truth, Thrift::Truth(_))
            | (Byte, Thrift::Byte(_))
            | (Short, Thrift::Short(_))
            | (Int, Thrift::Int(_))
            | (Long, Thrift::Long(_))
            | (Double, Thrift::Double(_))
            | (Binary, Thrift::Binary(_)) => true,
            (List(shape), Thrift::List(items)) => items.iter().all(|item| shape.fits(item)),
            (Struct(shapes), Thrift::Struct(fields)) => fields.iter().all(|(number, value)| {
                let shape = shapes.iter().find(|(other, _)| other == number);
                shape.is_none_or(|(_, shape)| shape.fits(value))
            }),
            _ => false,
        }
    }
}

const EMPTY: Shape = Struct(&[]);

/// The footer, `FileMetaData`.
pub(crate) const FOOTER: Shape = Struct(&[
    (1, Int),
    (2, List(&SCHEMA_ELEMENT)),
    (3, Long),
    (4, List(&ROW_GROUP)),
    (5, List(&KEY_VALUE)),
    (6, Binary),
    (7, List(&Struct(&[(1, EMPTY), (2, EMPTY), (3, EMPTY)]))),
    (8, EMPTY),
    (9, Binary),
]);

const KEY_VALUE: Shape = Struct(&[(1, Binary), (2, Binary)]);

const SCHEMA_ELEMENT: Shape = Struct(&[
    (1, Int),
    (2, Int),
    (3, Int),
    (4, Binary),
    (5, Int),
    (6, Int),
    (7, Int),
    (8, Int),
    (9, Int),
    (10, LOGICAL_TYPE),
]);

const TIME: Shape = Struct(&[(1, Truth), (2, Struct(&[(1, EMPTY), (2, EMPTY), (3, EMPTY)]))]);

const LOGICAL_TYPE: Shape = Struct(&[
    (1, EMPTY),
    (2, EMPTY),
    (3, EMPTY),
    (4, EMPTY),
    (5, Struct(&[(1, Int), (2, Int)])),
    (6, EMPTY),
    (7, TIME),
    (8, TIME),
    (10, Struct(&[(1, Byte), (2, Truth)])),
    (11, EMPTY),
    (12, EMPTY),
    (13, EMPTY),
    (14, EMPTY),
    (15, EMPTY),
    (16, Struct(&[(1, Byte)])),
    (17, Struct(&[(1, Binary)])),
    (18, Struct(&[(1, Binary), (2, Int)])),
]);

const ROW_GROUP: Shape = Struct(&[
    (1, List(&COLUMN_CHUNK)),
    (2, Long),
    (3, Long),
    (4, List(&Struct(&[(1, Int), (2, Truth), (3, Truth)]))),
    (5, Long),
    (6, Long),
    (7, Short),
]);

const COLUMN_CHUNK: Shape = Struct(&[
    (1, Binary),
    (2, Long),
    (3, COLUMN),
    (4, Long),
    (5, Int),
    (6, Long),
    (7, Int),
    (8, EMPTY),
    (9, Binary),
]);

const COLUMN: Shape = Struct(&[
    (1, Int),
    (2, List(&Int)),
    (3, List(&Binary)),
    (4, Int),
    (5, Long),
    (6, Long),
    (7, Long),
    (8, List(&KEY_VALUE)),
    (9, Long),
    (10, Long),
    (11, Long),
    (12, STATISTICS),
    (13, List(&Struct(&[(1, Int), (2, Int), (3, Int)]))),
    (14, Long),
    (15, Int),
    (16, Struct(&[(1, Long), (2, List(&Long)), (3, List(&Long))])),
    (17, Struct(&[(1, BOX), (2, List(&Int))])),
]);

const BOX: Shape = Struct(&[
    (1, Double),
    (2, Double),
    (3, Double),
    (4, Double),
    (5, Double),
    (6, Double),
    (7, Double),
    (8, Double),
]);

const STATISTICS: Shape = Struct(&[
    (1, Binary),
    (2, Binary),
    (3, Long),
    (4, Long),
    (5, Binary),
    (6, Binary),
    (7, Truth),
    (8, Truth),
    (9, Long),
]);

/// The header of a page, `PageHeader`.
pub(crate) const PAGE_HEADER: Shape = Struct(&[
    (1, Int),
    (2, Int),
    (3, Int),
    (4, Int),
    (5, Struct(&[(1, Int), (2, Int), (3, Int), (4, Int), (5, STATISTICS)])),
    (6, EMPTY),
    (7, Struct(&[(1, Int), (2, Int), (3, Truth)])),
    (
        8,
        Struct(&[
            (1, Int),
            (2, Int),
            (3, Int),
            (4, Int),
            (5, Int),
            (6, Int),
            (7, Truth),
            (8, STATISTICS),
        ]),
    ),
]);
