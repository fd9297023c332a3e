//! The speed profile and the disturbances in a study file.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

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
