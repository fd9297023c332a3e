//! The least and the greatest position of each contact after a given time.

use smallvec::SmallVec;

use super::lane_step::LaneStep;
use super::system_view::ContactPlace;
use crate::motion::PerContact;

/// Extremes after a given time, which may lie within a step.
#[derive(Clone, Debug)]
pub(super) struct Extremes {
    start: f64,
    /// Of each contact; empty before the start.
    ranges: SmallVec<[[f64; 2]; 1]>,
}

/// A step: the contacts' positions at its end, and at their turning points in it.
pub(super) struct Passed {
    /// Time, contact, and the contact's position.
    turns: SmallVec<[(f64, usize, f64); 1]>,
    end: PerContact,
}

impl Passed {
    /// Evaluates a step.
    pub(super) fn of(step: &LaneStep) -> Self {
        let turn = |(index, contact): (usize, &ContactPlace)| {
            let time = step.turns_back(contact.position)?;
            Some((time, index, step.unwrapped_at(time)[index]))
        };
        let turns = step.view.contacts.iter().enumerate().filter_map(turn).collect();
        Passed { turns, end: step.unwrapped() }
    }
}

impl Extremes {
    /// Starts at a time.
    pub(super) fn from(start: f64) -> Self {
        Extremes { start, ranges: SmallVec::new() }
    }

    /// Starts at a time and the positions then.
    pub(super) fn from_place(start: f64, positions: &[f64]) -> Self {
        Extremes { start, ranges: positions.iter().map(|position| [*position; 2]).collect() }
    }

    /// Returns the least and the greatest position of a contact.
    pub(super) fn of(&self, contact: usize) -> Option<[f64; 2]> {
        self.ranges.get(contact).copied()
    }

    /// Returns the time from which on the extremes are taken.
    pub(super) fn start(&self) -> f64 {
        self.start
    }

    /// Adds a step.
    pub(super) fn take_in(&mut self, step: &LaneStep, passed: &Passed) {
        if step.time() < self.start {
            return;
        }
        if self.ranges.is_empty() {
            let first = step.unwrapped_at(self.start.max(step.began()));
            *self = Extremes::from_place(self.start, &first);
        }
        let turns = passed.turns.iter().filter(|(time, ..)| *time >= self.start);
        let turns = turns.map(|(_, contact, position)| (*contact, *position));
        for (contact, position) in turns.chain(passed.end.iter().copied().enumerate()) {
            let [low, high] = &mut self.ranges[contact];
            *low = low.min(position);
            *high = high.max(position);
        }
    }

    /// Returns the largest of the contacts' half distances between their extremes; `None` if no
    /// step was added.
    pub(super) fn amplitude(&self) -> Option<f64> {
        self.ranges.iter().map(|[low, high]| 0.5 * (high - low)).reduce(f64::max)
    }
}
