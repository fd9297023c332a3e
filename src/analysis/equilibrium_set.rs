//! The equilibrium set: all positions in which dry friction holds every ball (thesis section 5.2).

use std::f64::consts::TAU;

use rayon::prelude::*;

use super::balance::Balance;
use super::frictionless::equilibrium_positions;
use super::identical_balls::sorted_where_identical;
use super::one_ball::Arcs;
use super::rest_form::{AtRest, RestForm};
use super::set_extremes::amplitude_extremes;
use super::set_grid::{GridRow, SetGrid};
use super::set_samples::{self, REPLICATES};
use crate::model::{BallsInContact, Machine, wrap_to_two_pi};

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
    /// Fraction of all ball positions that are in the set.
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
    /// The smallest and the largest amplitude anywhere in the set, m; `None` if the set is empty.
    pub amplitude_m: Option<(f64, f64)>,
    /// The position with the smallest amplitude, one angle per ball, rad.
    pub min_amplitude_beta_rad: Option<Vec<f64>>,
    /// Where the balls balance the imbalance; friction carries no load there.
    pub balance: Balance,
}

impl EquilibriumSet {
    /// Returns the set of a machine, computed on the current thread pool. `None` for a grid with
    /// more than two balls, and for an unsupported number of balls.
    pub fn of(machine: &Machine, resolution: Resolution) -> Option<Self> {
        let form = RestForm::new(machine)?;
        let mut set = match resolution {
            Resolution::Grid(_) if form.mass.len() == 1 => set_of_one_ball(&form),
            Resolution::Grid(points) => set_on_grid(&form, &SetGrid::new(&form, points)?),
            Resolution::Samples(samples) => sampled_set(&form, samples),
        };
        if form.mass.len() > 1 {
            set.set_exact_extremes(&form);
        }
        if let Some(beta) = set.balance.position()
            && form.transfer.is_finite()
        {
            let largest = set.amplitude_m.map_or(0.0, |(_, largest)| largest);
            set.amplitude_m = Some((0.0, largest));
            set.min_amplitude_beta_rad = Some(beta.to_vec());
        }
        Some(set)
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

    /// Passes all positions to `show`, one angle per ball in rad, with the friction and amplitude
    /// there, one at a time and always in the same order. Passes none for a grid with more than two
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
                        show(&grid.beta(row, column), grid.at(&values, column))?;
                    }
                }
            }
            Resolution::Samples(samples) => {
                for replicate in 0..REPLICATES {
                    for index in 0..samples {
                        let beta = set_samples::sample(form.mass.len(), replicate, index);
                        show(&beta, form.at_rest(&beta))?;
                    }
                }
            }
        }
        Ok(())
    }
}

fn set_of_one_ball(form: &RestForm) -> EquilibriumSet {
    let arcs = Arcs::of(form);
    let amplitude = |beta: &f64| form.at_rest(&[*beta]).amplitude_m;
    let smallest = arcs.candidates().min_by(|a, b| amplitude(a).total_cmp(&amplitude(b)));
    let largest_m = arcs.candidates().map(|beta| amplitude(&beta)).fold(0.0, f64::max);
    EquilibriumSet {
        fraction: arcs.fraction(),
        fraction_interval: None,
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
    let frictionless = if form.speed == 0.0 { Vec::new() } else { equilibrium_positions(form) };
    EquilibriumSet {
        fraction: summary.inside as f64 / grid.size() as f64,
        fraction_interval: None,
        components: Some(components),
        components_modulo_exchange: exchanged.filter(|_| identical).or(Some(components)),
        unseen: Some(frictionless.iter().filter(|one| !grid.sees(&one.beta)).count() as u64),
        amplitude_m: summary.amplitudes.map(|[low, high]| (low.0 * radius, high.0 * radius)),
        min_amplitude_beta_rad: summary
            .amplitudes
            .map(|[(_, [row, column]), _]| grid.beta(row, column)),
        balance: Balance::of(form),
    }
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
        .map(|replicate| f64::from(replicate.inside) / f64::from(samples))
        .collect();
    let (fraction, interval) = set_samples::fraction_with_interval(&fractions, samples);
    let all = replicates.into_iter().fold(SampleSums::default(), SampleSums::merged);
    EquilibriumSet {
        fraction,
        fraction_interval: Some(interval),
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
    inside: u32,
    smallest: Option<(f64, Vec<f64>)>,
    largest_m: f64,
}

impl SampleSums {
    fn add(&mut self, form: &RestForm, beta: Vec<f64>) {
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
            (Some(one), Some(other)) => Some(if other.0 < one.0 { other } else { one }),
            (one, other) => one.or(other),
        };
        SampleSums {
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
/// share in the fraction ([`touching_set_fraction`]).
///
/// The fraction is exact for one ball, accurate to about 0.001 for two balls (a grid of 256 × 256
/// points), and to 0.005 for more (16,384 quasi-random points). `None` for an unsupported number of
/// balls.
pub fn set_fraction(machine: &Machine) -> Option<f64> {
    let form = RestForm::new(machine)?;
    match form.mass.len() {
        1 => Some(Arcs::of(&form).fraction()),
        2 => Some(SetGrid::new(&form, FRACTION_GRID)?.fraction()),
        _ => Some(set_samples::fraction(&form)),
    }
}

/// Number of positions at which two balls touch, in either order, for [`touching_set_fraction`].
const TOUCHING_POSITIONS: usize = 4096;

/// Returns the fraction of the positions in which two balls touch that are equilibria, with the force between the balls, to
/// about 0.0005. `None` for balls without contact and for another number of balls than two.
pub fn touching_set_fraction(machine: &Machine) -> Option<f64> {
    let positions = touching_positions(machine, TOUCHING_POSITIONS)?;
    let rests = positions.iter().filter(|(_, rests)| *rests).count();
    Some(rests as f64 / TOUCHING_POSITIONS as f64)
}

/// Returns this number of positions in which two balls touch, each with whether it is an equilibrium with the force between
/// the balls: around the ring with ball 2 ahead of ball 1, then around the ring with ball 2 behind. `None` for balls without
/// contact and for another number of balls than two.
pub fn touching_positions(machine: &Machine, count: usize) -> Option<Vec<([f64; 2], bool)>> {
    let contact = machine.contact?;
    let system = BallsInContact::<2>::new(machine, &contact, &[0.0, 1.0])?;
    let touching = machine.contact_angle_rad(&machine.balls[0], &machine.balls[1]);
    let position = |number: usize| {
        let first = number as f64 / count as f64 * 2.0 * TAU;
        // On the second way round, the second ball is behind.
        let second = if first < TAU { first + touching } else { first - touching };
        let beta = [first, second].map(wrap_to_two_pi);
        (beta, system.holds_at_rest(&beta))
    };
    Some((0..count).map(position).collect())
}
