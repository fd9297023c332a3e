//! How the simulation of a run ends, with what was found.

use super::closed_orbit::Orbit;
use super::periodic_creep::Creep;
use crate::model::Components;
use crate::motion::Failure;

/// How the simulation ended.
pub(super) enum Ending {
    /// All contacts stick for good.
    Rest,
    /// An equilibrium without dry friction is near.
    Settled(Box<Components>),
    /// The run is on a closed orbit.
    Orbit(Box<Orbit>),
    /// The run creeps under a periodic force.
    Creep(Box<Creep>),
    /// The end time was reached.
    EndTime,
    /// The motion could not be continued.
    Failure(Failure),
}
