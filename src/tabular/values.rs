//! Converts Arrow columns of any width and encoding to values of six kinds.

use arrow_array::cast::AsArray;
use arrow_array::types::{
    ArrowPrimitiveType, Decimal32Type, Decimal64Type, Decimal128Type, Decimal256Type, Float16Type,
    Float32Type, Float64Type, Int8Type, Int16Type, Int32Type, Int64Type, UInt8Type, UInt16Type,
    UInt32Type, UInt64Type,
};
use arrow_array::{Array, ArrayRef};
use arrow_schema::DataType;
use arrow_select::take::take;
use serde_json::{Value, json};

/// Declares the kinds of values: the name, the type and the meaning, and the name in messages.
macro_rules! kinds {
    ($($name:ident($value:ty): $meaning:literal, $words:literal;)*) => {
        /// The kind of a column's values.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum Kind {
            $(#[doc = $meaning] $name,)*
        }

        /// The values of a column; a missing value is `None`.
        #[derive(Clone, Debug, PartialEq)]
        pub enum ColumnValues {
            $(#[doc = $meaning] $name(Vec<Option<$value>>),)*
        }

        impl Kind {
            /// Returns the name of the kind for messages.
            pub fn name(self) -> &'static str {
                match self {
                    $(Kind::$name => $words,)*
                }
            }
        }

        impl ColumnValues {
            /// Returns the value in a row as JSON; null if it is missing.
            pub(crate) fn json(&self, row: usize) -> Value {
                match self {
                    $(ColumnValues::$name(values) => json!(values.get(row)),)*
                }
            }
        }
    };
}

kinds! {
    Number(f64): "Numbers.", "numbers";
    Count(u64): "Whole numbers from 0, such as counts.", "whole numbers from 0";
    Integer(i64): "Signed whole numbers.", "whole numbers with a sign";
    Boolean(bool): "Boolean values.", "Boolean values";
    Text(String): "Text, such as labels.", "text";
    Numbers(Vec<f64>): "Lists of numbers.", "lists of numbers";
}

impl Kind {
    /// Returns the kind of a column of this Arrow type, or `None` if the type is not supported.
    pub(crate) fn of(kind: &DataType) -> Option<Kind> {
        Some(match kind {
            kind if kind.is_signed_integer() => Kind::Integer,
            kind if kind.is_unsigned_integer() => Kind::Count,
            kind if kind.is_floating() || kind.is_decimal() => Kind::Number,
            DataType::Boolean => Kind::Boolean,
            DataType::Utf8 | DataType::LargeUtf8 | DataType::Utf8View => Kind::Text,
            DataType::Dictionary(_, values) => Kind::of(values)?,
            DataType::List(values) if *values.data_type() == DataType::Float64 => Kind::Numbers,
            _ => return None,
        })
    }
}

impl ColumnValues {
    /// Returns the values of a column, or `None` if its type is not supported.
    pub(crate) fn of(column: &ArrayRef) -> Option<ColumnValues> {
        fn all<T: ArrowPrimitiveType, V>(
            column: &ArrayRef,
            value: impl Fn(T::Native) -> V,
        ) -> Option<Vec<Option<V>>> {
            let values = column.as_primitive_opt::<T>()?.iter();
            Some(values.map(|number| number.map(&value)).collect())
        }
        /// Converts decimal numbers to the nearest floating-point numbers, as parsing their digits does.
        fn decimal<T: ArrowPrimitiveType>(column: &ArrayRef, scale: i8) -> Option<ColumnValues>
        where
            T::Native: ToString,
        {
            let digits = |value: T::Native| format!("{}e{}", value.to_string(), -i16::from(scale));
            let number = |value| digits(value).parse().unwrap_or(f64::NAN);
            Some(ColumnValues::Number(all::<T, f64>(column, number)?))
        }
        fn texts<'a>(all: impl Iterator<Item = Option<&'a str>>) -> ColumnValues {
            ColumnValues::Text(all.map(|text| text.map(str::to_owned)).collect())
        }
        Some(match column.data_type() {
            DataType::Int8 => ColumnValues::Integer(all::<Int8Type, _>(column, i64::from)?),
            DataType::Int16 => ColumnValues::Integer(all::<Int16Type, _>(column, i64::from)?),
            DataType::Int32 => ColumnValues::Integer(all::<Int32Type, _>(column, i64::from)?),
            DataType::Int64 => ColumnValues::Integer(all::<Int64Type, _>(column, |number| number)?),
            DataType::UInt8 => ColumnValues::Count(all::<UInt8Type, _>(column, u64::from)?),
            DataType::UInt16 => ColumnValues::Count(all::<UInt16Type, _>(column, u64::from)?),
            DataType::UInt32 => ColumnValues::Count(all::<UInt32Type, _>(column, u64::from)?),
            DataType::UInt64 => ColumnValues::Count(all::<UInt64Type, _>(column, |number| number)?),
            DataType::Float16 => ColumnValues::Number(all::<Float16Type, _>(column, f64::from)?),
            DataType::Float32 => ColumnValues::Number(all::<Float32Type, _>(column, f64::from)?),
            DataType::Float64 => {
                ColumnValues::Number(all::<Float64Type, _>(column, |number| number)?)
            }
            DataType::Decimal32(_, scale) => decimal::<Decimal32Type>(column, *scale)?,
            DataType::Decimal64(_, scale) => decimal::<Decimal64Type>(column, *scale)?,
            DataType::Decimal128(_, scale) => decimal::<Decimal128Type>(column, *scale)?,
            DataType::Decimal256(_, scale) => decimal::<Decimal256Type>(column, *scale)?,
            DataType::Boolean => ColumnValues::Boolean(column.as_boolean_opt()?.iter().collect()),
            DataType::Utf8 => texts(column.as_string_opt::<i32>()?.iter()),
            DataType::LargeUtf8 => texts(column.as_string_opt::<i64>()?.iter()),
            DataType::Utf8View => texts(column.as_string_view_opt()?.iter()),
            DataType::Dictionary(..) => {
                let coded = column.as_any_dictionary_opt()?;
                ColumnValues::of(&take(coded.values(), coded.keys(), None).ok()?)?
            }
            DataType::List(_) => {
                let lists = column.as_list_opt::<i32>()?.iter().map(|list| {
                    // A list with a missing value counts as missing.
                    list?.as_primitive_opt::<Float64Type>()?.iter().collect::<Option<Vec<f64>>>()
                });
                ColumnValues::Numbers(lists.collect())
            }
            _ => return None,
        })
    }
}
