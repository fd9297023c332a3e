//! Closed orbits: evidence that a run has settled on a limit cycle.
//!
//! A running ball revolves in the ring, so that an orbit closes only modulo 2π. The section is the
//! ball's passage through the angle 0; the return map takes the state at one passage to that some
//! turns later. An orbit is a limit cycle by three criteria:
//!
//! 1. it closes: from a near return of the run, Newton's method on the return map finds an orbit
//!    that closes within a small multiple of the tolerances, and the run is attracted to it;
//! 2. it is stable: all multipliers, the eigenvalues of the derivative of the return map through
//!    all switches, lie inside the unit circle;
//! 3. resting balls keep a friction margin throughout. Where such a ball rests does not change from
//!    one return to the next: these neutral directions (the cycles form a continuous family) are
//!    excluded from the map and counted instead of being mistaken for instability.
//!
//! At least one ball must revolve without stopping; the others may run, rest, or stick and slip.

use std::cell::{Cell, RefCell};
use std::collections::VecDeque;
use std::sync::Arc;

use super::closed_orbit::{Orbit, REACH, Verdict, examine, least_returns};
use super::lane_step::LaneStep;
use super::return_map::ReturnMap;
use super::section::{Mark, Section};
use super::step_limit::{MOST_LOOKS, MOST_STEPS_OF_A_LOOK};
use super::system_view::{ContactPlace, SystemView};
use crate::model::{Components, wrap_to_pi};
use crate::motion::{Direction, Evaluator, Motion, Phase, Phases, Settings, Tolerance};

/// Maximum number of turns of the running ball after which an orbit may close.
const MOST_TURNS: usize = 12;
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
/// An examination at the end of a run is not begun if it would take this many times the steps that it may take, at the mean
/// rate of the run: it takes more, because its tolerances are finer.
const HOPELESS: f64 = 1.25;
/// Largest closing error of an examined orbit, for any tolerances of the run, because the orbit is
/// computed with finer ones. It corresponds to the default tolerances. With a larger error, a
/// slowly converging spiral would itself count as closed.
const CLOSED: f64 = 1.01e-6;

fn near(turns: usize) -> f64 {
    NEAR / turns as f64
}

/// A passage of the running ball through the section.
#[derive(Clone, Debug)]
struct Passage {
    time: f64,
    state: Components,
    phases: Phases,
    /// Distance from the passage `turns` turns earlier.
    differences: [f64; MOST_TURNS + 1],
}

/// A step in which a contact may have passed through the section.
pub(super) struct Passing<'a> {
    /// What marks the section.
    pub(super) mark: Mark,
    /// Time and state of the passage.
    pub(super) passage: Option<(f64, Components)>,
    /// The contacts' phases in the step, before a switch at its end.
    pub(super) phases: &'a [Phase],
    /// When each contact last changed its phase.
    pub(super) last_switches: &'a [f64],
}

/// Detects closing orbits in a motion.
#[derive(Clone, Debug)]
pub struct OrbitWatch {
    view: Arc<SystemView>,
    closure: f64,
    /// What marks the section, once it is known.
    mark: Option<Mark>,
    /// The maxima of positions that may mark the section of a system without contacts that go round.
    maxima: Vec<Mark>,
    passages: VecDeque<Passage>,
    near_in_a_row: [usize; MOST_TURNS + 1],
    close_in_a_row: [usize; MOST_TURNS + 1],
    attempts: u32,
    wait_until: f64,
    /// An unstable closed orbit that the run has approached, and the number of turns after which it
    /// appeared to close.
    unstable: Option<(usize, Box<Orbit>)>,
}

impl OrbitWatch {
    /// Creates a watch for motions of a system computed with `settings`.
    pub fn new(settings: &Settings, evaluator: &Evaluator) -> Self {
        OrbitWatch::of(settings, Arc::new(SystemView::new(evaluator.clone())))
    }

    pub(super) fn of(settings: &Settings, view: Arc<SystemView>) -> Self {
        let Tolerance { relative, absolute } = settings.tolerance;
        OrbitWatch {
            maxima: if view.revolves() { Vec::new() } else { maxima(&view) },
            view,
            closure: 100.0 * (relative + absolute),
            mark: None,
            passages: VecDeque::with_capacity(MOST_TURNS + 2),
            near_in_a_row: [0; MOST_TURNS + 1],
            close_in_a_row: [0; MOST_TURNS + 1],
            attempts: 0,
            wait_until: 0.0,
            unstable: None,
        }
    }

    /// Examines the motion's latest step. Returns the limit cycle that the run has been shown to be
    /// on, which is `None` after most steps.
    pub fn look(&mut self, settings: &Settings, motion: &Motion) -> Option<Orbit> {
        let mut end = motion.state();
        let within = motion.within_last_step(motion.time())?;
        for contact in &self.view.contacts {
            end[contact.position] = within[contact.position];
        }
        let mark = self.goes_round(motion.phases(), &end)?;
        let passage = motion.passage(mark.contact());
        let (phases, last_switches) = (motion.phases_during_step(), motion.last_switches());
        let passing = Passing { mark, passage, phases, last_switches };
        self.take_in(settings, passing)
    }

    /// Returns the mark of a contact that has gone round in a step, if it marks the section or may do so.
    /// `phases` and `state` are those at the step's end, with angles not yet reduced to one turn.
    pub(super) fn goes_round(&mut self, phases: &[Phase], state: &[f64]) -> Option<Mark> {
        let view = &self.view;
        let speed = |contact: usize| view.speed(phases, state, contact);
        let goes_on = |mark: &Mark| match *mark {
            Mark::Round { contact, direction } => {
                !phases[contact].in_band() && direction * speed(contact) > 0.0
            }
            Mark::Maximum { .. } => true,
        };
        let round = |contact: usize| {
            let place = view.contacts[contact];
            let once = 0.0..std::f64::consts::TAU;
            let has_gone_round = place.angular && !once.contains(&state[place.position]);
            let mark = || Mark::Round { contact, direction: speed(contact).signum() };
            has_gone_round.then(mark)
        };
        let own = self.mark.filter(goes_on);
        let found = match own {
            Some(own) => round(own.contact()),
            None => (0..view.contacts.len()).find_map(round),
        };
        if own.is_none() && self.mark.is_some() {
            self.restart();
        }
        found
    }

    /// Returns the mark of the latest step and its passage, if the position of a contact was at a maximum in it and marks the
    /// section or may do so.
    pub(super) fn maximum(&self, step: &LaneStep) -> Option<(Mark, (f64, Components))> {
        let passed = |mark: Mark| {
            let (component, value) = mark.component(step.view);
            let within = |after: f64| step.group.state_within(step.lane, after);
            let falls = within(0.0)[component] > value;
            let passes = || step.passes_through_zero(|state| state[component] - value);
            let time = falls.then(passes)??;
            Some((mark, (time, within(time - step.began()))))
        };
        match self.mark {
            Some(mark) => passed(mark),
            None => self.maxima.iter().find_map(|mark| passed(*mark)),
        }
    }

    /// Returns whether the section is marked by maxima, for which each step must be examined.
    pub(super) fn marks_maxima(&self) -> bool {
        !self.maxima.is_empty()
    }

    /// Adds the latest step of a motion. Returns the limit cycle
    /// that the run has been shown to be on.
    pub(super) fn take_in(&mut self, settings: &Settings, passing: Passing) -> Option<Orbit> {
        let Passing { mark, passage, phases, last_switches } = passing;
        let Some((time, state)) = passage else {
            self.restart();
            return None;
        };
        let differences = [f64::INFINITY; MOST_TURNS + 1];
        let phases = Phases::from_slice(phases);
        let passage = Passage { time, state, phases, differences };
        self.mark = Some(mark);
        let turns = self.record(mark, passage)?;
        if self.attempts >= MOST_LOOKS || time < self.wait_until {
            return None;
        }
        self.attempts += 1;
        // After an inconclusive examination the motion gets time to settle, longer each time.
        let looked_at = time - self.passages.front()?.time;
        self.wait_until = time + f64::from(1 << self.attempts) * looked_at;
        let most_steps = MOST_STEPS_OF_A_LOOK;
        match self.examine(settings, (mark, turns), last_switches, (most_steps, false)) {
            Verdict::Stable(orbit) => return Some(orbit),
            Verdict::Unstable(orbit) => self.unstable = Some((turns, Box::new(orbit))),
            Verdict::Open => {}
        }
        None
    }

    /// Returns the unstable orbit on which the run nearly closes at its latest passage: only a
    /// symmetry or too short a run has prevented its departure.
    pub fn unstable_orbit(&self) -> Option<&Orbit> {
        let (turns, orbit) = self.unstable.as_ref()?;
        let closes = self.passages.back()?.differences[*turns] <= near(*turns);
        closes.then_some(orbit)
    }

    /// Examines the orbit of a run that ends otherwise undecided, from farther away than during the run, in at most as many
    /// steps as the run has taken. Returns the limit cycle that the run has been shown to approach.
    pub(super) fn look_at_end(
        &self,
        settings: &Settings,
        last_switches: &[f64],
        steps: u64,
    ) -> Option<Orbit> {
        let mark = self.mark?;
        let (passage, before) = (self.passages.back()?, self.passages.len() - 1);
        let closes = |turns: &usize| self.passages[before - turns].phases == passage.phases;
        // More turns must close better: examining them costs more.
        let rank = |turns: &usize| passage.differences[*turns] * *turns as f64;
        let turns = (1..=MOST_TURNS.min(before))
            .filter(closes)
            .min_by(|one, other| rank(one).total_cmp(&rank(other)))
            .filter(|turns| passage.differences[*turns] <= NEAR_AT_END)?;
        // The steps of a return, if the run takes them at its mean rate.
        let period = passage.time - self.passages[before - turns].time;
        let of_return = steps as f64 * period / passage.time;
        let section = self.section((mark, turns), last_switches)?;
        let returns = 2 * least_returns(&section) - 1;
        if of_return * returns as f64 > HOPELESS * steps as f64 {
            return None;
        }
        match self.examine(settings, (mark, turns), last_switches, (steps, true)) {
            Verdict::Stable(orbit) => Some(orbit),
            Verdict::Unstable(_) | Verdict::Open => None,
        }
    }

    fn restart(&mut self) {
        self.mark = None;
        self.passages.clear();
        self.near_in_a_row = [0; MOST_TURNS + 1];
        self.close_in_a_row = [0; MOST_TURNS + 1];
        self.unstable = None;
    }

    /// Records a passage. Returns the least number of turns after which the orbit appears to close:
    /// several successive returns are near, and nearer than an earlier return or as near as the
    /// tolerances allow; or many are near.
    fn record(&mut self, mark: Mark, mut passage: Passage) -> Option<usize> {
        let mut closing = None;
        for turns in 1..=MOST_TURNS.min(self.passages.len()) {
            let earlier = &self.passages[self.passages.len() - turns];
            let distance = difference(&self.view, earlier, &passage, mark);
            passage.differences[turns] = distance;
            let before = earlier.differences[turns];
            // If the approach is so slow that the limit of its geometric series is out of reach,
            // the returns drift.
            let in_reach = distance * distance <= REACH * (before - distance);
            let approaches = distance < before && in_reach || distance <= self.closure;
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
        if self.passages.len() > MOST_TURNS {
            self.passages.pop_front();
        }
        self.passages.push_back(passage);
        closing
    }

    /// Returns the section of an orbit that appears to close after this number of turns.
    fn section(&self, (mark, turns): (Mark, usize), last_switches: &[f64]) -> Option<Section> {
        let passage = self.passages.back()?;
        let earlier = self.passages[self.passages.len() - 1 - turns].time;
        let rests = passage.phases.iter().zip(last_switches).take(self.view.contacts.len());
        let rests = rests.map(|(phase, last)| *phase == Phase::Stick && *last < earlier).collect();
        Some(Section::new(&self.view, mark, &passage.phases, rests))
    }

    /// Examines the orbit that appears to close after this number of turns, in at most `most_steps`.
    /// If `only_stable`, an orbit from which disturbances grow is not sought to the end.
    fn examine(
        &self,
        settings: &Settings,
        (mark, turns): (Mark, usize),
        last_switches: &[f64],
        (most_steps, only_stable): (u64, bool),
    ) -> Verdict {
        let Some(passage) = self.passages.back() else { return Verdict::Open };
        let Some(section) = self.section((mark, turns), last_switches) else {
            return Verdict::Open;
        };
        let earlier = self.passages[self.passages.len() - 1 - turns].time;
        let (steps_left, latest) = (Cell::new(most_steps), RefCell::new(None));
        let map = ReturnMap {
            view: &self.view,
            steps_left: &steps_left,
            latest: &latest,
            only_stable,
            settings: Settings {
                tolerance: Tolerance {
                    relative: settings.tolerance.relative.min(1e-10),
                    absolute: settings.tolerance.absolute.min(1e-12),
                },
                effort_limit: 1_000_000,
                ..*settings
            },
            section: &section,
            turns,
            longest: 2.0 * (passage.time - earlier),
        };
        let returns = self.passages.iter().rev().step_by(turns);
        let mut passed: Vec<&Components> = returns
            .take_while(|earlier| earlier.phases == passage.phases)
            .map(|passage| &passage.state)
            .collect();
        passed.reverse();
        examine(map, &passed, self.closure.min(CLOSED)).unwrap_or(Verdict::Open)
    }
}

/// Returns the marks at the maxima of positions. The contact must slip there: the speed of its position differs from its
/// sliding speed, always by the same amount, as on a belt.
pub(super) fn maxima(view: &SystemView) -> Vec<Mark> {
    let phases = Phases::from_elem(Phase::Slip(Direction::Forward), view.contacts.len());
    let gaps = view.evaluator.graph().gaps.len();
    let phases: Phases = phases.into_iter().chain((0..gaps).map(|_| Phase::Open)).collect();
    let probe = |scale: f64| -> Vec<f64> {
        (0..view.dimension()).map(|component| scale * (0.3 + 0.07 * component as f64)).collect()
    };
    let mark = |(contact, place): (usize, &ContactPlace)| {
        let component = place.speed?;
        let [one, other] = [1.0, -0.5].map(|scale| {
            let state = probe(scale);
            state[component] - view.evaluator.rates(&phases, &state)[place.position]
        });
        let same = (one - other).abs() <= 1e-12 * one.abs();
        (same && one != 0.0).then_some(Mark::Maximum { contact, speed: one })
    };
    view.contacts.iter().enumerate().filter_map(mark).collect()
}

/// Returns the largest difference of two passages, angles modulo 2π. The residual speed of a
/// sticking ball does not count.
fn difference(view: &SystemView, a: &Passage, b: &Passage, mark: Mark) -> f64 {
    let (marking, _) = mark.component(view);
    let (state_a, state_b): (&[f64], &[f64]) = (&a.state, &b.state);
    let phases: &[Phase] = &a.phases;
    let change = |place: usize| state_a[place] - state_b[place];
    let mut largest: f64 = 0.0;
    for &place in &view.free {
        largest = largest.max(change(place).abs());
    }
    for (index, contact) in view.contacts.iter().enumerate() {
        if phases[index] != Phase::Stick
            && let Some(speed) = contact.speed.filter(|speed| *speed != marking)
        {
            largest = largest.max(change(speed).abs());
        }
        if contact.position != marking {
            let change = change(contact.position);
            let change = if contact.angular { wrap_to_pi(change) } else { change };
            largest = largest.max(change.abs());
        }
    }
    largest
}
