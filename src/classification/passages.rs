//! The latest passages of a run through the section that a contact marks, and the number of turns after which its orbit
//! appears to close.

use std::collections::VecDeque;

use super::closed_orbit::{Orbit, REACH};
use super::section::{Section, SectionMark};
use super::system_view::{Returning, SystemView};
use super::torus::ReturnSeries;
use crate::model::{Components, wrap_to_pi};
use crate::motion::{Phase, Phases};

/// Maximum number of returns after which an orbit may close.
const MOST_TURNS: usize = 16;
/// Maximum number of turns of a contact that goes round after which an orbit may close.
const MOST_ROUNDS: usize = 12;
/// Largest distance of a near return from an earlier passage, non-dimensional, times the number of
/// turns: examining a longer orbit costs more.
const NEAR: f64 = 1e-3;
/// Number of successive returns that must be near.
const NEAR_RETURNS: usize = 3;
/// Number of successive returns that must be near if they do not approach monotonically: an orbit
/// may be approached in a spiral.
const CLOSE_RETURNS: usize = 16;
/// Largest distance of the latest passage from an earlier one, non-dimensional, at which the orbit of a run that would end
/// undecided is examined.
const NEAR_AT_END: f64 = 1e-2;

/// Distances above this one count as equally far: no orbit with such a distance is examined.
const FAR: f64 = MOST_TURNS as f64 * NEAR_AT_END;

/// Returns the maximum number of returns to the section of a mark after which an orbit may close.
fn most_turns(mark: SectionMark) -> usize {
    match mark {
        SectionMark::Round { .. } => MOST_ROUNDS,
        _ => MOST_TURNS,
    }
}

fn near(turns: usize) -> f64 {
    NEAR / turns as f64
}

/// A passage through the section.
#[derive(Clone, Debug)]
pub(super) struct Passage {
    pub(super) time: f64,
    pub(super) state: Components,
    pub(super) phases: Phases,
    /// Distance from the passage `turns` turns earlier.
    differences: [f64; MOST_TURNS + 1],
}

impl Passage {
    /// Creates a passage in a step with these phases.
    pub(super) fn new((time, state): (f64, Components), phases: &[Phase]) -> Self {
        let differences = [f64::INFINITY; MOST_TURNS + 1];
        Passage { time, state, phases: Phases::from_slice(phases), differences }
    }
}

/// The latest passages through one section.
#[derive(Clone, Debug, Default)]
pub(super) struct Passages {
    /// What marks the section, once it is known.
    pub(super) mark: Option<SectionMark>,
    latest: VecDeque<Passage>,
    /// A smooth function of the state at all passages.
    returns: ReturnSeries,
    near_in_a_row: [usize; MOST_TURNS + 1],
    close_in_a_row: [usize; MOST_TURNS + 1],
    /// An unstable closed orbit that the run has approached, and the number of turns after which it
    /// appeared to close.
    pub(super) unstable: Option<(usize, Box<Orbit>)>,
}

impl Passages {
    /// Forgets all passages.
    pub(super) fn restart(&mut self) {
        let latest = std::mem::take(&mut self.latest);
        *self = Passages { latest, ..Passages::default() };
        self.latest.clear();
    }

    /// Returns whether the run has come back to the section.
    pub(super) fn has_returned(&self) -> bool {
        self.count() > 1
    }

    /// Returns the number of passages.
    pub(super) fn count(&self) -> usize {
        self.latest.len()
    }

    /// Returns the passage some turns before the latest one.
    pub(super) fn before(&self, turns: usize) -> Option<&Passage> {
        self.latest.iter().nth_back(turns)
    }

    /// Returns the passages, the latest one first.
    pub(super) fn backwards(&self) -> impl Iterator<Item = &Passage> {
        self.latest.iter().rev()
    }

    /// Returns the time since the earliest of the passages.
    pub(super) fn looked_at(&self) -> f64 {
        let time = |passage: Option<&Passage>| passage.map_or(0.0, |passage| passage.time);
        time(self.latest.back()) - time(self.latest.front())
    }

    /// Records a passage. Returns the least number of turns after which the orbit appears to close:
    /// several successive returns are near, and nearer than an earlier return or as near as the
    /// tolerances allow; or many are near.
    pub(super) fn record(
        &mut self,
        (view, closure): (&SystemView, f64),
        mark: SectionMark,
        mut passage: Passage,
    ) -> Option<usize> {
        self.mark = Some(mark);
        self.returns.add(observed(view, &passage, mark));
        let mut closing = None;
        for turns in 1..=most_turns(mark).min(self.latest.len()) {
            let earlier = &self.latest[self.latest.len() - turns];
            let distance = difference(view, earlier, &passage, mark);
            passage.differences[turns] = distance;
            let before = earlier.differences[turns];
            // If the approach is so slow that the limit of its geometric series is out of reach,
            // the returns drift.
            let in_reach = distance * distance <= REACH * (before - distance);
            let approaches = distance < before && in_reach || distance <= closure;
            let close = earlier.phases == passage.phases && distance <= near(turns);
            let one_more = |before: usize, is: bool| if is { before + 1 } else { 0 };
            let (near_in_a_row, close_in_a_row) =
                (&mut self.near_in_a_row[turns], &mut self.close_in_a_row[turns]);
            *near_in_a_row = one_more(*near_in_a_row, close && approaches);
            *close_in_a_row = one_more(*close_in_a_row, close);
            let closes = *near_in_a_row >= NEAR_RETURNS.max(turns)
                || *close_in_a_row >= CLOSE_RETURNS.max(4 * turns);
            if closes && closing.is_none() {
                closing = Some(turns);
            }
        }
        if self.latest.len() > most_turns(mark) {
            self.latest.pop_front();
        }
        self.latest.push_back(passage);
        closing
    }

    /// Returns whether the passages fill a torus.
    pub(super) fn fill_a_torus(&self) -> bool {
        self.returns.fill_a_torus()
    }

    /// Returns the unstable orbit on which the run nearly closes at its latest passage: only a
    /// symmetry or too short a run has prevented its departure.
    pub(super) fn unstable_orbit(&self) -> Option<&Orbit> {
        let (turns, orbit) = self.unstable.as_ref()?;
        let closes = self.latest.back()?.differences[*turns] <= near(*turns);
        closes.then_some(orbit)
    }

    /// Returns the number of turns after which the orbit nearly closes at the end of a run, and the distance times this number.
    /// The function minimises this product: more turns must close better, because their examination costs more. For a contact
    /// that may stop, it takes the fewest turns, because each turn of such a contact takes more steps.
    /// Differences of at most `closed` are equal.
    pub(super) fn closes_at_end(&self, closed: f64) -> Option<(usize, f64)> {
        let passage = self.latest.back()?;
        let rank = |turns: &usize| passage.differences[*turns].max(closed) * *turns as f64;
        let has_phases = |turns: &usize| {
            self.before(*turns).is_some_and(|earlier| earlier.phases == passage.phases)
        };
        let nearly = |turns: &usize| passage.differences[*turns] <= NEAR_AT_END;
        let mut closing = (1..=MOST_TURNS).filter(has_phases);
        let turns = match self.mark? {
            SectionMark::Round { may_stop: true, .. } => closing.find(nearly),
            _ => closing.min_by(|left, right| rank(left).total_cmp(&rank(right))).filter(nearly),
        }?;
        Some((turns, rank(&turns)))
    }

    /// Returns the section of an orbit that appears to close after this number of turns; `last_switches` are the times at
    /// which the contacts last changed their phases.
    pub(super) fn section(
        &self,
        view: &SystemView,
        turns: usize,
        last_switches: &[f64],
    ) -> Option<Section> {
        let (passage, earlier) = (self.latest.back()?, self.before(turns)?.time);
        let rests = passage.phases.iter().zip(last_switches).take(view.contacts.len());
        let rests = rests.map(|(phase, last)| *phase == Phase::Stick && *last < earlier).collect();
        Some(Section::new(view, self.mark?, &passage.phases, rests))
    }
}

/// Returns the components that count in passages with these phases: all that return but for the one that marks the section and residual
/// speeds of contacts that stick, numbered from 1.
fn counted<'a>(
    view: &'a SystemView,
    phases: &'a [Phase],
    mark: SectionMark,
) -> impl Iterator<Item = (u32, &'a Returning)> {
    let marking = mark.marking(view).component;
    (1..).zip(&view.returning).filter(move |(_, Returning { place, speed_of, .. })| {
        *place != marking && speed_of.is_none_or(|contact| phases[contact] != Phase::Stick)
    })
}

/// Returns a smooth function of a passage, in which all of its coordinates occur.
fn observed(view: &SystemView, passage: &Passage, mark: SectionMark) -> f64 {
    // Different weights, so that no symmetry cancels.
    let weighted = |(number, of): (u32, &Returning)| {
        let value = view.translations.remaining(|place| passage.state[place], of.place);
        let value = if of.is_angle { libm::sin(value + 1.0) } else { value };
        (1.0 + 0.29 * f64::from(number)) * value
    };
    counted(view, &passage.phases, mark).map(weighted).sum()
}

/// Returns the largest difference of two passages, with angles modulo 2π. If a difference is above [`FAR`], the function may
/// return this difference instead.
fn difference(view: &SystemView, a: &Passage, b: &Passage, mark: SectionMark) -> f64 {
    let mut largest: f64 = 0.0;
    for (_, of) in counted(view, &a.phases, mark) {
        let change = |place: usize| a.state[place] - b.state[place];
        let change = view.translations.remaining(change, of.place);
        largest = largest.max(if of.is_angle { wrap_to_pi(change) } else { change }.abs());
        if largest > FAR {
            break;
        }
    }
    largest
}
