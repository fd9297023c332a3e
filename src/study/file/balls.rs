//! The balls of a study file: how many, or one entry for each, and the contact between them.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::values::notations;
use crate::model::MAX_BALLS;

/// One ball; values that are absent are those of all balls.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct BallFile {
    /// Mass, kg, above 0; the default is `ball_mass_kg`.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub mass_kg: Option<f64>,
    /// Diameter, m, above 0; the default is `ball_diameter_m`.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub diameter_m: Option<f64>,
    /// Coefficient of friction between ball and ring, dimensionless, at least 0; the default is
    /// `friction_coefficient`.
    #[schemars(extend("minimum" = 0))]
    pub friction_coefficient: Option<f64>,
}

impl BallFile {
    /// Returns the values by key and by the name of the parameter of all balls.
    pub fn values(&self) -> [(&'static str, &'static str, Option<f64>); 3] {
        [
            ("mass_kg", "ball_mass_kg", self.mass_kg),
            ("diameter_m", "ball_diameter_m", self.diameter_m),
            ("friction_coefficient", "friction_coefficient", self.friction_coefficient),
        ]
    }

    /// Returns the value of the parameter of all balls with this name.
    pub fn value(&self, general: &str) -> Option<f64> {
        self.values().into_iter().find(|(_, name, _)| *name == general)?.2
    }
}

/// Number of balls, or a list with one entry per ball.
#[derive(Clone, Debug, JsonSchema, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Balls {
    /// The number of balls, all identical.
    Number(#[schemars(range(min = 1, max = MAX_BALLS))] u64),
    /// One entry per ball.
    Each(#[schemars(length(min = 1, max = MAX_BALLS))] Vec<BallFile>),
}

notations! {
    Balls: "a number of balls from 1 to 8, or a list with one entry per ball",
    natural => |number| Some(Balls::Number(number)),
    list(Vec<BallFile>) => Balls::Each,
}

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

notations! {
    ContactFile: "none, or {restitution: 0.36, friction_coefficient: 0.1}",
    text => |word| (word == "none").then_some(ContactFile::Without(NoContact::None)),
    map(ContactLawFile) => ContactFile::Law,
}
