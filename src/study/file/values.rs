//! Small values of a study file that have more than one notation, such as a number or a list, and how these are read.

use std::fmt;

use schemars::JsonSchema;
use serde::de::value::SeqAccessDeserializer;
use serde::de::{Deserializer, Error, SeqAccess, Visitor};
use serde::{Deserialize, Serialize};

/// A number, or a length with its unit.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Serialize)]
pub struct NumberOrLength(pub f64);

/// The largest number of runs, samples or points of a study.
pub(crate) const MAX_COUNT: u64 = 1_000_000_000_000_000;

/// An integer from 1 to 10^15; `1e6` is also accepted.
#[derive(Clone, Copy, Debug, JsonSchema, PartialEq, Eq, Serialize)]
#[schemars(inline)]
pub struct Count(#[schemars(range(min = 1, max = MAX_COUNT))] pub u64);

impl Count {
    /// Returns a number that is given, or the default.
    pub fn or(given: Option<Count>, default: u64) -> u64 {
        given.map_or(default, |Count(number)| number)
    }
}

impl fmt::Display for Count {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(out)
    }
}

notations! {
    Count: "a whole number from 1 to 1e15",
    number => |number: f64| {
        let is_count = number.fract() == 0.0 && (1.0..=MAX_COUNT as f64).contains(&number);
        is_count.then_some(Count(number as u64))
    },
}

/// A range `[low, high]`.
#[derive(Clone, Copy, Debug, JsonSchema, PartialEq, Serialize)]
pub struct Range(pub [f64; 2]);

impl<'de> Deserialize<'de> for Range {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct RangeVisitor;
        impl<'de> Visitor<'de> for RangeVisitor {
            type Value = Range;

            fn expecting(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
                out.write_str("two numbers [low, high]")
            }

            fn visit_seq<A: SeqAccess<'de>>(self, list: A) -> Result<Range, A::Error> {
                let ends = Vec::<f64>::deserialize(SeqAccessDeserializer::new(list))?;
                match ends[..] {
                    [low, high] => Ok(Range([low, high])),
                    _ => Err(A::Error::invalid_length(ends.len(), &self)),
                }
            }
        }
        deserializer.deserialize_any(RangeVisitor)
    }
}

/// A number, or a word such as `newton`.
#[derive(Clone, Debug, JsonSchema, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Entry {
    /// A number in the unit of its parameter.
    Number(f64),
    /// One of a parameter's words.
    Text(String),
}

notations! {
    Entry: "a number",
    number => |number| Some(Entry::Number(number)),
    text => |text: &str| Some(Entry::Text(text.to_owned())),
}

/// Path of a .csv or .parquet file relative to the study file, or an inline table; a file outside
/// the directory of the study file requires `--tables`.
#[derive(Clone, Debug, JsonSchema, PartialEq, Serialize)]
#[serde(untagged)]
#[schemars(rename = "Table")]
pub enum TableKey {
    /// A CSV file with one header line, or a Parquet file; the file extension decides.
    File(String),
    /// An inline table.
    Inline(InlineTable),
}

/// A table written into the study file.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct InlineTable {
    /// Names of the columns.
    pub columns: Vec<String>,
    /// Rows, each with one value per column.
    #[schemars(extend("minItems" = 1))]
    pub rows: Vec<Vec<Entry>>,
}

impl TableKey {
    /// Returns an inline table of numbers.
    pub fn of_numbers<'a>(columns: Vec<String>, rows: impl Iterator<Item = &'a [f64]>) -> Self {
        let row = |row: &[f64]| row.iter().copied().map(Entry::Number).collect();
        TableKey::Inline(InlineTable { columns, rows: rows.map(row).collect() })
    }
}

notations! {
    TableKey: "the path of a CSV or Parquet file, or {columns: [...], rows: [[...], ...]}",
    text => |path: &str| Some(TableKey::File(path.to_owned())),
    map(InlineTable) => TableKey::Inline,
}

/// Implements `Deserialize` for a type: what is expected, in words, and for each notation what it becomes; `None` refuses
/// the value. Numbers are `f64`, natural numbers `u64`, texts `&str`; a list or a map names the type of its content.
macro_rules! notations {
    ($type:ty: $expected:literal, $($notation:ident $(($content:ty))? => $become:expr),+ $(,)?) => {
        impl<'de> serde::Deserialize<'de> for $type {
            fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                struct ByNotation;
                impl<'de> serde::de::Visitor<'de> for ByNotation {
                    type Value = $type;

                    fn expecting(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                        out.write_str($expected)
                    }

                    $(notations!(@$notation $(($content))? $become);)+
                }
                deserializer.deserialize_any(ByNotation)
            }
        }
    };
    (@number $become:expr) => {
        fn visit_u64<E: serde::de::Error>(self, number: u64) -> Result<Self::Value, E> {
            self.visit_f64(number as f64)
        }

        fn visit_f64<E: serde::de::Error>(self, number: f64) -> Result<Self::Value, E> {
            let found = serde::de::Unexpected::Float(number);
            ($become)(number).ok_or_else(|| E::invalid_value(found, &self))
        }
    };
    (@natural $become:expr) => {
        fn visit_u64<E: serde::de::Error>(self, number: u64) -> Result<Self::Value, E> {
            let found = serde::de::Unexpected::Unsigned(number);
            ($become)(number).ok_or_else(|| E::invalid_value(found, &self))
        }
    };
    (@text $become:expr) => {
        fn visit_str<E: serde::de::Error>(self, text: &str) -> Result<Self::Value, E> {
            let found = serde::de::Unexpected::Str(text);
            ($become)(text).ok_or_else(|| E::invalid_value(found, &self))
        }
    };
    (@list ($content:ty) $become:expr) => {
        fn visit_seq<A: serde::de::SeqAccess<'de>>(self, list: A) -> Result<Self::Value, A::Error> {
            let list = serde::de::value::SeqAccessDeserializer::new(list);
            <$content as serde::Deserialize>::deserialize(list).map($become)
        }
    };
    (@map ($content:ty) $become:expr) => {
        fn visit_map<A: serde::de::MapAccess<'de>>(self, map: A) -> Result<Self::Value, A::Error> {
            let map = serde::de::value::MapAccessDeserializer::new(map);
            <$content as serde::Deserialize>::deserialize(map).map($become)
        }
    };
}

pub(super) use notations;
