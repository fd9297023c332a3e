//! A closed orbit near a run: found by shooting, judged by its Floquet multipliers.
//!
//! Newton's method on the return map, whose derivative is exact through all switches, finds the
//! orbit that closes; the eigenvalues of the same derivative there are its multipliers (R. Seydel,
//! *Practical Bifurcation and Stability Analysis*, 3rd ed., Springer 2010, chapter 7,
//! doi:10.1007/978-1-4419-1740-9).

use nalgebra::{DMatrix, Dyn, LU, Schur};

use super::cycle::CyclePhase;
use super::period::Period;
use super::return_map::{Return, ReturnMap};
use crate::model::State;

/// How far from the run the closed orbit may lie, non-dimensional.
pub(super) const REACH: f64 = 1e-2;
/// Most turns that Newton's method follows, each with the derivative counting as many as the
/// section has dimensions.
const MOST_TURNS_FOLLOWED: usize = 200;
/// Over the relative tolerance with which the map is computed: an orbit that comes back to itself
/// so nearly needs no more of Newton's method.
const AT_BEST: f64 = 10.0;
/// Orbits this near to each other on the section are the same.
const SAME_ORBIT: f64 = 1e-4;
/// Most returns within which the run must come nearer to the orbit.
const MOST_RETURNS: usize = 400;
/// Returns over which the greatest distance is taken: a spiral comes nearer on the whole only.
const SPELL: usize = 10;
/// How much nearer: as much as the largest multiplier does in fifty returns, within these bounds.
const NEARER: (f64, f64) = (0.1, 0.8);
/// Multipliers must stay this far inside the unit circle to count as stable, and go this far outside
/// to count as unstable: what the orbit's closing to the tolerances only leaves open.
const MULTIPLIER_DOUBT: f64 = 1e-4;

/// A closed orbit.
#[derive(Clone, Debug, PartialEq)]
pub struct Orbit<const N: usize> {
    /// Period, non-dimensional.
    pub period: f64,
    /// Whole turns of each ball per period, with sign.
    pub turns: [i32; N],
    /// What the balls do, one after another.
    pub configurations: Vec<[CyclePhase; N]>,
    /// Mean speed of each ball relative to the ring, non-dimensional.
    pub speed: [f64; N],
    /// Least and greatest speed of each ball.
    pub speed_extremes: [[f64; 2]; N],
    /// Least and greatest angle of each ball, from one beginning in [0, 2π) on.
    pub angle_extremes: [[f64; 2]; N],
    /// Root mean square over the period of the table's displacement, over `L`.
    pub amplitude: f64,
    /// Its greatest displacement, over `L`.
    pub peak: f64,
    /// The least part of the friction limit that is left to a resting ball; none where none rests.
    pub margin: Option<f64>,
    /// Moduli of the multipliers off the neutral directions, descending.
    pub multipliers: Vec<f64>,
    /// Balls that rest all along, each anywhere in an interval: as many directions are neutral.
    pub neutral_directions: usize,
}

/// What a look at a closing orbit has shown.
#[derive(Clone, Debug, PartialEq)]
pub enum Verdict<const N: usize> {
    /// A limit cycle that draws the run near.
    Stable(Orbit<N>),
    /// A closed orbit that a disturbance grows away from.
    Unstable(Orbit<N>),
    /// Neither could be shown.
    Open,
}

/// An orbit that closes after `map.turns` turns, at one of its states on the section.
struct Closed<'a, const N: usize> {
    map: ReturnMap<'a, N>,
    state: State<N>,
    slope: DMatrix<f64>,
}

/// Refines the orbit near `run`, a state on the section, and says what it is. An orbit is closed
/// where it comes back to itself within `closure`, better where that can be had.
pub(super) fn examine<const N: usize>(
    map: ReturnMap<N>,
    run: &State<N>,
    closure: f64,
) -> Option<Verdict<N>> {
    let closed = in_fewest_turns(shoot(map, run, closure)?, closure);
    let multipliers = moduli(closed.slope.clone())?;
    let (end, period) = closed.map.follow_closely(&closed.state)?;
    let orbit = orbit(&closed, &end, period, multipliers);
    let largest = orbit.multipliers.first().copied().unwrap_or(0.0);
    if largest > 1.0 + MULTIPLIER_DOUBT {
        return Some(Verdict::Unstable(orbit));
    }
    let is_stable = largest < 1.0 - MULTIPLIER_DOUBT
        && orbit.margin.is_none_or(|margin| margin > 0.0)
        && attracts(&closed, run, largest, closure);
    Some(if is_stable { Verdict::Stable(orbit) } else { Verdict::Open })
}

/// Newton's method on the return map. Its derivative is kept while it brings the orbit quickly
/// nearer: the map has kinks near an orbit on which a ball barely sticks.
fn shoot<'a, const N: usize>(
    map: ReturnMap<'a, N>,
    run: &State<N>,
    closure: f64,
) -> Option<Closed<'a, N>> {
    let first = map.section.coordinates(run);
    let mut centre = first.clone();
    let mut newton: Option<LU<f64, Dyn, Dyn>> = None;
    let mut last = f64::INFINITY;
    let mut followed = 0;
    while followed < MOST_TURNS_FOLLOWED || last <= closure {
        followed += map.turns;
        let start = map.section.state(run, &centre);
        let residual = map.section.difference(&map.follow(&start)?.state, &start);
        let size = residual.amax();
        // Beyond what is asked for, as far as it goes.
        let at_best = AT_BEST * map.settings.tolerance.relative;
        if size <= at_best || (last <= closure && size > 0.25 * last) {
            let (_, slope) = map.follow_with_slope(&start)?;
            return Some(Closed { map, state: start, slope });
        }
        if size > 0.25 * last || newton.is_none() {
            followed += centre.len() * map.turns;
            let (_, slope) = map.follow_with_slope(&start)?;
            newton = Some((DMatrix::identity(centre.len(), centre.len()) - slope).lu());
        }
        last = size;
        // (1 - J) δ = P(s) - s
        centre += newton.as_ref()?.solve(&residual)?;
        if (&centre - &first).amax() > REACH {
            return None;
        }
    }
    None
}

/// The same orbit followed once round only. An orbit that closes after six turns may close after
/// two; and one that draws motions near in a spiral of five turns seems to close after five long
/// before it is seen to close after one.
fn in_fewest_turns<const N: usize>(closed: Closed<N>, closure: f64) -> Closed<N> {
    let all = closed.map.turns;
    let once = (1..all).filter(|turns| all.is_multiple_of(*turns)).find_map(|turns| {
        let longest = closed.map.longest * turns as f64 / all as f64;
        let fewer = shoot(ReturnMap { turns, longest, ..closed.map }, &closed.state, closure)?;
        let distance = closed.map.section.difference(&fewer.state, &closed.state).amax();
        (distance <= SAME_ORBIT).then_some(fewer)
    });
    once.unwrap_or(closed)
}

/// Whether the run itself is drawn to the orbit: whether it comes nearer. An orbit with multipliers
/// inside the unit circle may have a small basin; a ball that slowly swings about its place in the
/// orbit, sticking at every turn, may never come closer.
fn attracts<const N: usize>(
    closed: &Closed<N>,
    run: &State<N>,
    largest_multiplier: f64,
    closure: f64,
) -> bool {
    let map = &closed.map;
    let nearer = largest_multiplier.powi(50).clamp(NEARER.0, NEARER.1);
    let mut state = *run;
    let (mut first, mut spell) = (0.0_f64, Vec::with_capacity(SPELL));
    for returns in 0..MOST_RETURNS {
        let now = map.section.difference(&state, &closed.state).amax();
        if returns < SPELL {
            first = first.max(now);
        }
        spell.truncate(SPELL - 1);
        spell.insert(0, now);
        let farthest = spell.iter().copied().fold(0.0, f64::max);
        if farthest <= closure || (returns >= SPELL && farthest <= nearer * first) {
            return true;
        }
        match map.follow(&state) {
            Some(next) if now <= 10.0 * first => state = next.state,
            _ => return false,
        }
    }
    false
}

fn orbit<const N: usize>(
    closed: &Closed<N>,
    end: &Return<N>,
    period: Period<N>,
    multipliers: Vec<f64>,
) -> Orbit<N> {
    let section = &closed.map.section;
    let turned: [f64; N] = std::array::from_fn(|ball| {
        if ball == section.reference {
            let direction = closed.state.beta_dot[ball].signum();
            direction * closed.map.turns as f64 * std::f64::consts::TAU
        } else {
            end.state.beta[ball] - closed.state.beta[ball]
        }
    });
    Orbit {
        period: end.time,
        turns: turned.map(|angle| (angle / std::f64::consts::TAU).round() as i32),
        configurations: period.configurations,
        speed: turned.map(|angle| angle / end.time),
        speed_extremes: period.speeds,
        angle_extremes: period.angles,
        amplitude: (period.square_time / end.time).sqrt(),
        peak: period.peak,
        margin: period.margin.is_finite().then_some(period.margin),
        multipliers,
        neutral_directions: section.rests.iter().filter(|&&rests| rests).count(),
    }
}

/// Moduli of a matrix's eigenvalues, descending; none where they cannot be found.
fn moduli(slope: DMatrix<f64>) -> Option<Vec<f64>> {
    // The decomposition is bounded: of a matrix that is not finite it would never come back.
    let eigenvalues = Schur::try_new(slope, f64::EPSILON, 10_000)?.complex_eigenvalues();
    let mut moduli: Vec<f64> = eigenvalues.iter().map(|value| value.norm()).collect();
    moduli.sort_by(|one, other| other.total_cmp(one));
    Some(moduli)
}
