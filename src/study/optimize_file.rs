//! What `stickslip optimize` looks for, as a study file says it.

use std::borrow::Cow;
use std::fmt;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{Deserializer, SeqAccess, Visitor};
use serde::ser::Serializer;
use serde::{Deserialize, Serialize};

use super::file_values::{Count, Entry, Named};

/// What `stickslip optimize` looks for, and how long.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct OptimizeFile {
    /// The response that is to be small, or two of them. One or two objectives together with
    /// `maximize`; of two there is a Pareto front.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub minimize: Option<Names>,
    /// The response that is to be large, or two of them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub maximize: Option<Names>,
    /// Limits to responses, by name.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub subject_to: Option<Named<LimitFile>>,
    /// What counts where the study has a sweep: the worst of its points (the default) or the mean.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub over_points: Option<OverPoints>,
    /// Designs in all; the default is four times `start_designs`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub designs: Option<Count>,
    /// Designs spread over all ranges and choices, before surrogates choose; the default is five per
    /// variable, 10 at least.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub start_designs: Option<Count>,
    /// How many of the best designs are looked at again, with other runs; the default is 5. Of two
    /// objectives: the most designs of the Pareto front.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub finalists: Option<Count>,
    /// How many times as many runs as in the search a design has in the end; the default is 16.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub final_samples: Option<Count>,
    /// How Sobol' indices of the variables are computed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sensitivity: Option<SensitivityFile>,
    /// A design to compare the best one with: a value for each variable. The search begins with it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub compare_with: Option<Named<Entry>>,
}

/// A limit to a response; either end, or both.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct LimitFile {
    /// The smallest allowed value.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub at_least: Option<f64>,
    /// The largest allowed value.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub at_most: Option<f64>,
}

/// How one value is made of those at the points of a sweep.
#[derive(Clone, Copy, Debug, Default, Deserialize, Eq, JsonSchema, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum OverPoints {
    /// The worst one.
    #[default]
    Worst,
    /// Their mean.
    Mean,
}

/// How Sobol' indices are computed.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct SensitivityFile {
    /// Where responses are taken from; the default is `surrogates`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub from: Option<SensitivityFrom>,
    /// Base samples; with `from: runs` so many times the number of variables and 2 designs are
    /// computed. The default is 1024 of surrogates, and 64 of runs.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub samples: Option<Count>,
}

/// Where the responses for Sobol' indices are taken from.
#[derive(Clone, Copy, Debug, Default, Deserialize, Eq, JsonSchema, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum SensitivityFrom {
    /// From the surrogates that the search ends with: at once, and as good as they are.
    #[default]
    Surrogates,
    /// From runs of new designs.
    Runs,
}

impl SensitivityFrom {
    /// The name in tables.
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
