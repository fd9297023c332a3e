//! The latest step of a run in a lane.

use smallvec::SmallVec;

use super::section::Marking;
use super::system_view::{ContactPlace, SystemView};
use crate::model::Components;
use crate::motion::lockstep::{LANES, LaneGroup};
use crate::motion::{Effort, Hit, Instant, PerContact, Phase, fall_through_zero};

/// Width within which an instant is located, over the length of the step.
const WIDTH: f64 = 1e-13;

/// The latest step of a run in a lane; before the first step, its start.
#[derive(Clone, Copy)]
pub(super) struct LaneStep<'a> {
    pub(super) group: &'a dyn LaneGroup,
    pub(super) lane: usize,
    pub(super) view: &'a SystemView,
}

impl<'a> LaneStep<'a> {
    /// Returns the start time of the step.
    pub(super) fn began(&self) -> f64 {
        self.group.time_before(self.lane)
    }

    /// Returns the end time of the step.
    pub(super) fn time(&self) -> f64 {
        self.group.time(self.lane)
    }

    /// Returns the effort of the run so far.
    pub(super) fn effort(&self) -> Effort {
        self.group.effort(self.lane)
    }

    /// Returns the phases in the step, before an event at its end.
    pub(super) fn during(&self) -> &'a [Phase] {
        self.group.phases_during_step(self.lane)
    }

    /// Returns the phases after the step.
    pub(super) fn phases(&self) -> &'a [Phase] {
        self.group.phases(self.lane)
    }

    /// Returns the impacts at the end of the step or, before the first step, at the start.
    pub(super) fn hits(&self) -> &'a [Hit] {
        self.group.impact(self.lane).map_or(&[], |impact| &impact.hits)
    }

    /// Returns the contacts that were apart and have hit at the end of the step or, before the first step, at the start.
    pub(super) fn landed(&self) -> &'a [usize] {
        self.group.impact(self.lane).map_or(&[], |impact| &impact.landed)
    }

    /// Returns the state at the step's end, before an event that resets it, with angles not reduced to one turn.
    pub(super) fn end(&self) -> Components {
        self.group.end_of_step(self.lane)
    }

    /// Returns a component at the step's start.
    pub(super) fn component_at_start(&self, component: usize) -> f64 {
        self.group.component_at_start(self.lane, component)
    }

    /// Returns a component of [`LaneStep::end`].
    pub(super) fn component_at_end(&self, component: usize) -> f64 {
        self.group.component_at_end(self.lane, component)
    }

    /// Returns the positions of the contacts after the step, with whole turns.
    pub(super) fn unwrapped(&self) -> PerContact {
        self.view.unwrapped(&self.group.state(self.lane), &self.group.turns(self.lane))
    }

    /// Returns the positions of the contacts at a time within the step, with whole turns.
    pub(super) fn unwrapped_at(&self, time: f64) -> PerContact {
        self.group.unwrapped_within(self.lane, time - self.began())
    }

    /// Returns the outputs at some times within the step, with angles that include whole turns.
    pub(super) fn outputs_at<const P: usize>(&self, times: [f64; P]) -> [Components; P] {
        const { assert!(P > 0 && P <= LANES) };
        let turned = self.group.turned_before(self.lane);
        let after = std::array::from_fn(|place| times[place.min(P - 1)] - self.began());
        let mut states = self.group.states_within(self.lane, after);
        std::array::from_fn(|place| {
            let mut state = std::mem::take(&mut states[place]);
            self.view.turn(&mut state, &turned);
            self.view.system().outputs(&state)
        })
    }

    /// Returns one of the outputs at a time within the step, like [`LaneStep::outputs_at`].
    pub(super) fn output_at(&self, number: usize, time: f64) -> f64 {
        let after = time - self.began();
        let component = |component: usize| {
            let value = self.group.value(&self.group.series(self.lane, component), after);
            let is_place = |place: &ContactPlace| place.position == component;
            let contact = self.view.contacts.iter().position(is_place);
            contact.map_or(value, |contact| value + self.group.turned_before(self.lane)[contact])
        };
        let output = self.view.system().output(number, &component);
        output.unwrap_or_else(|| self.outputs_at([time])[0][number])
    }

    /// Returns the time at which a function that is `end` at the end of the step passed through a value in the step, in either
    /// direction; `None` if its values at the two ends show no passage.
    pub(super) fn passes_through(&self, marking: &Marking, [value, end]: [f64; 2]) -> Option<f64> {
        let series = marking.components().map(|place| (place, self.group.series(self.lane, place)));
        let series: SmallVec<[_; 2]> = series.collect();
        let within = |after: f64| {
            // The function reads no other components.
            let of = |place: usize| series.iter().find(|(other, _)| *other == place);
            let value_of =
                |place| of(place).map_or(0.0, |(_, series)| self.group.value(series, after));
            marking.of(value_of) - value
        };
        let start = within(0.0);
        let falls = |value: f64| if start > 0.0 { value } else { -value };
        let (from, to) = (falls(start), falls(end - value));
        if !(from > 0.0 && to <= 0.0) {
            return None;
        }
        let length = self.time() - self.began();
        let at = |part: f64| falls(within(part * length));
        let part = fall_through_zero(at, (0.0, from), (1.0, to), WIDTH);
        Some(self.began() + part * length)
    }

    /// Returns the current instant, after a switch at the end of the step.
    pub(super) fn now(&self) -> Instant {
        let state = self.group.state(self.lane);
        self.instant(self.time(), state, self.unwrapped(), self.phases())
    }

    /// Returns the current instant before the switch at the end of the step; `None` without a
    /// switch.
    pub(super) fn before_switch(&self) -> Option<Instant> {
        let during = self.during();
        let reset = self.group.was_reset(self.lane);
        let unwrapped = || if reset { self.unwrapped_at(self.time()) } else { self.unwrapped() };
        let switched = reset || during != self.phases();
        switched.then(|| self.instant(self.time(), self.end(), unwrapped(), during))
    }

    /// Returns the instant at a time from the start of the step until before its end; `None` for
    /// any other time.
    pub(super) fn inside(&self, time: f64) -> Option<Instant> {
        if time < self.began() || time >= self.time() {
            return None;
        }
        let state = self.group.state_within(self.lane, time - self.began());
        Some(self.instant(time, state, self.unwrapped_at(time), self.during()))
    }

    fn instant(
        &self,
        time: f64,
        state: Components,
        unwrapped: PerContact,
        phases: &[Phase],
    ) -> Instant {
        let forces = self.view.evaluator.forces(phases, &state);
        Instant { time, state, unwrapped, phases: phases.iter().copied().collect(), forces }
    }
}
