//! The balls of a study file: how many, or one entry for each.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::notations::notations;
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
