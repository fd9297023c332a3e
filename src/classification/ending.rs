//! How the simulation of a run ends, with what was found.

use super::closed_orbit::Orbit;
use super::periodic_creep::Creep;
use super::section::marks;
use super::system_view::SystemView;
use crate::model::{Components, Model};
use crate::motion::{Evaluator, Failure};

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

/// The endings of runs beside irregular motion and sliding at constant speed that the program finds for a model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FoundEndings {
    /// Limit cycles.
    pub cycles: bool,
    /// Rests in which contacts stick, or rests of a system without contacts.
    pub rests: bool,
}

/// Returns the endings that the program finds for a model; all for a model without a system.
pub fn found_endings(model: &Model) -> FoundEndings {
    let Some(system) = model.system() else { return FoundEndings { cycles: true, rests: true } };
    let view = SystemView::new(Evaluator::new(system));
    let cycles = view.revolves() || !marks(&view).is_empty();
    let rests = view.contacts.is_empty() || view.rest_forms().is_some();
    FoundEndings { cycles, rests }
}
