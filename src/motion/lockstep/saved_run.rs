//! A run outside of its lane: how it starts, and how it goes on with another system.

use std::f64::consts::TAU;
use std::sync::Arc;

use smallvec::{SmallVec, smallvec};

use super::lane::Lane;
use super::root_isolation::width;
use super::tuned;
use crate::model::{Components, Method, System};
use crate::motion::condition::Margins;
use crate::motion::joint_decision::RecordedForces;
use crate::motion::stick_slip::start_phases;
use crate::motion::touching_system::TouchingSystem;
use crate::motion::{
    Effort, Evaluator, Failure, PerContact, Phase, Phases, SINGULAR, SLOW, Settings, Touches,
    any_closed,
};

/// A run taken out of its lane, which can be put into any lane.
#[derive(Clone, Debug)]
pub(crate) struct SavedRun {
    pub(super) lane: Lane,
    pub(crate) time: f64,
    pub(crate) state: Components,
    pub(super) turns: PerContact,
    pub(super) slow_since: PerContact,
    pub(super) next: f64,
    pub(super) taken: f64,
    pub(super) perturbation: Components,
}

impl SavedRun {
    /// Creates a run at its start.
    pub(crate) fn start(
        system: &Arc<dyn System>,
        settings: Settings,
        state: &[f64],
    ) -> Result<Self, Failure> {
        let evaluator = || Evaluator::new(Arc::clone(system));
        SavedRun::begin(evaluator, system, settings, (state, &[]))
    }

    /// Creates a run in a state, with the phases until now, if there are some, and with recorded equations.
    pub(crate) fn begin(
        evaluator: impl FnOnce() -> Evaluator,
        system: &Arc<dyn System>,
        settings: Settings,
        (state, until_now): (&[f64], &[Phase]),
    ) -> Result<Self, Failure> {
        let mut start: Components = state.into();
        if system.smallest_inertia(state) < SINGULAR {
            return Err(Failure::IndefiniteMass);
        }
        let settings = settings.narrowed(system.as_ref());
        let force_scale = system.force_scale();
        let surely_one_solution = system.surely_one_solution();
        let contacts = system.contacts();
        let by_tuned = || {
            let tuned = tuned::with_balancer_forces(system, surely_one_solution, state, |at| {
                start_phases(system.as_ref(), settings, at, until_now)
            });
            tuned.map(|phases| Ok((phases?, None, tuned::angles(contacts).collect(), false)))
        };
        let by_equations = || {
            let evaluator = evaluator();
            let (phases, impact) = match TouchingSystem::new(&evaluator, settings) {
                Some(in_touch) => {
                    let (phases, impact) = in_touch.start(&mut start)?;
                    (phases, Some(impact))
                }
                None => {
                    let at = RecordedForces::new(&evaluator, state);
                    (start_phases(system.as_ref(), settings, &at, until_now)?, None)
                }
            };
            let layout = evaluator.graph().layout.contacts.iter();
            let angles = layout.filter(|contact| contact.angular);
            let angles = angles.map(|contact| contact.position).collect();
            Ok((phases, impact, angles, !evaluator.graph().openings.is_empty()))
        };
        let without_gaps = system.touching().is_none();
        let tuned = if without_gaps { by_tuned() } else { None };
        let (phases, impact, angles, has_openings): (Phases, _, SmallVec<[usize; 8]>, bool) =
            tuned.unwrap_or_else(by_equations)?;
        for component in angles {
            let angle = &mut start[component];
            if !(0.0..TAU).contains(angle) {
                *angle -= (*angle / TAU).floor() * TAU;
            }
        }
        let mut lane = Lane {
            margins: Margins::new(&settings, force_scale),
            limits: (0..contacts).map(|contact| system.friction(contact).limit).collect(),
            force_scale,
            has_gaps: !without_gaps,
            has_openings,
            settings,
            surely_one_solution,
            slow: match settings.method {
                Method::Switch => SLOW.max(settings.band),
                Method::Event => SLOW,
            },
            width: width(settings.tolerance.relative),
            longest_step: system.longest_step(),
            fastest_rate: system.fastest_rate(),
            during: phases.clone(),
            last_switches: smallvec![0.0; phases.len()],
            switches: 0,
            impact: None,
            hit_at: 0.0,
            touches: Touches::default(),
            last_touch: 0.0,
            held: Vec::new(),
            phases,
            grazed: false,
            events: 0,
            events_since: 0.0,
            system: Arc::clone(system),
        };
        lane.take_in(impact.map(Box::new), 0.0);
        let next = lane.longest_step;
        Ok(SavedRun {
            lane,
            time: 0.0,
            perturbation: smallvec![0.0; start.len()],
            state: start,
            turns: smallvec![0.0; contacts],
            slow_since: smallvec![0.0; contacts],
            next,
            taken: 0.0,
        })
    }

    /// Continues the run with another system from a state, in which a blow has lifted balls off their support.
    pub(crate) fn enters(
        &self,
        system: &Arc<dyn System>,
        state: &[f64],
        lifted: u32,
    ) -> Result<Self, Failure> {
        let before = &self.lane;
        let evaluator = || Evaluator::new(Arc::clone(system));
        let started = SavedRun::begin(evaluator, system, before.settings, (state, &before.phases))?;
        let mut lane = Lane {
            last_switches: before.last_switches.clone(),
            switches: before.switches,
            touches: before.touches,
            // A kick separates contacts that touch, but it is no impact between them.
            impact: None,
            last_touch: before.last_touch,
            ..started.lane
        };
        lane.touches.lifted_off += u64::from(lifted);
        let contacts = system.contacts();
        for (contact, last) in lane.last_switches.iter_mut().enumerate() {
            if lane.phases[contact] != before.phases[contact] {
                *last = self.time;
                lane.switches += u64::from(contact < contacts);
            }
        }
        if any_closed(&before.phases) {
            lane.touches.time += self.time - before.last_touch;
        }
        lane.last_touch = self.time;
        Ok(SavedRun {
            lane,
            time: self.time,
            turns: self.turns.clone(),
            slow_since: self.slow_since.clone(),
            taken: self.taken,
            ..started
        })
    }

    /// Returns the effort so far.
    pub(crate) fn effort(&self) -> Effort {
        self.lane.effort(self.taken)
    }

    /// Returns the settings.
    pub(crate) fn settings(&self) -> Settings {
        self.lane.settings
    }

    /// Returns the system.
    pub(crate) fn system(&self) -> &Arc<dyn System> {
        &self.lane.system
    }
}
