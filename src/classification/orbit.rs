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
//! A ball that revolves without stopping marks the section. If there is no such ball, a ball that stops or turns back on its way
//! marks the section. The other balls may run, rest, or stick and slip.

use std::cell::Cell;
use std::sync::Arc;

use super::closed_orbit::{Orbit, PassageState, Verdict, examine};
use super::ending::Ending;
use super::lane_step::LaneStep;
use super::passages::{Passage, Passages};
use super::periodic_creep::{Creep, creep};
use super::return_map::ReturnMap;
use super::section::{RESOLVED, Section, SectionMark, marks};
use super::step_limit::{MOST_LOOKS, MOST_STEPS_OF_A_LOOK};
use super::system_view::SystemView;
use crate::model::{Components, Endings};
use crate::motion::{Phase, Settings, Tolerance};

/// The orbit of a run is examined at its end only if its end time is at least this many times the time of a return.
const LEAST_RETURNS: f64 = 14.0;
/// A contact that has passed more often than this without a stop marks the section alone: the passages of contacts that stop
/// are then forgotten.
const LASTING: usize = 2;
/// Largest closing error of an examined orbit, for any tolerances of the run, because the orbit is
/// computed with finer ones. It corresponds to the default tolerances. With a larger error, a
/// slowly converging spiral would itself count as closed.
const CLOSED: f64 = 1.01e-6;

/// Detects closing orbits in a motion.
#[derive(Clone, Debug)]
pub(super) struct OrbitWatch {
    view: Arc<SystemView>,
    closure: f64,
    /// What marks the section if no contact goes round, each with its passages: periods of the forcing, angles, or turning points.
    marked: Vec<(SectionMark, Passages)>,
    /// The passages of a contact that goes round without stopping.
    unbroken: Passages,
    /// For each contact, which may stop, its passages in one direction, and the number of passages in the other direction since
    /// the latest passage in this direction.
    with_stops: Vec<(Passages, u32)>,
    /// The number of examinations so far, and the time before which the next examination may not begin: first for orbits of
    /// `unbroken` and `marked`, then for orbits of `with_stops`.
    looks: [(u32, f64); 2],
}

impl OrbitWatch {
    /// Creates a watch for motions of a system computed with `settings`; `None` if no orbits are sought, or nothing marks any.
    pub(super) fn new(
        endings: Endings,
        settings: &Settings,
        view: &Arc<SystemView>,
    ) -> Option<Box<Self>> {
        let Tolerance { relative, absolute } = settings.tolerance;
        let watch = || OrbitWatch {
            marked: marks(view).into_iter().map(|mark| (mark, Passages::default())).collect(),
            with_stops: vec![(Passages::default(), 0); view.contacts.len()],
            view: Arc::clone(view),
            closure: 100.0 * (relative + absolute),
            unbroken: Passages::default(),
            looks: [(0, 0.0); 2],
        };
        let watch = (endings == Endings::All).then(watch);
        watch.filter(|watch| view.revolves() || watch.sees_each_step()).map(Box::new)
    }

    /// Returns whether each step must be examined for a mark.
    pub(super) fn sees_each_step(&self) -> bool {
        !self.marked.is_empty()
    }

    /// Adds the latest step of a run. Returns the closed orbit that the run has been shown to be on.
    pub(super) fn closes(&mut self, settings: &Settings, step: &LaneStep) -> Option<Orbit> {
        if self.sees_each_step() {
            return self.passes_marks(settings, step);
        }
        let end = step.end();
        let found = self.goes_round(step.phases(), &end).and_then(|mark| {
            let passage = step.group.passage(step.lane, mark.contact()?);
            self.passes(settings, step, mark, passage)
        });
        found.or_else(|| self.passes_with_stops(settings, step, &end))
    }

    /// Returns the mark of a contact that has gone round in a step, if it marks the section or may do so.
    /// `phases` and `state` are those at the step's end, with angles not yet reduced to one turn.
    fn goes_round(&mut self, phases: &[Phase], state: &[f64]) -> Option<SectionMark> {
        let view = &self.view;
        let speed = |contact: usize| view.speed(state, contact);
        let goes_on = |mark: &SectionMark| match *mark {
            SectionMark::Round { contact, direction, .. } => {
                !phases[contact].in_band() && direction * speed(contact) > 0.0
            }
            _ => true,
        };
        let round = |contact: usize| {
            let direction = speed(contact).signum();
            let mark = || SectionMark::Round { contact, direction, may_stop: false };
            view.completes_turn(state, contact).is_some().then(mark)
        };
        let kept = self.unbroken.mark.filter(goes_on);
        let found = match kept {
            Some(kept) => kept.contact().and_then(round),
            None => (0..view.contacts.len()).find_map(round),
        };
        if kept.is_none() && self.unbroken.mark.is_some() {
            self.unbroken.restart();
        }
        found
    }

    /// Adds the passages of all marks in the latest step.
    fn passes_marks(&mut self, settings: &Settings, step: &LaneStep) -> Option<Orbit> {
        let view = Arc::clone(&self.view);
        let mut found = None;
        for (mark, passages) in &mut self.marked {
            let Some(passage) = passage_of(*mark, step) else { continue };
            let passage = Passage::new(passage, step.during());
            let Some(turns) = passages.record((&view, self.closure), *mark, passage) else {
                continue;
            };
            if found.is_none() && may_look(&mut self.looks[0], passages) {
                found = examine_now(passages, (&view, self.closure), settings, turns, step);
            }
        }
        found
    }

    /// Adds a passage in the latest step through the section of a contact that does not stop.
    fn passes(
        &mut self,
        settings: &Settings,
        step: &LaneStep,
        mark: SectionMark,
        passage: Option<(f64, Components)>,
    ) -> Option<Orbit> {
        let Some(passage) = passage else {
            self.unbroken.restart();
            return None;
        };
        let (view, closure) = (Arc::clone(&self.view), self.closure);
        let passage = Passage::new(passage, step.during());
        let turns = self.unbroken.record((&view, closure), mark, passage)?;
        let look = may_look(&mut self.looks[0], &self.unbroken);
        look.then(|| examine_now(&mut self.unbroken, (&view, closure), settings, turns, step))?
    }

    /// Adds the passages in the latest step of all contacts, which may stop on their way. Their orbits are examined if no
    /// contact goes round without stopping.
    fn passes_with_stops(
        &mut self,
        settings: &Settings,
        step: &LaneStep,
        end: &[f64],
    ) -> Option<Orbit> {
        let view = Arc::clone(&self.view);
        let unneeded = self.unbroken.count() > LASTING;
        for (contact, (passages, against)) in self.with_stops.iter_mut().enumerate() {
            let Some(direction) = view.completes_turn(end, contact) else { continue };
            if unneeded {
                if passages.count() > 0 {
                    passages.restart();
                }
                continue;
            }
            let mark = SectionMark::Round { contact, direction, may_stop: true };
            if passages.mark.is_some_and(|known| known != mark) {
                *against += 1;
                if *against < 2 {
                    continue;
                }
                passages.restart();
            }
            *against = 0;
            let Some(passage) = step.group.passage(step.lane, contact) else {
                passages.restart();
                continue;
            };
            let passage = Passage::new(passage, step.during());
            let turns = passages.record((&view, self.closure), mark, passage);
            let Some(turns) = turns.filter(|_| !self.unbroken.has_returned()) else { continue };
            if may_look(&mut self.looks[1], passages) {
                let with = (&*view, self.closure);
                return examine_now(passages, with, settings, turns, step);
            }
        }
        None
    }

    /// Returns the unstable orbit on which the run nearly closes at its latest passage.
    pub(super) fn unstable_orbit(&self) -> Option<&Orbit> {
        self.at_end().find_map(Passages::unstable_orbit)
    }

    /// Returns whether the run fills a torus.
    pub(super) fn fills_a_torus(&self) -> bool {
        self.at_end().any(Passages::fill_a_torus)
    }

    /// Returns how a run with a forcing creeps at its end.
    fn creep(&self, settings: &Settings) -> Option<Creep> {
        let mut marked = self.marked.iter();
        let (_, passages) = marked.find(|(mark, _)| matches!(mark, SectionMark::Period(_)))?;
        if passages.unstable_orbit().is_some() {
            return None;
        }
        // The displacement of every contact counts: none rests throughout.
        let none_rests = vec![f64::INFINITY; self.view.contacts.len()];
        let section = passages.section(&self.view, 1, &none_rests)?;
        let left = Cell::new(MOST_STEPS_OF_A_LOOK);
        let map = return_map(passages, (&self.view, &section), settings, 1, &left)?;
        creep(map, &passed(passages))
    }

    /// Returns the passages that count at the end of a run.
    fn at_end(&self) -> impl Iterator<Item = &Passages> {
        let with_stops = self.with_stops.iter().map(|(passages, _)| passages);
        let unbroken = self.unbroken.has_returned();
        let marked = self.marked.iter().map(|(_, passages)| passages);
        let others = with_stops.filter(move |_| !unbroken);
        std::iter::once(&self.unbroken).chain(marked).chain(others)
    }

    /// Evaluates a run that ends otherwise undecided after some steps; `last_switches` are the times at which its contacts
    /// last changed their phases. Returns the ending if the run approaches or repeats a closed orbit, or creeps.
    pub(super) fn closes_at_end(
        &self,
        settings: &Settings,
        last_switches: &[f64],
        steps: u64,
    ) -> Option<Ending> {
        let orbit = self.look_at_end(settings, last_switches, steps);
        // What creeps a little repeats nearly.
        let may_creep = orbit.as_ref().is_none_or(|orbit| !orbit.attracts);
        let creep = may_creep.then(|| self.creep(settings)).flatten();
        let creep = creep.map(|creep| Ending::Creep(Box::new(creep)));
        creep.or_else(|| Some(Ending::Orbit(Box::new(orbit?))))
    }

    /// Examines the orbit of a run that ends otherwise undecided, from farther away than during the run, in at most as many
    /// steps as the run has taken. Returns the closed orbit that the run has been shown to approach or to repeat.
    fn look_at_end(&self, settings: &Settings, last_switches: &[f64], steps: u64) -> Option<Orbit> {
        let closing = self
            .at_end()
            .filter_map(|passages| Some((passages, passages.closes_at_end(0.01 * self.closure)?)));
        let best = closing.min_by(|(_, (_, left)), (_, (_, right))| left.total_cmp(right));
        let (passages, (turns, _)) = best?;
        let (time, earlier) = (passages.before(0)?.time, passages.before(turns)?.time);
        if LEAST_RETURNS * (time - earlier) > time {
            return None;
        }
        let with = (&*self.view, self.closure);
        match examine_orbit(passages, with, settings, (turns, last_switches), (steps, true)) {
            Verdict::Stable(orbit) | Verdict::Repeats(orbit) => Some(orbit),
            Verdict::Unstable(_) | Verdict::Open => None,
        }
    }
}

/// Returns time and state of the passage of a mark in the latest step: the beginning of a period, an angle, or a turning point.
fn passage_of(mark: SectionMark, step: &LaneStep) -> Option<(f64, Components)> {
    let marking = mark.marking(step.view);
    let begun = marking.of(|place| step.component_at_start(place));
    let (target, from_above) = mark.next(step.view, begun);
    if (begun > target) != from_above {
        return None;
    }
    let end = marking.of(|place| step.component_at_end(place));
    let time = step.passes_through(&marking, [target, end])?;
    if [begun, end].iter().all(|end| (end - target).abs() <= RESOLVED) {
        return None;
    }
    let mut state = step.group.state_within(step.lane, time - step.began());
    marking.put_on(&mut state);
    Some((time, state))
}

/// Returns whether an orbit that appears to close is examined, and counts the examination. After an inconclusive examination,
/// the motion gets time to settle, and more time after each further examination.
fn may_look((looks, wait_until): &mut (u32, f64), passages: &Passages) -> bool {
    let time = passages.before(0).map_or(0.0, |passage| passage.time);
    if *looks >= MOST_LOOKS || time < *wait_until {
        return false;
    }
    *looks += 1;
    *wait_until = time + f64::from(1 << *looks) * passages.looked_at();
    true
}

/// Examines the orbit that appears to close after this number of turns. Returns it if the run approaches or repeats it.
fn examine_now(
    passages: &mut Passages,
    with: (&SystemView, f64),
    settings: &Settings,
    turns: usize,
    step: &LaneStep,
) -> Option<Orbit> {
    let last_switches = step.group.last_switches(step.lane);
    let limits = (MOST_STEPS_OF_A_LOOK, false);
    match examine_orbit(passages, with, settings, (turns, last_switches), limits) {
        Verdict::Stable(orbit) | Verdict::Repeats(orbit) => return Some(orbit),
        Verdict::Unstable(orbit) => passages.unstable = Some((turns, Box::new(orbit))),
        Verdict::Open => {}
    }
    None
}

/// Examines the orbit that appears to close after this number of turns, in at most `most_steps`.
/// If `only_stable`, an orbit from which disturbances grow is not sought to the end.
fn examine_orbit(
    passages: &Passages,
    (view, closure): (&SystemView, f64),
    settings: &Settings,
    (turns, last_switches): (usize, &[f64]),
    (most_steps, only_stable): (u64, bool),
) -> Verdict {
    let Some(section) = passages.section(view, turns, last_switches) else { return Verdict::Open };
    let left = Cell::new(most_steps);
    let Some(map) = return_map(passages, (view, &section), settings, turns, &left) else {
        return Verdict::Open;
    };
    let map = ReturnMap { only_stable, ..map };
    examine(map, &passed(passages), closure.min(CLOSED)).unwrap_or(Verdict::Open)
}

/// Returns the latest passages, the latest one first.
fn passed(passages: &Passages) -> Vec<PassageState<'_>> {
    passages.backwards().map(|passage| (&passage.phases, &passage.state)).collect()
}

/// Returns the map from one passage of a section to that some turns later, with finer tolerances than those of the run. It
/// takes its steps from `steps_left`.
fn return_map<'a>(
    passages: &Passages,
    (view, section): (&'a SystemView, &'a Section),
    settings: &Settings,
    turns: usize,
    steps_left: &'a Cell<u64>,
) -> Option<ReturnMap<'a>> {
    let time = |turns: usize| Some(passages.before(turns)?.time);
    Some(ReturnMap {
        view,
        steps_left,
        only_stable: false,
        settings: Settings {
            tolerance: Tolerance {
                relative: settings.tolerance.relative.min(1e-10),
                absolute: settings.tolerance.absolute.min(1e-12),
            },
            effort_limit: 1_000_000,
            ..*settings
        },
        section,
        turns,
        longest: 2.0 * (time(0)? - time(turns)?),
    })
}
