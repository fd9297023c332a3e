//! The contact between balls in a study file: its law, or `none`.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::notations::notations;

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
