//! The balls of a study file: how many, or one entry for each.

use std::borrow::Cow;
use std::fmt;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{Deserializer, SeqAccess, Visitor};
use serde::{Deserialize, Serialize};

/// One ball; values that are absent are those of all balls.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct BallFile {
    /// Mass, kg, above 0; the default is `ball_mass_kg`.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub mass_kg: Option<f64>,
    /// Diameter, m, above 0; the default is `ball_diameter_m`.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub diameter_m: Option<f64>,
    /// Coefficient of friction between ball and ring, dimensionless, at least 0; the default is
    /// `friction_coefficient`.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("minimum" = 0))]
    pub friction_coefficient: Option<f64>,
}

/// The number of balls, or the individual balls.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Balls {
    /// The number of balls, all identical.
    Number(u64),
    /// One entry per ball.
    Each(Vec<BallFile>),
}

impl<'de> Deserialize<'de> for Balls {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct BallsVisitor;
        impl<'de> Visitor<'de> for BallsVisitor {
            type Value = Balls;

            fn expecting(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
                out.write_str("a number of balls from 1 to 8, or a list with one entry per ball")
            }

            fn visit_u64<E>(self, value: u64) -> Result<Balls, E> {
                Ok(Balls::Number(value))
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Balls, A::Error> {
                let mut balls = Vec::new();
                while let Some(ball) = list.next_element()? {
                    balls.push(ball);
                }
                Ok(Balls::Each(balls))
            }
        }
        deserializer.deserialize_any(BallsVisitor)
    }
}

impl JsonSchema for Balls {
    fn schema_name() -> Cow<'static, str> {
        "Balls".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let ball = generator.subschema_for::<BallFile>();
        json_schema!({
            "description": "Number of balls, or a list with one entry per ball.",
            "anyOf": [
                { "type": "integer", "minimum": 1, "maximum": 8 },
                { "type": "array", "items": ball, "minItems": 1, "maxItems": 8 }
            ]
        })
    }
}
