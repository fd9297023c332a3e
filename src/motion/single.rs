//! One motion alone, in a lane, with neighbouring motions to first order in the other lanes.

use std::cell::RefCell;
use std::f64::consts::TAU;
use std::sync::Arc;
use std::thread::panicking;

use super::cancellation::unwind_if_cancelled;
use super::lockstep::{LANES, LaneGroup, SavedRun, suits_tuned_kernel};
use super::root::fall_through_zero;
use super::{
    Effort, Evaluator, Failure, Forces, PerContact, Phase, Phases, SLOW, Settings, SimdLevel,
};
use crate::model::{Components, Method, System};

/// A motion at an instant.
#[derive(Clone, Debug)]
pub struct Instant {
    /// Non-dimensional time.
    pub time: f64,
    /// The state. Angles lie within a step of [0, 2π).
    pub state: Components,
    /// Positions of the contacts; angles with the whole turns made since the start, rad.
    pub unwrapped: PerContact,
    /// The phase of each contact.
    pub phases: Phases,
    /// Speeds, accelerations and forces of the contacts.
    pub forces: Forces,
}

/// The most groups of lanes that a thread keeps.
const MOST_SPARE: usize = 4;

thread_local! {
    /// The lanes of motions that have ended, for later ones: new lanes cost as much as many steps.
    static SPARE: RefCell<Vec<Box<dyn LaneGroup>>> = const { RefCell::new(Vec::new()) };
}

/// A motion in progress.
pub struct Motion {
    /// Lanes with the same run, each with a perturbation of its own.
    groups: Vec<Box<dyn LaneGroup>>,
    directions: usize,
    evaluator: Evaluator,
    /// Speed below which a contact counts as slow.
    slow: f64,
    /// Whether the latest call of [`Motion::advance`] took a step.
    stepped: bool,
}

impl Motion {
    /// Starts a motion from `state` at time 0.
    ///
    /// # Errors
    /// [`Failure`] if the motion cannot be continued from the start state.
    pub fn new(
        system: &Arc<dyn System>,
        settings: Settings,
        state: &[f64],
    ) -> Result<Self, Failure> {
        Motion::with_directions(system, settings, state, &[])
    }

    /// Starts a motion with small perturbations in these directions, which it propagates by the linearised equations
    /// and the saltation matrices of the switches.
    ///
    /// # Errors
    /// [`Failure`] if the motion cannot be continued from the start state.
    pub fn with_directions(
        system: &Arc<dyn System>,
        settings: Settings,
        state: &[f64],
        directions: &[Components],
    ) -> Result<Self, Failure> {
        let saved = SavedRun::start(system, settings, state)?;
        Ok(Motion::of(&saved, directions, Evaluator::new(Arc::clone(system))))
    }

    /// Starts a motion like [`Motion::with_directions`] of a system whose equations are recorded, with the phases until now.
    pub(crate) fn of_recorded(
        evaluator: &Evaluator,
        settings: Settings,
        at: (&[f64], &[Phase]),
        directions: &[Components],
    ) -> Result<Self, Failure> {
        let system = evaluator.system();
        let saved = SavedRun::begin(|| evaluator.clone(), system, settings, at)?;
        Ok(Motion::of(&saved, directions, evaluator.clone()))
    }

    /// Continues a saved run.
    pub(crate) fn resume(saved: &SavedRun) -> Self {
        Motion::of(saved, &[], Evaluator::new(Arc::clone(saved.system())))
    }

    fn of(saved: &SavedRun, directions: &[Components], evaluator: Evaluator) -> Self {
        let system = saved.system();
        let group = |directions: &[Components]| {
            let mut group = spare_lanes(system).unwrap_or_else(|| SimdLevel::best().lanes(system));
            for lane in 0..directions.len().max(1) {
                group.put(lane, saved, saved.time);
                if let Some(direction) = directions.get(lane) {
                    group.perturb(lane, direction);
                }
            }
            group
        };
        let groups = match directions {
            [] => vec![group(&[])],
            directions => directions.chunks(LANES).map(group).collect(),
        };
        let Settings { method, band, .. } = saved.settings();
        Motion {
            groups,
            directions: directions.len(),
            evaluator,
            slow: if method == Method::Switch { SLOW.max(band) } else { SLOW },
            stepped: false,
        }
    }

    fn lane(&self) -> &dyn LaneGroup {
        self.groups[0].as_ref()
    }

    /// Non-dimensional time.
    pub fn time(&self) -> f64 {
        self.lane().time(0)
    }

    /// Returns the present state, with angles in [0, 2π); whole turns are counted apart.
    pub fn state(&self) -> Components {
        self.lane().state(0)
    }

    /// Returns the equations of the system.
    pub fn evaluator(&self) -> &Evaluator {
        &self.evaluator
    }

    /// Returns the positions of the contacts, angles with the whole turns made since the start.
    pub fn unwrapped(&self) -> PerContact {
        self.with_turns(&self.lane().state(0))
    }

    /// Returns the positions of the contacts in a state with reduced angles, with the whole turns made.
    fn with_turns(&self, state: &[f64]) -> PerContact {
        let layout = &self.evaluator.graph().layout;
        let turns = self.lane().turns(0);
        let contacts = layout.contacts.iter().zip(turns);
        contacts.map(|(contact, turns)| state[contact.position] + turns * TAU).collect()
    }

    /// Returns the phases of the contacts.
    pub fn phases(&self) -> &[Phase] {
        self.lane().phases(0)
    }

    /// Returns the phases in the latest step, before a switch at its end.
    pub fn phases_during_step(&self) -> &[Phase] {
        self.lane().phases_during_step(0)
    }

    /// Returns the start time of the latest step.
    pub fn last_step_began(&self) -> f64 {
        self.lane().time_before(0)
    }

    /// Returns when each contact last changed its phase; 0 if it has not.
    pub fn last_switches(&self) -> &[f64] {
        self.lane().last_switches(0)
    }

    /// Returns the last time at which each contact was faster than [`SLOW`], or than the band if that is wider: 0 if
    /// it never was, and the current time if it is now.
    pub fn slow_since(&self) -> PerContact {
        self.lane().slow_since(0)
    }

    /// Returns whether all contacts are slow in the sense of [`Motion::slow_since`].
    pub fn all_slow(&self) -> bool {
        let speeds = self.evaluator.speeds(&self.lane().state(0));
        speeds.iter().all(|speed| speed.abs() <= self.slow)
    }

    /// Returns the effort so far.
    pub fn effort(&self) -> Effort {
        self.lane().effort(0)
    }

    /// Advances by one step, which ends at the next switch or at time `until` at the latest. If
    /// that time has passed, nothing happens. Returns whether a contact changed its phase or an event reset the state.
    ///
    /// # Errors
    /// [`Failure`]; the motion then stays at its last valid state.
    pub fn advance(&mut self, until: f64) -> Result<bool, Failure> {
        unwind_if_cancelled();
        self.stepped = until > self.time();
        if !self.stepped {
            return Ok(false);
        }
        let perturbed = self.directions > 0;
        for group in &mut self.groups {
            for lane in 0..LANES {
                group.set_until(lane, until);
            }
            if let Some(failure) = group.advance(perturbed).failure(0) {
                return Err(failure);
            }
        }
        Ok(self.has_switched())
    }

    /// Returns time and state at which the angle of a contact completed a turn, through the angle 0, in the latest
    /// step; `None` if it did not.
    pub fn passage(&self, contact: usize) -> Option<(f64, Components)> {
        self.stepped.then(|| self.lane().passage(0, contact))?
    }

    /// Returns the state at a time within the latest step, with angles not reduced to one turn; `None` for any other
    /// time.
    pub fn within_last_step(&self, time: f64) -> Option<Components> {
        if time == self.time() {
            let lane = self.lane();
            return Some(if self.stepped { lane.end_of_step(0) } else { lane.state(0) });
        }
        let after = time - self.last_step_began();
        let within = self.stepped && after >= 0.0 && time < self.time();
        within.then(|| self.lane().state_within(0, after))
    }

    /// Returns time and state at which a function of the state fell from above zero to zero or
    /// below in the latest step; `None` if its signs at the two ends show no fall.
    pub fn falls_through_zero(&self, value: impl Fn(&[f64]) -> f64) -> Option<(f64, Components)> {
        let at = |after: f64| self.lane().state_within(0, after);
        let after = self.fall(|after| value(&at(after)), |_| 1.0)?;
        Some((self.last_step_began() + after, at(after)))
    }

    /// Returns how long after the start of the latest step a function of this time falls from above zero to zero or below;
    /// `None` if its signs at the two ends show no fall. The function is multiplied by a sign that depends on its first value.
    fn fall(&self, value: impl Fn(f64) -> f64, sign_of_start: impl Fn(f64) -> f64) -> Option<f64> {
        let length = self.time() - self.last_step_began();
        if !self.stepped || length <= 0.0 {
            return None;
        }
        let ends = [0.0, length].map(&value);
        let sign = sign_of_start(ends[0]);
        let [start, end] = ends.map(|value| sign * value);
        if start <= 0.0 || end > 0.0 {
            return None;
        }
        let value = |part: f64| sign * value(part * length);
        Some(fall_through_zero(value, (0.0, start), (1.0, end), 1e-12) * length)
    }

    /// Returns the state at which the rate of change of a component passed through zero in the latest step, in either
    /// direction; `None` if its signs at the two ends show no passage.
    pub fn turns_back(&self, component: usize) -> Option<Components> {
        let rate = |after: f64| self.lane().rate_within(0, component, after);
        self.fall(rate, f64::signum).map(|after| self.lane().state_within(0, after))
    }

    /// Returns the perturbations, in the order of their directions.
    pub fn perturbations(&self) -> Vec<Components> {
        let lanes = (0..self.directions).map(|i| (&self.groups[i / LANES], i % LANES));
        lanes.map(|(group, lane)| group.perturbation(lane).0).collect()
    }

    /// Returns the perturbations at a time within the latest step.
    pub fn perturbations_within(&mut self, time: f64) -> Vec<Components> {
        let after = time - self.last_step_began();
        let all = self.groups.iter_mut().flat_map(|group| group.perturbations_within(after));
        all.take(self.directions).collect()
    }

    /// Returns whether a perturbation met a switch by grazing and is undefined since.
    pub fn grazed(&self) -> bool {
        let mut lanes = (0..self.directions).map(|i| (&self.groups[i / LANES], i % LANES));
        lanes.any(|(group, lane)| group.perturbation(lane).1)
    }

    /// Returns the current instant, after a switch at the end of the latest step.
    pub fn now(&self) -> Instant {
        self.instant(self.state(), self.unwrapped(), self.phases())
    }

    /// Returns the current instant before the switch at the end of the latest step; `None` without
    /// a switch.
    pub fn before_switch(&self) -> Option<Instant> {
        let during = self.phases_during_step();
        let reset = self.lane().was_reset(0);
        let instant = || match reset {
            false => self.instant(self.state(), self.unwrapped(), during),
            true => {
                let unwrapped =
                    self.lane().unwrapped_within(0, self.time() - self.last_step_began());
                self.instant(self.lane().end_of_step(0), unwrapped, during)
            }
        };
        self.has_switched().then(instant)
    }

    /// Returns whether the latest step ended with a change of phases or a reset.
    fn has_switched(&self) -> bool {
        let switched = self.phases() != self.phases_during_step();
        self.stepped && (switched || self.lane().was_reset(0))
    }

    fn instant(&self, state: Components, unwrapped: PerContact, phases: &[Phase]) -> Instant {
        let time = self.time();
        let forces = self.evaluator.forces(phases, &state);
        Instant { time, state, unwrapped, phases: phases.into(), forces }
    }
}

impl Drop for Motion {
    fn drop(&mut self) {
        // No lanes are kept while a panic unwinds, which may have interrupted a step, or when the thread ends.
        if panicking() {
            return;
        }
        let Ok(mut spare) = SPARE.try_with(RefCell::take) else { return };
        for mut group in self.groups.drain(..) {
            (0..LANES).for_each(|lane| drop(group.take(lane)));
            spare.push(group);
        }
        let surplus = spare.len().saturating_sub(MOST_SPARE);
        spare.drain(..surplus);
        SPARE.set(spare);
    }
}

/// Returns spare lanes with the kernel that computes a system.
fn spare_lanes(system: &Arc<dyn System>) -> Option<Box<dyn LaneGroup>> {
    // Not borrowed, because a system that is recorded may compute a motion.
    let mut spare = SPARE.take();
    let is_tuned = suits_tuned_kernel(system);
    let place = spare.iter().rposition(|group| group.is_tuned() == is_tuned && group.fits(system));
    let lanes = place.map(|place| spare.remove(place));
    SPARE.set(spare);
    lanes
}
