//! The equilibrium set: all positions in which dry friction holds every ball (thesis section 5.2).

use rayon::prelude::*;

use super::balance::Balance;
use super::frictionless::equilibrium_positions;
use super::frictionless_position::FrictionlessPosition;
use super::identical_balls::sorted_where_identical;
use super::one_ball::RestArcs;
use super::rest_form::{AtRest, RestForm};
use super::set_extremes::amplitude_extremes;
use super::set_grid::{GridRow, SetGrid};
use super::set_samples::{self, REPLICATES};
use crate::model::Machine;

/// How finely a set is sampled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Resolution {
    /// A regular grid with this number of points per axis, for one or two balls. For one ball only
    /// the displayed positions are on the grid; its set has a closed form.
    Grid(usize),
    /// This number of quasi-random samples in each of [`REPLICATES`] scrambles.
    Samples(u32),
}

/// The equilibrium set at one point of a sweep.
#[derive(Clone, Debug, PartialEq)]
pub struct EquilibriumSet {
    /// Number of positions that were examined, without those at which balls with contact overlap.
    pub positions: u64,
    /// Fraction of all ball positions that are in the set; of balls with contact, of those without overlap.
    pub fraction: f64,
    /// 95 % interval of the fraction if positions were sampled; a grid has no random error.
    pub fraction_interval: Option<(f64, f64)>,
    /// Connected components on the torus of ball angles; `None` if positions were sampled.
    pub components: Option<u64>,
    /// Connected components if positions that differ by an exchange of two identical balls count as
    /// one; equal to `components` for balls that differ.
    pub components_modulo_exchange: Option<u64>,
    /// Number of frictionless equilibria (which belong to the set) with no grid point of the set
    /// nearby. Above 0, the grid is too coarse to resolve all components. 0 for one ball; `None` if
    /// positions were sampled.
    pub unseen: Option<u64>,
    /// Fraction of the positions in which two balls with contact touch that are in the set.
    pub touching_fraction: Option<f64>,
    /// The smallest and the largest amplitude anywhere in the set, m; `None` if the set is empty. For several balls in a ring
    /// with runout, those of the examined positions. For balls with contact, the smallest of the examined positions, and the
    /// largest that a search from some of them finds.
    pub amplitude_m: Option<(f64, f64)>,
    /// The position with the smallest amplitude, one angle per ball, rad.
    pub min_amplitude_beta_rad: Option<Vec<f64>>,
    /// Where the balls balance the imbalance, with a runout of the ring that which they feel; friction carries no load there.
    pub balance: Balance,
}

/// Largest number of positions in which balls touch, and of frictionless equilibria, from which a search for larger
/// amplitudes begins.
const CLIMBS: usize = 8;

impl EquilibriumSet {
    /// Returns the set of a machine, computed on the current thread pool. `None` for a grid with
    /// more than two balls, and for an unsupported number of balls.
    pub fn of(machine: &Machine, resolution: Resolution) -> Option<Self> {
        let form = RestForm::new(machine)?;
        let mut set = match resolution {
            Resolution::Grid(points) if form.mass.len() == 1 => set_of_one_ball(&form, points),
            Resolution::Grid(points) => set_on_grid(&form, &SetGrid::new(&form, points)?),
            Resolution::Samples(samples) => sampled_set(&form, samples),
        };
        if form.touching.is_some() {
            set.take_in_touching(&form);
        } else if form.mass.len() > 1 {
            set.set_exact_extremes(&form);
        }
        if let Some(beta) = set.balance.position()
            && form.transfer.is_finite()
        {
            // The ring's centre is on the axis there.
            let amplitude = form.runout.norm() * form.ring_radius_m;
            let (smallest, largest) = set.amplitude_m.unwrap_or((f64::INFINITY, amplitude));
            if amplitude <= smallest {
                set.min_amplitude_beta_rad = Some(beta.to_vec());
            }
            set.amplitude_m = Some((amplitude.min(smallest), amplitude.max(largest)));
        }
        Some(set)
    }

    /// Takes in the positions in which balls touch: all frictionless equilibria, and samples.
    fn take_in_touching(&mut self, form: &RestForm) {
        let samples = form.touching_positions();
        let mut held: Vec<_> = samples.iter().filter(|beta| form.holds_with_forces(beta)).collect();
        self.touching_fraction =
            (!samples.is_empty()).then(|| held.len() as f64 / samples.len() as f64);
        held.sort_by(|left, right| form.amplitude_m(right).total_cmp(&form.amplitude_m(left)));
        let starts = held.iter().copied().step_by((held.len() / CLIMBS).max(1)).take(CLIMBS);
        let without_friction = frictionless_positions(form);
        let starts = starts.chain(without_friction.iter().map(|place| &place.beta).take(CLIMBS));
        let starts: Vec<_> = starts.collect();
        let climbed_m = starts.par_iter().map(|beta| form.climbed_m(beta)).reduce(|| 0.0, f64::max);
        for beta in held.into_iter().chain(without_friction.iter().map(|place| &place.beta)) {
            let amplitude = form.amplitude_m(beta);
            let (smallest, largest) = self.amplitude_m.get_or_insert((amplitude, amplitude));
            *largest = largest.max(amplitude);
            if amplitude < *smallest || self.min_amplitude_beta_rad.is_none() {
                *smallest = amplitude;
                self.min_amplitude_beta_rad = Some(sorted_where_identical(beta, &form.balls));
            }
        }
        self.amplitude_m = self.amplitude_m.map(|(least, largest)| (least, largest.max(climbed_m)));
    }

    /// Replaces the sampled extremes of the amplitude by the exact ones, which lie between the
    /// samples.
    fn set_exact_extremes(&mut self, form: &RestForm) {
        let in_metres = |(size, beta): (f64, Vec<f64>)| (size * form.ring_radius_m, beta);
        let [lowest, highest] = amplitude_extremes(form).map(|found| found.map(in_metres));
        if let Some((amplitude, beta)) = lowest
            && self.amplitude_m.is_none_or(|(smallest, _)| amplitude < smallest)
        {
            let largest = self.amplitude_m.map_or(amplitude, |(_, largest)| largest);
            self.amplitude_m = Some((amplitude, largest));
            self.min_amplitude_beta_rad = Some(sorted_where_identical(&beta, &form.balls));
        }
        if let (Some((amplitude, _)), Some((_, largest))) = (highest, &mut self.amplitude_m) {
            *largest = amplitude.max(*largest);
        }
    }
}

impl Resolution {
    /// Returns the number of positions for a number of balls; `None` on overflow.
    pub fn positions(self, balls: usize) -> Option<u64> {
        match self {
            Resolution::Grid(points) => (points as u64).checked_pow(u32::try_from(balls).ok()?),
            Resolution::Samples(samples) => Some(u64::from(REPLICATES) * u64::from(samples)),
        }
    }

    /// Passes all positions to `show`, one angle per ball in rad, with the friction and amplitude there, one at a
    /// time and always in the same order. No friction holds balls with contact where they overlap. Passes none for a grid with more than two
    /// balls.
    ///
    /// # Errors
    /// Returns the first error of `show`, which ends the iteration.
    pub fn visit<E>(
        self,
        form: &RestForm,
        mut show: impl FnMut(&[f64], AtRest) -> Result<(), E>,
    ) -> Result<(), E> {
        match self {
            Resolution::Grid(points) => {
                let Some(grid) = SetGrid::new(form, points) else { return Ok(()) };
                let mut values = GridRow::default();
                for row in 0..grid.rows() {
                    grid.fill(row, &mut values);
                    for column in 0..points {
                        let beta = grid.beta(row, column);
                        show(&beta, unless_overlap(form, &beta, grid.at(&values, column)))?;
                    }
                }
            }
            Resolution::Samples(samples) => {
                for replicate in 0..REPLICATES {
                    for index in 0..samples {
                        let beta = set_samples::sample(form.mass.len(), replicate, index);
                        show(&beta, unless_overlap(form, &beta, form.at_rest(&beta)))?;
                    }
                }
            }
        }
        Ok(())
    }
}

/// Returns a position at rest; no friction holds balls with contact that overlap.
fn unless_overlap(form: &RestForm, beta: &[f64], rest: AtRest) -> AtRest {
    if form.is_possible(beta) {
        return rest;
    }
    AtRest { required_friction: f64::INFINITY, friction_used: f64::INFINITY, ..rest }
}

fn set_of_one_ball(form: &RestForm, points: usize) -> EquilibriumSet {
    let arcs = RestArcs::of(form);
    let amplitude = |beta: &f64| form.at_rest(&[*beta]).amplitude_m;
    let smallest = arcs.candidates().min_by(|a, b| amplitude(a).total_cmp(&amplitude(b)));
    let largest_m = arcs.candidates().map(|beta| amplitude(&beta)).fold(0.0, f64::max);
    EquilibriumSet {
        positions: points as u64,
        fraction: arcs.fraction(),
        fraction_interval: None,
        touching_fraction: None,
        components: Some(arcs.count()),
        components_modulo_exchange: Some(arcs.count()),
        unseen: Some(0),
        amplitude_m: smallest.map(|beta| (amplitude(&beta), largest_m)),
        min_amplitude_beta_rad: smallest.map(|beta| vec![beta]),
        balance: Balance::of(form),
    }
}

fn set_on_grid(form: &RestForm, grid: &SetGrid) -> EquilibriumSet {
    let summary = grid.summary();
    let (components, exchanged) = summary.runs.components();
    let identical = form.balls.iter().all(|ball| *ball == form.balls[0]);
    let radius = form.ring_radius_m;
    let frictionless = frictionless_positions(form);
    EquilibriumSet {
        positions: summary.possible,
        fraction: summary.inside as f64 / summary.possible.max(1) as f64,
        fraction_interval: None,
        touching_fraction: None,
        components: Some(components),
        components_modulo_exchange: exchanged.filter(|_| identical).or(Some(components)),
        unseen: Some(frictionless.iter().filter(|place| !grid.sees(&place.beta)).count() as u64),
        amplitude_m: summary.amplitudes.map(|[low, high]| (low.0 * radius, high.0 * radius)),
        min_amplitude_beta_rad: summary
            .amplitudes
            .map(|[(_, [row, column]), _]| grid.beta(row, column)),
        balance: Balance::of(form),
    }
}

/// Returns the positions of all frictionless equilibria; none at standstill, where every position is one.
fn frictionless_positions(form: &RestForm) -> Vec<FrictionlessPosition> {
    if form.speed == 0.0 { Vec::new() } else { equilibrium_positions(form) }
}

fn sampled_set(form: &RestForm, samples: u32) -> EquilibriumSet {
    let balls = form.mass.len();
    let replicates: Vec<SampleSums> = (0..REPLICATES)
        .into_par_iter()
        .map(|replicate| {
            let mut sums = SampleSums::default();
            for index in 0..samples {
                sums.add(form, set_samples::sample(balls, replicate, index));
            }
            sums
        })
        .collect();
    let fractions: Vec<f64> = replicates
        .iter()
        .map(|replicate| f64::from(replicate.inside) / f64::from(replicate.possible.max(1)))
        .collect();
    let fewest = replicates.iter().map(|replicate| replicate.possible).min().unwrap_or(0);
    let (fraction, interval) = set_samples::fraction_with_interval(&fractions, fewest);
    let all = replicates.into_iter().fold(SampleSums::default(), SampleSums::merged);
    EquilibriumSet {
        positions: all.possible.into(),
        fraction,
        fraction_interval: Some(interval),
        touching_fraction: None,
        components: None,
        components_modulo_exchange: None,
        unseen: None,
        amplitude_m: all.smallest.as_ref().map(|(smallest, _)| (*smallest, all.largest_m)),
        min_amplitude_beta_rad: all.smallest.map(|(_, beta)| beta),
        balance: Balance::of(form),
    }
}

/// The samples in the set: their number, and the smallest amplitude with its position and the
/// largest amplitude, m.
#[derive(Default)]
struct SampleSums {
    possible: u32,
    inside: u32,
    smallest: Option<(f64, Vec<f64>)>,
    largest_m: f64,
}

impl SampleSums {
    fn add(&mut self, form: &RestForm, beta: Vec<f64>) {
        if !form.is_possible(&beta) {
            return;
        }
        self.possible += 1;
        let rest = form.at_rest(&beta);
        if !rest.in_set() {
            return;
        }
        self.inside += 1;
        self.largest_m = self.largest_m.max(rest.amplitude_m);
        if self.smallest.as_ref().is_none_or(|(smallest, _)| rest.amplitude_m < *smallest) {
            self.smallest = Some((rest.amplitude_m, beta));
        }
    }

    fn merged(self, other: Self) -> Self {
        let smaller = match (self.smallest, other.smallest) {
            (Some(left), Some(right)) => Some(if right.0 < left.0 { right } else { left }),
            (left, right) => left.or(right),
        };
        SampleSums {
            possible: self.possible + other.possible,
            inside: self.inside + other.inside,
            smallest: smaller,
            largest_m: self.largest_m.max(other.largest_m),
        }
    }
}

/// Points per axis of the quick estimate for two balls.
const FRACTION_GRID: usize = 256;

/// Returns a quick estimate of the fraction of all ball positions that are equilibria, computed on
/// the calling thread. Of balls with contact, only positions without overlap count; those in which balls touch have no
/// share in the fraction ([`super::touching_set_fraction`]).
///
/// The fraction is exact for one ball, accurate to about 0.001 for two balls (a grid of 256 × 256
/// points), and to 0.005 for more (16,384 quasi-random points). `None` for an unsupported number of
/// balls.
pub fn set_fraction(machine: &Machine) -> Option<f64> {
    let form = RestForm::new(machine)?;
    match form.mass.len() {
        1 => Some(RestArcs::of(&form).fraction()),
        2 => Some(SetGrid::new(&form, FRACTION_GRID)?.fraction()),
        _ => Some(set_samples::fraction(&form)),
    }
}
