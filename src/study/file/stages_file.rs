//! The speed profile and the disturbances in a study file, and the measurement protocols of the thesis (its figure
//! 5.10), which are short for them.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::values::notations;
use crate::study::file::values::TableKey;

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
