//! The interface of eight lanes, whichever kernel computes them.

use std::sync::Arc;

use smallvec::SmallVec;

use super::LANES;
use super::lane::Saved;
use crate::model::{Components, System};
use crate::motion::{Effort, Failure, Hit, PerContact, Phase, Touches};

/// The events of a step, as bit masks of lanes.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Happened {
    /// The lane's step has been taken.
    pub(crate) taken: u64,
    /// A contact changed its phase, or came to rest.
    pub(crate) event: u64,
    /// An angle passed through 0.
    pub(crate) round: u64,
    /// The requested time or the end time was reached, or the displacement must be rescaled.
    pub(crate) attention: u64,
    /// The amplitude may have been larger than the watched one.
    pub(crate) larger: u64,
    /// All contacts stick, perhaps for good.
    pub(crate) rest: u64,
    /// Everything is slow while a contact slides.
    pub(crate) still: u64,
    /// Without dry friction: a contact has turned back, which no condition detects.
    pub(crate) turned: u64,
    /// The lanes for which events, completed turns and reversals are reported.
    pub(crate) told: u64,
    /// Lanes that cannot continue.
    pub(crate) failed: u64,
    pub(super) failures: [Option<Failure>; LANES],
}

impl Happened {
    /// Returns the lanes with anything to report.
    pub(crate) fn any(&self) -> u64 {
        let happened = (self.event | self.round | self.turned) & self.told;
        happened | self.attention | self.larger | self.rest | self.still | self.failed
    }

    /// Returns why a lane cannot continue.
    pub(crate) fn failure(&self, lane: usize) -> Option<Failure> {
        self.failures[lane]
    }

    /// Notes that a lane cannot continue.
    pub(super) fn fail(&mut self, lane: usize, failure: Failure) {
        self.failed |= 1 << lane;
        self.failures[lane] = Some(failure);
    }
}

/// Eight lanes, some of them empty. States are in the components of the system.
pub(crate) trait LaneGroup {
    /// Returns whether runs of a system can be put into these lanes.
    fn fits(&self, system: &Arc<dyn System>) -> bool;
    /// Returns an empty lane, or `None` if all lanes have a run.
    fn empty_lane(&self) -> Option<usize>;
    /// Returns the number of lanes with a run.
    fn runs(&self) -> u32;
    /// Puts a run into a lane, until a time at the latest.
    fn put(&mut self, lane: usize, saved: &Saved, until: f64);
    /// Changes the time at which a lane stops.
    fn set_until(&mut self, lane: usize, until: f64);
    /// Takes a run out of its lane.
    fn take(&mut self, lane: usize) -> Option<Saved>;
    /// Returns a copy of the run in a lane.
    fn copy(&self, lane: usize) -> Option<Saved>;
    /// Takes a step in all lanes. If `displaced`, a displacement of each lane is propagated.
    fn advance(&mut self, displaced: bool) -> Happened;

    /// Requests that a lane be reported after each step from a time on.
    fn set_attention(&mut self, lane: usize, from: f64);
    /// Requests that a lane be reported after each step in which the amplitude of the vibration may exceed the root of
    /// `square`.
    fn watch_amplitude(&mut self, lane: usize, square: f64);
    /// Sets whether turns and switches of a lane are reported.
    fn set_told(&mut self, lane: usize, told: bool);
    /// Returns whether a time may shorten the next step of a lane.
    fn reaches(&self, lane: usize, time: f64) -> bool;
    /// Returns the length of the longest possible step of a lane.
    fn longest(&self, lane: usize) -> f64;

    /// The time of a lane.
    fn time(&self, lane: usize) -> f64;
    /// The time of a lane before its latest step.
    fn time_before(&self, lane: usize) -> f64;
    /// Returns the present state, with angles in [0, 2π).
    fn state(&self, lane: usize) -> Components;
    /// Returns the state at the end of the latest step, before an event that resets it, with angles not yet reduced to
    /// one turn.
    fn end_of_step(&self, lane: usize) -> Components;
    /// Returns the state at a time after the start of the latest step, with angles not yet reduced to one turn.
    fn state_within(&self, lane: usize, after: f64) -> Components;
    /// Returns the states at eight times after the start of the latest step, like [`LaneGroup::state_within`].
    fn states_within(&self, lane: usize, after: [f64; LANES]) -> [Components; LANES];
    /// Returns a component at a time after the start of the latest step, like [`LaneGroup::state_within`].
    fn component_within(&self, lane: usize, component: usize, after: f64) -> f64;
    /// Returns the rate of change of a component at a time after the start of the latest step.
    fn rate_within(&self, lane: usize, component: usize, after: f64) -> f64;
    /// Returns the positions of the contacts at a time after the start of the latest step, with the whole turns made
    /// since the start of the run.
    fn unwrapped_within(&self, lane: usize, after: f64) -> PerContact;
    /// Returns the angle of the whole turns that each contact had made before the latest step; 0 for a contact without a ring.
    fn turned_before(&self, lane: usize) -> PerContact;
    /// Returns the squares of the displacement of `StateLayout::vibration` at times after the start of the latest step; 0
    /// without such a displacement.
    fn squares_within(&self, lane: usize, after: [f64; 5]) -> [f64; 5];
    /// Returns some parts of the latest step with the squares of the displacement there. They contain each maximum whose
    /// neighbours exceed the part `near` of `known`. The caller passes the largest square so far as `known`.
    fn largest_squares_within(
        &self,
        lane: usize,
        known: f64,
        near: f64,
    ) -> SmallVec<[(f64, f64); 8]>;
    /// Returns time and state at which a contact's angle completed a turn, through the angle 0, in the latest step;
    /// `None` if it did not.
    fn passage(&self, lane: usize, contact: usize) -> Option<(f64, Components)>;
    /// Returns the whole turns of the contacts since the start of the run.
    fn turns(&self, lane: usize) -> PerContact;

    /// Returns the phases after the latest step. A lane without a run has none.
    fn phases(&self, lane: usize) -> &[Phase];
    /// Returns the phases in the latest step, before an event at its end.
    fn phases_during_step(&self, lane: usize) -> &[Phase];
    /// Returns whether an event at the end of the latest step reset the state.
    fn was_reset(&self, lane: usize) -> bool;
    /// Returns when each contact last changed its phase; 0 if it has not.
    fn last_switches(&self, lane: usize) -> &[f64];
    /// Returns the last time at which each contact was faster than `SLOW`, or than the band if that is wider: 0 if
    /// it never was, and the current time if it is now.
    fn slow_since(&self, lane: usize) -> PerContact;
    /// Returns the impacts at the end of the latest step or, before the first step, at the start.
    fn hits(&self, lane: usize) -> &[Hit];
    /// Returns how the contacts of the run in a lane have touched; `None` for a system without gaps.
    fn touches(&self, lane: usize) -> Option<Touches>;
    /// Returns the effort of the run in a lane.
    fn effort(&self, lane: usize) -> Effort;

    /// Displaces a lane in a direction.
    fn displace(&mut self, lane: usize, direction: &[f64]);
    /// Returns the displacement of a lane, and whether it met a switch by grazing and is undefined since.
    fn displacement(&self, lane: usize) -> (Components, bool);
    /// Returns the displacements of all lanes at a time after the start of the latest step, which must have been
    /// displaced.
    fn displacements_within(&mut self, after: f64) -> Vec<Components>;
}
