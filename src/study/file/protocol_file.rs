//! The measurement protocols of the thesis (its figure 5.10) in a study file, short for a speed profile and kicks.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::notations::notations;

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
