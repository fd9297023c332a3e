//! The friction law of a study file: its name, or its name with the values of its parameters. The names come from the
//! laws of the model.

use std::borrow::Cow;
use std::fmt;
use std::sync::LazyLock;

use indexmap::IndexMap;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::value::MapAccessDeserializer;
use serde::de::{Deserializer, EnumAccess, Error, MapAccess, VariantAccess, Visitor};
use serde::ser::{SerializeMap, Serializer};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value, json};

use crate::model::{FRICTION_LAWS, Law, LawDimension, LawParameter, Lowest, SlidingSpeed};

/// A friction law with the values that the file gives, by key.
#[derive(Clone, Debug, PartialEq)]
pub struct FrictionFile {
    /// The law.
    pub law: &'static dyn Law,
    /// The values, by name.
    pub values: IndexMap<String, f64>,
}

/// The names of all laws.
static NAMES: LazyLock<Vec<&'static str>> =
    LazyLock::new(|| FRICTION_LAWS.iter().map(|law| law.name()).collect());

/// The keys of each law: for a sliding speed, one for balls and one for blocks.
static KEYS: LazyLock<Vec<Vec<&'static str>>> =
    LazyLock::new(|| FRICTION_LAWS.iter().map(|law| keys(*law)).collect());

fn keys(law: &dyn Law) -> Vec<&'static str> {
    let mut keys: Vec<_> = law.parameters().iter().flat_map(LawParameter::names).collect();
    keys.dedup();
    keys
}

/// Returns an example of the settings of a friction law, if this is the name of a law with settings.
pub(in crate::study) fn example_of_friction(name: &str) -> Option<String> {
    let law = FRICTION_LAWS.into_iter().find(|law| law.name() == name)?;
    let parameters = law.parameters();
    let example = |speed: SlidingSpeed| {
        let values: Vec<String> = parameters
            .iter()
            .map(|parameter| format!("{}: {}", parameter.name(speed), number(parameter, speed)))
            .collect();
        format!("{{{name}: {{{}}}}}", values.join(", "))
    };
    let has_speed =
        |parameter: &LawParameter| matches!(parameter.dimension, LawDimension::SlidingSpeed { .. });
    match parameters {
        [] => None,
        _ if parameters.iter().any(has_speed) => Some(format!(
            "{} for a block, {} for balls",
            example(SlidingSpeed::MS),
            example(SlidingSpeed::RadS)
        )),
        _ => Some(example(SlidingSpeed::RadS)),
    }
}

fn number(parameter: &LawParameter, speed: SlidingSpeed) -> String {
    let value = parameter.examples[usize::from(speed == SlidingSpeed::MS)];
    if value < 0.01 { format!("{value:.1e}") } else { format!("{value:?}") }
}

impl<'de> Deserialize<'de> for FrictionFile {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_enum("FrictionFile", &NAMES, LawVisitor)
    }
}

struct LawVisitor;

impl<'de> Visitor<'de> for LawVisitor {
    type Value = FrictionFile;

    fn expecting(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str("a friction law")
    }

    fn visit_enum<A: EnumAccess<'de>>(self, access: A) -> Result<FrictionFile, A::Error> {
        let (name, settings): (String, _) = access.variant()?;
        let index = NAMES.iter().position(|law| *law == name);
        let index = index.ok_or_else(|| A::Error::unknown_variant(&name, &NAMES))?;
        let law = FRICTION_LAWS[index];
        let values = match law.parameters() {
            [] => settings.unit_variant().map(|()| IndexMap::new())?,
            _ => settings.struct_variant(&KEYS[index], LawSettings(index))?,
        };
        Ok(FrictionFile { law, values })
    }
}

/// The values of the law at this place.
struct LawSettings(usize);

impl<'de> Visitor<'de> for LawSettings {
    type Value = IndexMap<String, f64>;

    fn expecting(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "{}", KEYS[self.0].join(", "))
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Self::Value, A::Error> {
        let values = IndexMap::deserialize(MapAccessDeserializer::new(map))?;
        // A missing speed is found when the unit of the model is known.
        for parameter in FRICTION_LAWS[self.0].parameters() {
            let [ball, block] = parameter.names();
            if ball == block && !values.contains_key(ball) {
                return Err(A::Error::missing_field(ball));
            }
        }
        Ok(values)
    }
}

impl Serialize for FrictionFile {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        if self.values.is_empty() {
            return serializer.serialize_str(self.law.name());
        }
        let mut map = serializer.serialize_map(Some(1))?;
        map.serialize_entry(self.law.name(), &self.values)?;
        map.end()
    }
}

impl JsonSchema for FrictionFile {
    fn schema_name() -> Cow<'static, str> {
        "FrictionFile".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        let forms: Vec<Value> = FRICTION_LAWS.iter().map(|law| form(*law)).collect();
        json_schema!({
            "description": "Friction laws; the sliding speed of a ball is relative to the ring, in rad/s; that of a \
                            block is in m/s.",
            "oneOf": forms,
        })
    }
}

/// Returns the schema of a law.
fn form(law: &dyn Law) -> Value {
    let (name, meaning) = (law.name(), law.meaning());
    if law.parameters().is_empty() {
        return json!({ "type": "string", "const": name, "description": meaning });
    }
    let (mut properties, mut required, mut speeds) = (Map::new(), Vec::new(), Vec::new());
    for parameter in law.parameters() {
        let [ball, block] = parameter.names();
        if ball == block {
            required.push(ball);
            properties.insert(ball.to_owned(), number_schema(parameter, SlidingSpeed::RadS, ""));
            continue;
        }
        for (speed, of) in [(SlidingSpeed::RadS, " of a ball"), (SlidingSpeed::MS, " of a block")] {
            let schema = number_schema(parameter, speed, of);
            properties.insert(parameter.name(speed).to_owned(), schema);
        }
        let alternatives = [ball, block, parameter.name].map(|name| json!({ "required": [name] }));
        speeds.push(json!({ "oneOf": alternatives }));
    }
    let mut settings = json!({
        "type": "object", "properties": properties, "required": required, "additionalProperties": false,
    });
    if !speeds.is_empty() {
        settings["allOf"] = speeds.into();
    }
    json!({
        "type": "object",
        "properties": { name: settings },
        "required": [name],
        "additionalProperties": false,
        "description": meaning,
    })
}

fn number_schema(parameter: &LawParameter, speed: SlidingSpeed, of: &str) -> Value {
    let lowest = match parameter.lowest {
        Lowest::Zero => "at least 0",
        Lowest::AboveZero => "above 0",
        Lowest::FrictionCoefficient => "at least `friction_coefficient`",
    };
    let unit = match parameter.unit(speed) {
        "1" => "dimensionless",
        unit => unit,
    };
    let note = if parameter.note.is_empty() { "" } else { "; " };
    let meaning = match of {
        "" => parameter.meaning.to_owned(),
        of => parameter.meaning.replacen("speed", &format!("sliding speed{of}"), 1),
    };
    let bound = if parameter.lowest == Lowest::AboveZero { "exclusiveMinimum" } else { "minimum" };
    json!({
        "type": "number",
        bound: 0,
        "description": format!("{}, {unit}, {lowest}{note}{}.", capital(&meaning), parameter.note),
    })
}

/// Returns the text with a capital letter.
pub(super) fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}
