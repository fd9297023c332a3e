//! The key `optimize` of a study file.

use std::borrow::Cow;
use std::fmt;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{Deserializer, SeqAccess, Visitor};
use serde::ser::Serializer;
use serde::{Deserialize, Serialize};

use crate::study::file::values::{Count, Entry, Named};

/// Objectives, limits and effort of `stickslip optimize`.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct OptimizeFile {
    /// Response to minimise, or a list of two; `minimize` and `maximize` have one or two responses
    /// in total, and two give a Pareto front.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub minimize: Option<Names>,
    /// Response to maximise, or a list of two.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub maximize: Option<Names>,
    /// Limits of responses, by response; by default, none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub subject_to: Option<Named<LimitFile>>,
    /// How the values at the points of a sweep are combined; the default is `worst`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub over_points: Option<OverPoints>,
    /// Number of designs in total, 2 to 300; the default is four times `start_designs`, at most
    /// 300.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub designs: Option<Count>,
    /// Number of designs in the initial space-filling sample, 2 to 300; the default is 5 per
    /// variable, at least 10.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub start_designs: Option<Count>,
    /// Number of designs that are recomputed with other random numbers, 1 to 10,000; with two
    /// objectives, the largest size of the Pareto front; the default is 5.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub finalists: Option<Count>,
    /// Number of runs of a finalist, as a multiple of the runs in the search, 1 to 10,000; the
    /// default is 16.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub final_samples: Option<Count>,
    /// Settings of the Sobol' indices of the variables.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sensitivity: Option<SensitivityFile>,
    /// A reference design with a value for each variable; the search begins with it, and the best
    /// design is compared with it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub compare_with: Option<Named<Entry>>,
}

/// Limits of a response: `at_least`, `at_most` or both.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct LimitFile {
    /// Smallest allowed value, in the unit of the response.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub at_least: Option<f64>,
    /// Largest allowed value, in the unit of the response.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub at_most: Option<f64>,
}

/// How the values at the points of a sweep are combined.
#[derive(Clone, Copy, Debug, Default, Deserialize, Eq, JsonSchema, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum OverPoints {
    /// The worst value.
    #[default]
    Worst,
    /// The mean.
    Mean,
}

/// Settings of the Sobol' indices.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct SensitivityFile {
    /// Source of the responses; the default is `surrogates`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub from: Option<SensitivityFrom>,
    /// Number of base samples, 8 to 65,536; with `from: runs`, each base sample takes one design
    /// per variable and two more; the default is 1024 for surrogates and 64 for runs.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub samples: Option<Count>,
}

/// Source of the responses for the Sobol' indices.
#[derive(Clone, Copy, Debug, Default, Deserialize, Eq, JsonSchema, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum SensitivityFrom {
    /// The surrogates at the end of the search; this takes no further runs, and is as accurate as
    /// the surrogates.
    #[default]
    Surrogates,
    /// Runs of new designs.
    Runs,
}

impl SensitivityFrom {
    /// Returns the name in tables.
    pub fn name(self) -> &'static str {
        match self {
            SensitivityFrom::Surrogates => "surrogates",
            SensitivityFrom::Runs => "runs",
        }
    }
}

/// A name, or a list of them.
#[derive(Clone, Debug, PartialEq)]
pub struct Names(pub Vec<String>);

impl Serialize for Names {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match &self.0[..] {
            [name] => serializer.serialize_str(name),
            names => serializer.collect_seq(names),
        }
    }
}

impl<'de> Deserialize<'de> for Names {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct NamesVisitor;
        impl<'de> Visitor<'de> for NamesVisitor {
            type Value = Names;

            fn expecting(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
                out.write_str("the name of a response, or a list of two")
            }

            fn visit_str<E>(self, value: &str) -> Result<Names, E> {
                Ok(Names(vec![value.to_owned()]))
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Names, A::Error> {
                let mut names = Vec::new();
                while let Some(name) = list.next_element()? {
                    names.push(name);
                }
                Ok(Names(names))
            }
        }
        deserializer.deserialize_any(NamesVisitor)
    }
}

impl JsonSchema for Names {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        "Names".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({
            "anyOf": [
                { "type": "string" },
                { "type": "array", "items": { "type": "string" }, "minItems": 1, "maxItems": 2 }
            ]
        })
    }
}
