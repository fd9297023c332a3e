//! The contact between balls in a study file: its law, or `none`.

use std::fmt;

use schemars::JsonSchema;
use serde::de::value::MapAccessDeserializer;
use serde::de::{Deserializer, Error, MapAccess, Unexpected, Visitor};
use serde::{Deserialize, Serialize};

/// The law of contact between balls.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct ContactLawFile {
    /// Speed of separation over speed of approach of rolling balls, dimensionless, 0 to 1; default 0.36, that of steel
    /// balls.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0, max = 1))]
    pub restitution: Option<f64>,
    /// The coefficient of restitution of the balls' material, dimensionless, 0 to 1, instead of `restitution`. Rolling balls
    /// keep (e - 0.4)/1.4 of it.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0, max = 1))]
    pub material_restitution: Option<f64>,
    /// Coefficient of friction between two balls, dimensionless, at least 0; default 0.1.
    #[schemars(extend("minimum" = 0))]
    pub friction_coefficient: Option<f64>,
}

/// The word for balls that pass through each other.
#[derive(Clone, Copy, Debug, JsonSchema, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum NoContact {
    /// Balls pass through each other.
    None,
}

/// The contact between balls, or `none`.
#[derive(Clone, Debug, JsonSchema, PartialEq, Serialize)]
#[serde(untagged)]
pub enum ContactFile {
    /// No contact.
    Without(NoContact),
    /// The law of contact.
    Law(ContactLawFile),
}

impl<'de> Deserialize<'de> for ContactFile {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct ContactVisitor;
        impl<'de> Visitor<'de> for ContactVisitor {
            type Value = ContactFile;

            fn expecting(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
                out.write_str("none, or {restitution: 0.36, friction_coefficient: 0.1}")
            }

            fn visit_str<E: Error>(self, value: &str) -> Result<ContactFile, E> {
                match value {
                    "none" => Ok(ContactFile::Without(NoContact::None)),
                    other => Err(E::invalid_value(Unexpected::Str(other), &self)),
                }
            }

            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<ContactFile, A::Error> {
                let law = ContactLawFile::deserialize(MapAccessDeserializer::new(map))?;
                Ok(ContactFile::Law(law))
            }
        }
        deserializer.deserialize_any(ContactVisitor)
    }
}
