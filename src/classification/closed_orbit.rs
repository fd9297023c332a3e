//! A closed orbit near a run: found by shooting, with its stability from the Floquet multipliers.
//!
//! Newton's method on the return map, whose derivative is exact through all switches, finds the
//! orbit that closes; the eigenvalues of the same derivative there are its multipliers (R. Seydel,
//! *Practical Bifurcation and Stability Analysis*, 3rd ed., Springer 2010, chapter 7,
//! doi:10.1007/978-1-4419-1740-9).

use std::f64::consts::TAU;

use nalgebra::{DMatrix, DVector, Schur};

use super::cycle::{CyclePhase, TouchingPair};
use super::output_watch::OutputOutcome;
use super::period::Period;
use super::return_map::{Return, ReturnMap, cost_of_a_step};
use super::section::SectionMark;
use super::settled::SLOW;
use super::system_view::ContactPlace;
use crate::model::Components;
use crate::motion::Phases;

/// Largest distance of the closed orbit from the run, non-dimensional.
pub(super) const REACH: f64 = 1e-2;
/// Maximum number of turns for Newton's method; a turn with the derivative counts once per
/// dimension of the section.
const MOST_TURNS_FOLLOWED: usize = 200;
/// Multiple of the relative tolerance of the return map below which the closing error of an orbit
/// is not refined further.
const AT_BEST: f64 = 10.0;
/// Orbits at this distance on the section, or less, are the same.
const SAME_ORBIT: f64 = 1e-4;
/// Maximum number of returns within which the run must approach the orbit.
const MOST_RETURNS: usize = 400;
/// Number of returns over which the greatest distance is taken, because a spiral does not approach
/// monotonically.
const SPELL: usize = 10;
/// Number of returns over which the largest multiplier gives the required reduction of the distance, and bounds on this
/// reduction.
const RETURNS: i32 = 20;
const NEARER: (f64, f64) = (0.1, 0.8);
/// Multiple of the tolerances of the return map with which a run is followed on its approach: distances need fewer digits
/// than the orbit.
const COARSER: f64 = 100.0;
/// The least number of returns in each half of those in which a run has approached an orbit.
const LEAST_APPROACHED: usize = 4;
/// The least size of a closed orbit over the distance from the orbit that closes exactly. A motion that swings about an equilibrium
/// closes nearly, too.
const LEAST_SIZE: f64 = 10.0;
/// The largest part of its way that a contact may be displaced in a period of a closed orbit, and the least way that is not rounding.
const DISPLACED: f64 = 0.5;
const LEAST_WAY: f64 = 1e-12;
/// Distance from the unit circle below which a multiplier does not decide the stability, because
/// the orbit closes only to within the tolerances.
const MULTIPLIER_DOUBT: f64 = 1e-4;
/// The largest closing error of a motion that repeats, over its size, and the largest distance of its largest multiplier below 1.
const REPEATS: f64 = 1e-8;
const NEUTRAL: f64 = 1e-6;
/// A contact that sticks for a shorter part of the period touches the edge of sticking, within the accuracy of the run. Neighbours on
/// one side of such a motion do not stick, so that its multipliers say nothing about them.
const GRAZES: f64 = 1e-3;

/// A closed orbit.
#[derive(Clone, Debug, PartialEq)]
pub struct Orbit {
    /// Period, non-dimensional.
    pub period: f64,
    /// Net number of turns of each contact per period, with sign; 0 if its position is no angle.
    pub turns: Vec<i32>,
    /// The sequence of phases of the contacts.
    pub configurations: Vec<Vec<CyclePhase>>,
    /// The contacts that touch each other.
    pub touching: Vec<TouchingPair>,
    /// Mean speed of each contact, non-dimensional.
    pub speed: Vec<f64>,
    /// Least and greatest speed of each contact.
    pub speed_extremes: Vec<[f64; 2]>,
    /// Least and greatest position of each contact, an angle starting in [0, 2π).
    pub position_extremes: Vec<[f64; 2]>,
    /// The outputs over the period.
    pub outputs: Vec<OutputOutcome>,
    /// Share of the period for which each contact sticks.
    pub stick_fraction: Vec<f64>,
    /// Root mean square over the period of the displacement, over the unit of length; 0 for a
    /// system without a displacement that is measured.
    pub amplitude: f64,
    /// Greatest displacement, over the unit of length.
    pub peak: f64,
    /// Whether all contacts rest or stay apart throughout, in a system that a force drives.
    pub rests: bool,
    /// The smallest friction margin of a resting ball; `None` if no ball rests.
    pub margin: Option<f64>,
    /// Moduli of the multipliers, without those of neutral directions, descending.
    pub multipliers: Vec<f64>,
    /// Whether the run approaches the orbit. Otherwise the run repeats it.
    pub attracts: bool,
    /// Number of contacts that rest throughout, each anywhere in an interval, and of translations that no equation notices: one
    /// neutral direction each.
    pub neutral_directions: usize,
}

/// The result of examining an orbit.
#[derive(Clone, Debug, PartialEq)]
pub enum Verdict {
    /// A limit cycle that attracts the run.
    Stable(Orbit),
    /// A closed orbit that the run repeats and that disturbances neither approach nor leave.
    Repeats(Orbit),
    /// A closed orbit from which disturbances grow.
    Unstable(Orbit),
    /// Nothing could be shown.
    Open,
}

/// An orbit that closes after `map.turns` turns, represented by one of its states on the section.
struct Closed<'a> {
    map: ReturnMap<'a>,
    state: Components,
    slope: DMatrix<f64>,
    /// The distance from the orbit that closes exactly, by the closing error and the slope.
    error: f64,
}

/// Phases and state of a run at a passage through the section.
pub(super) type PassageState<'a> = (&'a Phases, &'a Components);

/// Refines the orbit near the latest passage of a run, the first one of `passed`, and classifies it. An orbit counts as
/// closed if its closing error is at most `closure`; the refinement aims for less.
pub(super) fn examine(map: ReturnMap, passed: &[PassageState], closure: f64) -> Option<Verdict> {
    let (_, run) = passed.first()?;
    let first = map.follow_with_slope(run);
    if let Some(orbit) = repeats(map, run, first.as_ref()) {
        return Some(Verdict::Repeats(orbit));
    }
    let closed = in_fewest_turns(shoot(map, run, first?, closure)?, closure);
    if is_equilibrium(&closed) {
        return None;
    }
    let multipliers = moduli(closed.slope.clone())?;
    let (end, period) = closed.map.follow_closely(&closed.state)?;
    let orbit = orbit(&closed, &end, period, multipliers);
    if is_point(&closed, &orbit) || moves_one_way(&closed, &orbit) {
        return None;
    }
    let largest = orbit.multipliers.first().copied().unwrap_or(0.0);
    if largest > 1.0 + MULTIPLIER_DOUBT {
        return Some(Verdict::Unstable(orbit));
    }
    let is_stable = largest < 1.0 - MULTIPLIER_DOUBT
        && !orbit.grazes()
        && orbit.margin.is_none_or(|margin| margin > 0.0)
        && (has_attracted(&closed, passed, largest) || attracts(&closed, run, largest, closure));
    Some(match is_stable {
        true => Verdict::Stable(Orbit { attracts: true, ..orbit }),
        false => Verdict::Open,
    })
}

impl Orbit {
    /// Returns whether a contact touches the edge of sticking.
    fn grazes(&self) -> bool {
        self.stick_fraction.iter().any(|part| *part > 0.0 && *part < GRAZES)
    }
}

/// Returns the orbit of a run that repeats, and that disturbances neither approach nor leave by their multipliers. `first` is the first
/// return with its derivative. A motion that grazes a switch, and has no derivative, counts at the end of a run only, and so does one
/// that a force drives, which may creep.
fn repeats(map: ReturnMap, run: &[f64], first: Option<&(Return, DMatrix<f64>)>) -> Option<Orbit> {
    let error = |end: &Return| map.section.difference(&end.state, run).amax();
    let neutral = 1.0 - NEUTRAL..1.0 + MULTIPLIER_DOUBT;
    let is_neutral = |moduli: &Vec<f64>| moduli.first().is_some_and(|most| neutral.contains(most));
    let multipliers = match first {
        Some((end, _)) if error(end) > REACH * REPEATS.sqrt() => return None,
        Some((_, slope)) => moduli(slope.clone()).filter(is_neutral),
        None => None,
    };
    let is_driven = matches!(map.section.mark, SectionMark::Period(_));
    if (multipliers.is_none() || is_driven) && !map.only_stable {
        return None;
    }
    let (end, period) = map.follow_closely(run)?;
    let (state, slope) = (Components::from_slice(run), DMatrix::zeros(0, 0));
    let closed = Closed { map, state, slope, error: error(&end) };
    let has_derivative = multipliers.is_some() || first.is_some();
    let orbit = orbit(&closed, &end, period, multipliers.unwrap_or_default());
    let is_sound = !orbit.multipliers.is_empty() || !has_derivative || orbit.grazes();
    let repeats = is_sound
        && closed.error <= REPEATS * size(&closed, &orbit)
        && orbit.margin.is_none_or(|margin| margin > 0.0)
        && !is_equilibrium(&closed)
        && !moves_one_way(&closed, &orbit);
    repeats.then_some(orbit)
}

/// An orbit whose time derivative has no component above this one, non-dimensional, may be as small as its closing error.
const SHRUNK: f64 = 10.0 * SLOW;

/// Returns whether an orbit has shrunk to an equilibrium: a motion that swings about one also returns to the section.
fn is_equilibrium(closed: &Closed) -> bool {
    let ReturnMap { section, view, .. } = closed.map;
    let rates = view.remaining_rates(&section.phases, &closed.state);
    rates.iter().all(|rate| rate.abs() <= SHRUNK)
}

/// Returns whether an orbit of a system without forcing may be an equilibrium that the run approaches: its size is less than
/// [`LEAST_SIZE`] times the distance from the orbit that closes exactly.
fn is_point(closed: &Closed, orbit: &Orbit) -> bool {
    let is_forced = closed.map.view.evaluator.graph().layout.forcing.is_some();
    !is_forced && size(closed, orbit) < LEAST_SIZE * closed.error
}

/// Returns the size of an orbit.
fn size(closed: &Closed, orbit: &Orbit) -> f64 {
    let ReturnMap { section, view, turns, .. } = closed.map;
    let layout = &view.evaluator.graph().layout;
    let time = orbit.period / (TAU * turns as f64);
    let rates = view.remaining_rates(&section.phases, &closed.state);
    // Of a small oscillation, these are the amplitudes of the positions.
    let sizes = rates.iter().enumerate().map(|(place, rate)| {
        let is_velocity = layout.velocities.iter().flatten().any(|of| *of == place);
        rate.abs() * if is_velocity { time * time } else { time }
    });
    sizes.fold(0.0, f64::max)
}

/// Returns whether a contact, whose position matters, only ever moves in one direction: it creeps, however little.
fn moves_one_way(closed: &Closed, orbit: &Orbit) -> bool {
    let ReturnMap { section, view, .. } = closed.map;
    view.contacts.iter().enumerate().any(|(index, contact)| {
        let [low, high] = orbit.position_extremes[index];
        let displaced = orbit.speed[index] * orbit.period - f64::from(orbit.turns[index]) * TAU;
        let counts = !view.translations.displace(contact.position)
            && !section.rests[index]
            && orbit.turns[index] == 0;
        counts && high - low > LEAST_WAY && displaced.abs() > DISPLACED * (high - low)
    })
}

/// Finds a fixed point of the return map by Newton's method. The derivative is reused while the
/// iteration converges quickly, because the map has kinks near an orbit on which a ball barely
/// sticks, and follows the returns by Broyden's update (C. G. Broyden 1965, doi:10.1090/S0025-5718-1965-0198670-6).
/// `known` is the return of the run with the derivative.
fn shoot<'a>(
    map: ReturnMap<'a>,
    run: &[f64],
    known: (Return, DMatrix<f64>),
    closure: f64,
) -> Option<Closed<'a>> {
    let first = map.section.coordinates(run);
    let mut known = Some(known);
    let mut centre = first.clone();
    // 1 - J, and the latest step.
    let mut newton: Option<(DMatrix<f64>, DVector<f64>)> = None;
    let mut last = f64::INFINITY;
    let mut followed = 0;
    while followed < MOST_TURNS_FOLLOWED || last <= closure {
        followed += map.turns;
        let start = map.section.state(run, &centre);
        let (end, slope) = match known.take() {
            Some((end, slope)) => (end, Some(slope)),
            None => (map.follow(&start)?, None),
        };
        let known_or_followed =
            |slope: Option<DMatrix<f64>>| slope.or_else(|| Some(map.follow_with_slope(&start)?.1));
        let residual = map.section.difference(&end.state, &start);
        let size = residual.amax();
        // Iterates below the required accuracy as long as the error decreases.
        let at_best = AT_BEST * map.settings.tolerance.relative;
        if size <= at_best || (last <= closure && size > 0.25 * last) {
            let slope = known_or_followed(slope)?;
            let identity = DMatrix::identity(centre.len(), centre.len());
            // A section may have no coordinates: all contacts rest.
            let step = (!centre.is_empty()).then(|| (identity - &slope).lu().solve(&residual));
            let error = step.flatten().map_or(0.0, |step| step.amax());
            return Some(Closed { map, state: start, slope, error });
        }
        let matrix = match newton.take().filter(|_| size <= 0.25 * last) {
            Some((matrix, step)) => matrix - &residual * step.transpose() / step.norm_squared(),
            None => {
                followed += centre.len() * map.turns;
                let slope = known_or_followed(slope)?;
                // A return and the derivative at the end follow at least.
                let least = end.steps * (1 + cost_of_a_step(centre.len()));
                let is_hopeless =
                    || least > map.steps_left.get() || map.only_stable && expands(&slope);
                if last.is_infinite() && is_hopeless() {
                    return None;
                }
                DMatrix::identity(centre.len(), centre.len()) - slope
            }
        };
        last = size;
        // (1 - J) δ = P(s) - s
        let step = matrix.clone().lu().solve(&residual)?;
        centre += &step;
        newton = Some((matrix, step));
        if (&centre - &first).amax() > REACH {
            return None;
        }
    }
    None
}

/// Returns whether neighbours separate by a map with this derivative.
fn expands(slope: &DMatrix<f64>) -> bool {
    moduli(slope.clone()).is_none_or(|moduli| moduli.first().is_some_and(|largest| *largest > 1.0))
}

/// Returns the same orbit over its minimal number of turns. An orbit that closes after six turns
/// may close after two; and an orbit approached in a spiral of five turns appears to close after
/// five long before it appears to close after one.
fn in_fewest_turns(closed: Closed, closure: f64) -> Closed {
    let all = closed.map.turns;
    let once = (1..all).filter(|turns| all.is_multiple_of(*turns)).find_map(|turns| {
        let longest = closed.map.longest * turns as f64 / all as f64;
        let map = ReturnMap { turns, longest, ..closed.map };
        let first = map.follow_with_slope(&closed.state)?;
        let fewer = shoot(map, &closed.state, first, closure)?;
        let distance = closed.map.section.difference(&fewer.state, &closed.state).amax();
        (distance <= SAME_ORBIT).then_some(fewer)
    });
    once.unwrap_or(closed)
}

/// Returns whether the run has approached the orbit in its latest returns, for which its motion need not be followed further:
/// in the later half of them, the greatest distance is smaller than in the earlier half, by a part of what the largest
/// multiplier gives.
fn has_attracted(closed: &Closed, passed: &[PassageState], largest_multiplier: f64) -> bool {
    let Closed { map, state: orbit, .. } = closed;
    let returns = passed.iter().step_by(map.turns);
    let distances: Vec<f64> = returns
        .take_while(|(phases, _)| **phases == map.section.phases)
        .map(|(_, state)| map.section.difference(state, orbit).amax())
        .collect();
    let half = distances.len() / 2;
    let [later, earlier] = [&distances[..half], &distances[distances.len() - half..]]
        .map(|distances| distances.iter().copied().fold(0.0, f64::max));
    let nearer = largest_multiplier.powf(0.5 * half as f64).clamp(NEARER.0, NEARER.1);
    half >= LEAST_APPROACHED && later <= nearer * earlier
}

/// Returns whether the run approaches the orbit if it is followed. An orbit with multipliers inside the unit circle
/// may have a small basin; and a run in which a ball slowly swings about its place in the orbit,
/// sticking at every turn, may never approach it.
fn attracts(closed: &Closed, run: &[f64], largest_multiplier: f64, closure: f64) -> bool {
    let mut map = closed.map;
    map.settings.tolerance.relative *= COARSER;
    map.settings.tolerance.absolute *= COARSER;
    let nearer = largest_multiplier.powi(RETURNS).clamp(NEARER.0, NEARER.1);
    let (mut first, mut spell) = (0.0_f64, Vec::with_capacity(SPELL));
    let mut returns = 0;
    let mut judge = |state: &[f64]| {
        let now = map.section.difference(state, &closed.state).amax();
        if returns < SPELL {
            first = first.max(now);
        }
        spell.truncate(SPELL - 1);
        spell.insert(0, now);
        let farthest = spell.iter().copied().fold(0.0, f64::max);
        let near = farthest <= closure || (returns >= SPELL && farthest <= nearer * first);
        returns += 1;
        if near {
            return Some(true);
        }
        (returns >= MOST_RETURNS || now > 10.0 * first).then_some(false)
    };
    judge(run).or_else(|| map.follow_until(run, judge)).unwrap_or(false)
}

fn orbit(closed: &Closed, end: &Return, period: Period, multipliers: Vec<f64>) -> Orbit {
    let ReturnMap { section, view, turns, .. } = closed.map;
    let contacts = view.contacts.iter().enumerate();
    let turned: Vec<f64> = contacts
        .clone()
        .map(|(index, contact)| match section.mark {
            SectionMark::Round { contact, direction, may_stop: false } if contact == index => {
                direction * turns as f64 * TAU
            }
            _ => end.state[contact.position] - closed.state[contact.position],
        })
        .collect();
    let whole = |(index, contact): (usize, &ContactPlace)| {
        let turns = if contact.angular { turned[index] / TAU } else { 0.0 };
        turns.round() as i32
    };
    let is_forced = matches!(section.mark, SectionMark::Period(_));
    let rests = section.rests.contains(&true)
        && (0..section.rests.len())
            .all(|index| section.rests[index] || is_forced && period.is_idle(index));
    Orbit {
        period: end.time,
        turns: contacts.map(whole).collect(),
        touching: period.touching(view),
        outputs: period.outputs.measured(true),
        configurations: period.configurations,
        speed: turned.iter().map(|angle| angle / end.time).collect(),
        speed_extremes: period.speeds,
        position_extremes: period.positions,
        stick_fraction: period.stuck.iter().map(|time| time / end.time).collect(),
        amplitude: (period.square_time / end.time).sqrt(),
        peak: period.peak,
        rests,
        margin: period.margin.is_finite().then_some(period.margin),
        multipliers,
        attracts: false,
        neutral_directions: section.neutral_directions(view),
    }
}

/// Returns the moduli of a matrix's eigenvalues, descending; `None` if they cannot be computed.
fn moduli(slope: DMatrix<f64>) -> Option<Vec<f64>> {
    if slope.is_empty() {
        return Some(Vec::new());
    }
    // The number of iterations is bounded: for a matrix that is not finite the decomposition would
    // not end.
    let eigenvalues = Schur::try_new(slope, f64::EPSILON, 10_000)?.complex_eigenvalues();
    let mut moduli: Vec<f64> = eigenvalues.iter().map(|value| value.norm()).collect();
    moduli.sort_by(|left, right| right.total_cmp(left));
    Some(moduli)
}
