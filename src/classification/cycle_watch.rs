//! The search for the limit cycle of a run, by the kind of its system.

use std::sync::Arc;

use super::block_cycle::BreakAwayWatch;
use super::ending::Ending;
use super::lane_step::LaneStep;
use super::orbit::OrbitWatch;
use super::section::{SectionMark, marks};
use super::system_view::SystemView;
use crate::model::{Endings, Model};
use crate::motion::{Evaluator, Settings};

/// Detects limit cycles.
#[derive(Clone, Debug)]
pub(super) enum CycleWatch {
    /// None are sought.
    None,
    /// Those of revolving contacts, or of several contacts on a belt.
    Orbits(Box<OrbitWatch>),
    /// Those of a single contact that breaks away again and again.
    BreakAways(BreakAwayWatch),
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
    let cycles = view.revolves() || BreakAwayWatch::suits(&view) || has_orbits(&view);
    let rests = view.contacts.is_empty() || view.rest_forms().is_some();
    FoundEndings { cycles, rests }
}

/// Returns whether periods of a forcing, angles, or turning points of several bodies or of one body with several contacts, can mark cycles.
fn has_orbits(view: &SystemView) -> bool {
    match marks(view).first() {
        Some(SectionMark::Angle { .. } | SectionMark::Period(_)) => true,
        Some(_) => view.dimension() > 2 || view.contacts.len() > 1 && !BreakAwayWatch::suits(view),
        None => false,
    }
}

impl CycleWatch {
    /// Creates the watch that suits a system.
    pub(super) fn new(endings: Endings, settings: &Settings, view: &Arc<SystemView>) -> Self {
        match endings {
            Endings::All if view.revolves() || has_orbits(view) => {
                CycleWatch::Orbits(Box::new(OrbitWatch::new(settings, Arc::clone(view))))
            }
            Endings::All if BreakAwayWatch::suits(view) => {
                CycleWatch::BreakAways(BreakAwayWatch::default())
            }
            Endings::All | Endings::Rest => CycleWatch::None,
        }
    }

    /// Returns whether each step must be examined.
    pub(super) fn sees_each_step(&self) -> bool {
        matches!(self, CycleWatch::Orbits(watch) if watch.sees_each_step())
            || self.takes_each_step()
    }

    /// Returns whether each step must be added.
    pub(super) fn takes_each_step(&self) -> bool {
        matches!(self, CycleWatch::BreakAways(watch) if watch.has_begun())
    }

    /// Adds the latest step.
    pub(super) fn take_in(&mut self, step: &LaneStep) {
        if let CycleWatch::BreakAways(watch) = self {
            watch.take_in(step);
        }
    }

    /// Evaluates a run that ends otherwise undecided after some steps; `last_switches` are the times at which its contacts
    /// last changed their phases. Returns the ending if the run has been shown to approach a limit cycle or to
    /// creep.
    pub(super) fn closes_at_end(
        &self,
        settings: &Settings,
        last_switches: &[f64],
        steps: u64,
    ) -> Option<Ending> {
        let CycleWatch::Orbits(watch) = self else { return None };
        let orbit = watch.look_at_end(settings, last_switches, steps);
        let creep = || Some(Ending::Creep(Box::new(watch.creep(settings)?)));
        orbit.map(|orbit| Ending::Orbit(Box::new(orbit))).or_else(creep)
    }

    /// Evaluates the end of a step with an event or a completed turn. Returns the ending if the run
    /// has been shown to be on a limit cycle.
    pub(super) fn closes(&mut self, settings: &Settings, step: &LaneStep) -> Option<Ending> {
        let watch = match self {
            CycleWatch::None => return None,
            CycleWatch::BreakAways(watch) => {
                return watch.closes(step).map(|period| Ending::BreakAways { period });
            }
            CycleWatch::Orbits(watch) => watch,
        };
        let orbit = watch.closes(settings, step)?;
        Some(Ending::Orbit(Box::new(orbit)))
    }
}
