//! Parts of the model in a study file: its balls and their contact, its speed profile and disturbances, and the measurement
//! protocols of the thesis (its figure 5.10), which are short for these.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::values::{TableKey, notations};
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

/// A part of a speed profile.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum ProfilePartFile {
    /// A change of speed at constant acceleration.
    Ramp(RampFile),
    /// A change of speed whose acceleration is continuous, and zero at both ends.
    SmoothRamp(RampFile),
    /// A constant speed for this time, s. If the profile ends with it, the run ends with it.
    HoldS(#[schemars(range(min = 0))] f64),
    /// A speed that is linear between the rows of a table with the columns `time_s`, from 0, and `speed_rad_s`.
    Table(TableKey),
}

/// A change of speed.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct RampFile {
    /// Speed at the start, rad/s; required in the first part. Each later part starts at the speed at the end of the part
    /// before; another value is an error.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub from_rad_s: Option<f64>,
    /// Speed at the end, rad/s; required except in the last ramp, which leads to `speed_rad_s`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub to_rad_s: Option<f64>,
    /// Duration, s; above 0; required.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub over_s: f64,
}

/// A disturbance of a run.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum DisturbanceFile {
    /// The velocity of the table jumps, as by a blow with a hammer.
    Kick(KickFile),
}

/// A jump of the table's velocity.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct KickFile {
    /// Time of the kick, s; above 0; required.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub at_s: f64,
    /// Change of the table's velocity, m/s; at least 0; required.
    #[schemars(range(min = 0))]
    pub speed_m_s: f64,
    /// `random`: a direction that is drawn for each run, the default.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub direction: Option<DirectionFile>,
    /// The direction in space instead, rad; the imbalance has the angle 0 at the start.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub direction_rad: Option<f64>,
}

/// A direction in words.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum DirectionFile {
    /// Drawn for each run, all directions alike.
    Random,
}

/// A protocol with all defaults, or with some numbers.
#[derive(Clone, Debug, JsonSchema, PartialEq, Serialize)]
#[serde(untagged)]
pub enum ProtocolFile {
    /// All numbers have their defaults.
    Named(ProtocolName),
    /// Some numbers are given.
    With(ProtocolKeys),
}

/// The name of a protocol.
#[derive(Clone, Copy, Debug, JsonSchema, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ProtocolName {
    /// The disc starts, then the balls come to rest (protocol I).
    Startup,
    /// The disc starts; then the table is hit once and again, and the balls come to rest after each hit (protocol II).
    StartupAndHammer,
}

/// A protocol with its numbers.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum ProtocolKeys {
    /// The disc starts, then the balls come to rest (protocol I).
    Startup(StartupFile),
    /// The disc starts; then the table is hit once and again, and the balls come to rest after each hit (protocol II).
    StartupAndHammer(HammerFile),
}

/// The numbers of a start.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct StartupFile {
    /// Speed at the start, rad/s; default 31 rad/s, the slowest speed of the thesis's motor, with the sign of `speed_rad_s`.
    pub from_rad_s: Option<f64>,
    /// Duration of the linear ramp to `speed_rad_s`, s; above 0, default 2.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub over_s: Option<f64>,
}

/// The numbers of a start and of hits with a hammer.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct HammerFile {
    /// Speed at the start, rad/s; default 31 rad/s, the slowest speed of the thesis's motor, with the sign of `speed_rad_s`.
    pub from_rad_s: Option<f64>,
    /// Duration of the linear ramp to `speed_rad_s`, s; above 0, default 2.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub over_s: Option<f64>,
    /// Number of hits, 1 to 8; default 1.
    #[schemars(range(min = 1, max = 8))]
    pub hits: Option<u64>,
    /// Time between the end of the ramp and the first hit, between two hits, and between the last hit and the end of the
    /// run, s; above 0, default 5.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub wait_s: Option<f64>,
    /// Change of the table's velocity in each hit, in a random direction, m/s; at least 0, default 0.01.
    #[schemars(extend("minimum" = 0))]
    pub speed_m_s: Option<f64>,
}

notations! {
    ProtocolFile: "startup, or {startup_and_hammer: {hits: 3}}",
    text => |name| match name {
        "startup" => Some(ProtocolFile::Named(ProtocolName::Startup)),
        "startup_and_hammer" => Some(ProtocolFile::Named(ProtocolName::StartupAndHammer)),
        _ => None,
    },
    map(ProtocolKeys) => ProtocolFile::With,
}
