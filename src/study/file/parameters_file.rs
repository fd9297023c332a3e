//! The kind of model and its parameters in a study file. Their names come from the kinds of models.

use std::borrow::Cow;
use std::fmt;
use std::sync::LazyLock;

use indexmap::IndexMap;
use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::de::{Deserializer, EnumAccess, Error, MapAccess, VariantAccess, Visitor};
use serde::ser::{SerializeMap, Serializer};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use super::model_parts::Balls;
use crate::model::ModelKind;
use crate::study::kinds::{model_kind, model_kinds};

/// The key of the balls among the parameters.
pub(in crate::study) const BALLS: &str = "balls";

/// A kind of model by its name.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KindFile(pub &'static ModelKind);

/// Parameters in SI units.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ParametersFile {
    /// The numbers by name, in the order of the file.
    pub numbers: IndexMap<String, f64>,
    /// The balls.
    pub balls: Option<Balls>,
}

/// The names of all kinds.
static KINDS: LazyLock<Vec<&'static str>> =
    LazyLock::new(|| model_kinds().iter().map(|kind| kind.name).collect());

/// The names of the numbers of any kind of model and `balls`.
static KEYS: LazyLock<Vec<&'static str>> = LazyLock::new(|| {
    let mut keys: Vec<&'static str> = Vec::new();
    for parameter in model_kinds().iter().flat_map(|kind| kind.parameters) {
        let is_key = parameter.is_number() && !parameter.has_own_key();
        if is_key && !keys.contains(&parameter.name) {
            keys.push(parameter.name);
        }
    }
    keys.push(BALLS);
    keys
});

/// Returns the names of the numbers of any kind of model and `balls`.
pub(in crate::study) fn parameter_keys() -> &'static [&'static str] {
    &KEYS
}

impl KindFile {
    /// Returns whether a system file defines the kind.
    pub fn is_of_file(&self) -> bool {
        self.0.source().is_some()
    }
}

impl<'de> Deserialize<'de> for KindFile {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_enum("ModelKind", &KINDS, KindVisitor)
    }
}

struct KindVisitor;

impl<'de> Visitor<'de> for KindVisitor {
    type Value = KindFile;

    fn expecting(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str("a kind of model")
    }

    fn visit_enum<A: EnumAccess<'de>>(self, access: A) -> Result<KindFile, A::Error> {
        let (name, settings): (String, _) = access.variant()?;
        settings.unit_variant()?;
        let kind = model_kind(&name);
        kind.map(KindFile).ok_or_else(|| A::Error::unknown_variant(&name, &KINDS))
    }
}

impl Serialize for KindFile {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.0.name)
    }
}

impl JsonSchema for KindFile {
    fn schema_name() -> Cow<'static, str> {
        "ModelKind".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        let kind = |kind: &&ModelKind| json!({ "type": "string", "const": kind.name, "description": kind.meaning });
        let kinds: Vec<Value> = model_kinds().iter().map(kind).collect();
        schemars::json_schema!({ "description": "Kinds of model.", "oneOf": kinds })
    }
}

impl<'de> Deserialize<'de> for ParametersFile {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        // The names depend on the kind of model, and are checked before.
        deserializer.deserialize_map(ParametersVisitor)
    }
}

struct ParametersVisitor;

impl<'de> Visitor<'de> for ParametersVisitor {
    type Value = ParametersFile;

    fn expecting(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str("keys and values")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<ParametersFile, A::Error> {
        let mut file = ParametersFile::default();
        while let Some(name) = map.next_key::<String>()? {
            match name.as_str() {
                BALLS => file.balls = Some(map.next_value()?),
                _ => _ = file.numbers.insert(name, map.next_value()?),
            }
        }
        Ok(file)
    }
}

/// The balls stand before the values of all balls.
impl Serialize for ParametersFile {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        let (before, after): (Vec<_>, Vec<_>) =
            self.numbers.iter().partition(|(name, _)| is_before_balls(name));
        before.into_iter().try_for_each(|(name, value)| map.serialize_entry(name, value))?;
        self.balls.iter().try_for_each(|balls| map.serialize_entry(BALLS, balls))?;
        after.into_iter().try_for_each(|(name, value)| map.serialize_entry(name, value))?;
        map.end()
    }
}

/// Returns whether a parameter stands before `balls` in the documentation.
pub(in crate::study) fn is_before_balls(name: &str) -> bool {
    let place = |name: &str| KEYS.iter().position(|key| *key == name);
    let first_of_balls = model_kinds()
        .iter()
        .flat_map(|kind| kind.parameters)
        .find(|parameter| parameter.is_of_each_ball());
    first_of_balls.is_some_and(|first| place(name) < place(first.name))
}
