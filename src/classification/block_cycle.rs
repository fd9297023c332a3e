//! The limit cycle of a single body on a belt: its motion from one break-away to the next.
//!
//! On a belt a block is carried along until it breaks away, always at the same position, so that its
//! state there is the same each time: two successive break-aways close a cycle, and a disturbance
//! vanishes within one period. The only multiplier other than that along the motion is 0, and no
//! direction is neutral. This requires a static coefficient above the kinetic one.
//!
//! With equal coefficients, the block reaches the belt's speed only on the orbit that starts at its
//! break-away, the outermost of the orbits on which it slides permanently. This orbit preserves
//! every inward disturbance, so that no cycle is claimed. A block that slides permanently on a belt
//! is not stopped by dry friction; unless its law damps the motion, so that it settles, it
//! oscillates with constant amplitude.

use super::cycle::{Cycle, CyclePhase};
use super::lane_step::LaneStep;
use super::output_watch::OutputWatch;
use super::system_view::SystemView;
use crate::model::Units;
use crate::motion::{Phase, all_stick};

/// Detects the cycle of a body whose position and speed are the whole state, and which has one contact or several with one
/// sliding speed.
#[derive(Clone, Debug, Default)]
pub(super) struct BreakAwayWatch {
    last: Option<BreakAway>,
}

/// The latest break-away and the motion since then.
#[derive(Clone, Debug)]
struct BreakAway {
    time: f64,
    position: f64,
    outputs: OutputWatch,
    /// The sequence of phases; neighbours differ.
    cycle_phases: Vec<CyclePhase>,
    /// Least and greatest sliding speed; 0 at break-away.
    speeds: [f64; 2],
    /// The time for which the contact has stuck, and the time until which steps are added.
    stuck: f64,
    until: f64,
}

impl BreakAwayWatch {
    /// Returns whether break-aways of this system can show a cycle.
    pub(super) fn suits(view: &SystemView) -> bool {
        let Some(first) = view.contacts.first() else { return false };
        let breaks_away = |contact: usize| {
            let friction = view.system().friction(contact);
            friction.limit > friction.coefficient
        };
        let contacts = 0..view.contacts.len();
        // A contact that never sticks would hide that the others do.
        let sticks = |contact: usize| view.system().friction(contact).can_stick();
        let together = view.contacts.iter().all(|contact| contact.speed == first.speed);
        view.dimension() == 2
            && together
            && contacts.clone().all(sticks)
            && contacts.clone().any(breaks_away)
    }

    /// Returns whether there was a break-away, after which each step must be added.
    pub(super) fn has_begun(&self) -> bool {
        self.last.is_some()
    }

    /// Adds the latest step after the first break-away.
    pub(super) fn take_in(&mut self, step: &LaneStep) {
        if let Some(last) = &mut self.last {
            last.extend(step);
            last.outputs.take_in(step);
        }
    }

    /// Records a break-away at the end of the latest step, if there is one. Returns the period if it
    /// closes a cycle.
    pub(super) fn closes(&mut self, step: &LaneStep) -> Option<f64> {
        if !all_stick(step.during()) || all_stick(step.phases()) {
            return None;
        }
        let (time, position) = (step.time(), step.unwrapped()[0]);
        if let Some(last) = &self.last
            && (position - last.position).abs() <= 1e-6 * position.abs().max(1.0)
        {
            return Some(time - last.time);
        }
        self.last = Some(BreakAway {
            time,
            position,
            outputs: OutputWatch::from(time),
            cycle_phases: Vec::new(),
            speeds: [0.0; 2],
            stuck: 0.0,
            until: time,
        });
        None
    }

    /// Returns the outputs since the last break-away.
    pub(super) fn outputs(&self) -> Option<&OutputWatch> {
        self.last.as_ref().map(|last| &last.outputs)
    }

    /// Returns the cycle since the last break-away.
    pub(super) fn cycle(&self, units: &Units) -> Option<Cycle> {
        let last = self.last.as_ref()?;
        let (contacts, unit) = (units.contacts.len(), units.contacts.first()?);
        Some(Cycle {
            turns: vec![0; contacts],
            configurations: last.cycle_phases.iter().map(|&phase| vec![phase; contacts]).collect(),
            touching: Vec::new(),
            speed_extremes: vec![last.speeds.map(|speed| speed * unit.sliding_speed); contacts],
            position_extremes: vec![None; contacts],
            stick_fraction: vec![last.stuck / (last.until - last.time); contacts],
            peak_amplitude_m: 0.0,
            multipliers: vec![0.0],
            neutral_directions: 0,
        })
    }
}

impl BreakAway {
    /// Adds the phase and the speeds of the latest step.
    fn extend(&mut self, step: &LaneStep) {
        let (view, during) = (step.view, step.during());
        let speed = |state: &[f64]| view.speed(state, 0);
        let at_end = speed(&step.end());
        let cycle_phase = CyclePhase::of(during.first().copied().unwrap_or(Phase::Free), at_end);
        if self.cycle_phases.last() != Some(&cycle_phase) {
            self.cycle_phases.push(cycle_phase);
        }
        self.until = step.time();
        if cycle_phase == CyclePhase::Stick {
            self.stuck += step.time() - step.began();
            return;
        }
        // It is fastest where its acceleration passes through zero, or at the end of the step.
        let fastest = step.passes_through_zero(|state| view.acceleration(during, state, 0));
        let within = |time: f64| speed(&step.group.state_within(step.lane, time - step.began()));
        let [low, high] = &mut self.speeds;
        for speed in fastest.map(within).into_iter().chain([at_end]) {
            *low = low.min(speed);
            *high = high.max(speed);
        }
    }
}
