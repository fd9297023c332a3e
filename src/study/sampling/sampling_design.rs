//! Sampling designs: the start state of a sample, computed from its index alone.

use std::collections::HashSet;
use std::f64::consts::TAU;
use std::ops::Range;
use std::sync::Arc;

use crate::model::MAX_BALLS;
use crate::study::file::values::MAX_COUNT;
use crate::study::sampling::draw::{DrawKey, RandomOrder};
use crate::study::sampling::initial_box::{BoxAxis, InitialBox};

/// The largest number of samples of a Sobol' design, which is the length of the library's sequence.
pub(crate) const MAX_SOBOL_SAMPLES: u64 = 65_536;

/// The number of dimensions of the library's Sobol' sequence.
pub(crate) const SOBOL_DIMENSIONS: u32 = sobol_burley::NUM_DIMENSIONS;

/// How the samples of a point are laid out.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Layout {
    Stratified {
        parts: u64,
        samples_per_cell: u64,
    },
    LatinHypercube {
        samples: u64,
    },
    Sobol {
        samples: u64,
    },
    MonteCarlo {
        samples: u64,
    },
    Grid {
        points: u64,
    },
    /// Given start states; each row contains the coordinates in the order of the axes.
    Table {
        rows: Arc<Vec<Vec<f64>>>,
    },
}

/// A layout over a box with the keys of its random numbers. Every sample is a function of its
/// index.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Design {
    /// The layout.
    pub layout: Layout,
    axes: Vec<AxisDraws>,
    sobol_seed: u32,
    seed: u64,
}

#[derive(Clone, Debug, PartialEq)]
struct AxisDraws {
    axis: BoxAxis,
    key: DrawKey,
    order: Option<RandomOrder>,
    dimension: u32,
}

/// The position of a sample in its design.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct SampleId {
    /// Cell of a stratified design, point of a grid or row of a table; otherwise zero.
    pub cell: u64,
    /// Number of the sample within its cell.
    pub replicate: u64,
}

impl Design {
    /// Creates a design over a box. The names of the axes key the random numbers.
    pub fn new(layout: Layout, start_box: &InitialBox, seed: u64) -> Design {
        let axes = start_box
            .axes
            .iter()
            .zip(sobol_dimensions(&start_box.axes))
            .map(|(axis, dimension)| {
                let order = match layout {
                    Layout::LatinHypercube { samples } => {
                        let key = DrawKey::new(seed, "latin_hypercube order", &axis.name);
                        Some(RandomOrder::new(&key, samples))
                    }
                    _ => None,
                };
                AxisDraws {
                    axis: axis.clone(),
                    key: DrawKey::new(seed, layout.kind(), &axis.name),
                    order,
                    dimension,
                }
            })
            .collect();
        let sobol_seed = DrawKey::new(seed, "sobol", "scramble").bits(0, 0) as u32;
        Design { layout, axes, sobol_seed, seed }
    }

    /// Returns the range of each coordinate.
    pub fn ranges(&self) -> Vec<[f64; 2]> {
        self.axes.iter().map(|AxisDraws { axis, .. }| [axis.low, axis.high]).collect()
    }

    /// Returns the seed of the scrambled Sobol' sequence, and its first dimension that no axis uses.
    pub fn further_dimensions(&self) -> (u32, u32) {
        let taken = self.axes.iter().map(|draws| draws.dimension + 1).max().unwrap_or(0);
        // A further ball keeps the draws of the parameters.
        let of_balls = if taken > 4 { 4 + 2 * MAX_BALLS as u32 } else { 0 };
        (self.sobol_seed, taken.max(of_balls))
    }

    /// Returns the factors whose product is the number of samples at one point.
    pub fn factors(&self) -> Vec<u64> {
        match &self.layout {
            Layout::Stratified { parts, samples_per_cell } => {
                let mut factors = vec![*parts; self.free_axes()];
                factors.push(*samples_per_cell);
                factors
            }
            Layout::LatinHypercube { samples }
            | Layout::Sobol { samples }
            | Layout::MonteCarlo { samples } => vec![*samples],
            Layout::Grid { points } => vec![*points; self.free_axes()],
            Layout::Table { rows } => vec![rows.len() as u64],
        }
    }

    /// Returns the number of samples in one further replicate of a design of `first` samples, and
    /// the largest total number of samples. Returns `None` if the design cannot be enlarged.
    pub fn enlargement(&self, first: u64) -> Option<(u64, u64)> {
        match &self.layout {
            Layout::Stratified { samples_per_cell, .. } => {
                Some((first / (*samples_per_cell).max(1), MAX_COUNT))
            }
            Layout::Sobol { samples } => Some((*samples, MAX_SOBOL_SAMPLES)),
            Layout::MonteCarlo { samples } => Some((*samples, MAX_COUNT)),
            Layout::LatinHypercube { .. } | Layout::Grid { .. } | Layout::Table { .. } => None,
        }
    }

    /// Returns whether the start states are random.
    pub fn is_random(&self) -> bool {
        !matches!(self.layout, Layout::Grid { .. } | Layout::Table { .. }) && self.free_axes() > 0
    }

    /// Returns the cell and replicate of a sample. In a stratified design, every cell has its first
    /// sample before any cell has its second, so that additional samples per cell come last.
    pub fn identify(&self, sample: u64) -> SampleId {
        match &self.layout {
            Layout::Stratified { parts, .. } => {
                let cells = self.cells_of(*parts);
                SampleId { cell: sample % cells, replicate: sample / cells }
            }
            Layout::Grid { .. } | Layout::Table { .. } => SampleId { cell: sample, replicate: 0 },
            _ => SampleId { cell: 0, replicate: sample },
        }
    }

    /// Returns the number of cells of a stratified design, or `None` for any other design.
    pub fn cells(&self) -> Option<u64> {
        match self.layout {
            Layout::Stratified { parts, .. } => Some(self.cells_of(parts)),
            _ => None,
        }
    }

    fn cells_of(&self, parts: u64) -> u64 {
        let free = u32::try_from(self.free_axes()).unwrap_or(u32::MAX);
        parts.saturating_pow(free).max(1)
    }

    /// Returns the coordinates of a sample, in the order of the axes.
    pub fn coordinates(&self, id: SampleId) -> Vec<f64> {
        if let Layout::Table { rows } = &self.layout {
            let row = usize::try_from(id.cell).ok().and_then(|row| rows.get(row));
            return row.cloned().unwrap_or_else(|| vec![0.0; self.axes.len()]);
        }
        let mut digits = id.cell;
        let mut coordinates: Vec<f64> = self
            .axes
            .iter()
            .rev()
            .map(|draws| {
                if draws.axis.is_fixed() {
                    return draws.axis.low;
                }
                let fraction = self.fraction(draws, &mut digits, id);
                draws.axis.at(fraction)
            })
            .collect();
        coordinates.reverse();
        coordinates
    }

    /// Returns whether each of these axes covers a whole circle by random draws.
    pub fn covers_circle(&self, axes: Range<usize>) -> bool {
        let covers = |draws: &AxisDraws| draws.axis.high - draws.axis.low >= TAU - 1e-9;
        self.is_random() && self.axes[axes].iter().all(covers)
    }

    /// Returns the coordinates of a sample with other draws for some axes, in the same cell of the design. `draw` numbers
    /// the draws from 1.
    pub fn coordinates_drawn_again(&self, id: SampleId, axes: Range<usize>, draw: u64) -> Vec<f64> {
        let mut again = self.clone();
        let kind = format!("{} draw {draw}", self.layout.kind());
        for draws in &mut again.axes[axes.clone()] {
            draws.key = DrawKey::new(self.seed, &kind, &draws.axis.name);
        }
        let mut coordinates = again.coordinates(id);
        if matches!(self.layout, Layout::Sobol { .. }) {
            // A point of the sequence has no cell.
            for (place, draws) in axes.clone().zip(&again.axes[axes]) {
                coordinates[place] = draws.axis.at(draws.key.uniform(id.cell, id.replicate));
            }
        }
        coordinates
    }

    /// Returns the fraction of an axis's range at which a sample lies, and removes the axis's digit
    /// from the cell number.
    fn fraction(&self, draws: &AxisDraws, digits: &mut u64, id: SampleId) -> f64 {
        let uniform = || draws.key.uniform(id.cell, id.replicate);
        let mut digit = |parts: u64| {
            let digit = *digits % parts;
            *digits /= parts;
            digit
        };
        match &self.layout {
            Layout::Stratified { parts, .. } => within(digit(*parts), *parts, uniform()),
            Layout::Grid { points } => within(digit(*points), *points, 0.5),
            Layout::LatinHypercube { samples } => {
                let stratum = draws.order.as_ref().map_or(0, |order| order.at(id.replicate));
                within(stratum, *samples, uniform())
            }
            Layout::Sobol { .. } => sobol_fraction(id.replicate, draws.dimension, self.sobol_seed),
            Layout::MonteCarlo { .. } | Layout::Table { .. } => uniform(),
        }
    }

    fn free_axes(&self) -> usize {
        self.axes.iter().filter(|draws| !draws.axis.is_fixed()).count()
    }
}

impl Layout {
    /// Returns the name of the design in a study file.
    pub fn kind(&self) -> &'static str {
        match self {
            Layout::Stratified { .. } => "stratified",
            Layout::LatinHypercube { .. } => "latin_hypercube",
            Layout::Sobol { .. } => "sobol",
            Layout::MonteCarlo { .. } => "monte_carlo",
            Layout::Grid { .. } => "grid",
            Layout::Table { .. } => "table",
        }
    }
}

/// Returns a number of a scrambled Sobol' sequence: a multiple of 2^-23 from 0 to below 1.
pub(crate) fn sobol_fraction(sample: u64, dimension: u32, seed: u32) -> f64 {
    let index = u32::try_from(sample).unwrap_or(0);
    f64::from(sobol_burley::sample(index, dimension, seed))
}

/// Maps a fraction into one of several equal parts of the unit interval; rounding never leaves the
/// part.
pub(crate) fn within(part: u64, parts: u64, fraction: f64) -> f64 {
    let upper = (part + 1) as f64 / parts as f64;
    ((part as f64 + fraction) / parts as f64).min(upper.next_down())
}

/// Returns the dimension of the Sobol' sequence for each axis; no two axes share one. Axes of the crate's own models have
/// dimensions by their names, which do not depend on the number of balls. Those of other models have their places.
fn sobol_dimensions(axes: &[BoxAxis]) -> Vec<u32> {
    let known: Option<Vec<u32>> = axes.iter().map(|axis| known_dimension(&axis.name)).collect();
    let distinct = |known: &Vec<u32>| known.iter().collect::<HashSet<_>>().len() == known.len();
    known.filter(distinct).unwrap_or_else(|| (0..).take(axes.len()).collect())
}

fn known_dimension(axis: &str) -> Option<u32> {
    let of_ball = |ball: &str, offset: u32| {
        let ball = ball.parse().ok().filter(|ball| (1..=MAX_BALLS as u32).contains(ball))?;
        Some(2 + 2 * ball + offset)
    };
    match axis {
        "x" | "position_m" => Some(0),
        "y" | "velocity_m_s" => Some(1),
        "x_dot" => Some(2),
        "y_dot" => Some(3),
        _ => match axis.strip_prefix("beta_dot_") {
            Some(ball) => of_ball(ball, 1),
            None => of_ball(axis.strip_prefix("beta_")?, 0),
        },
    }
}

#[cfg(test)]
mod tests {
    use super::{BoxAxis, sobol_dimensions};

    fn dimensions(names: &[&str]) -> Vec<u32> {
        let axis = |name: &&str| BoxAxis { name: (*name).to_owned(), low: 0.0, high: 1.0 };
        sobol_dimensions(&names.iter().map(axis).collect::<Vec<_>>())
    }

    #[test]
    fn every_axis_has_a_dimension_of_its_own() {
        assert_eq!(dimensions(&["position_m", "velocity_m_s"]), [0, 1]);
        let two = ["x", "y", "beta_1", "beta_2", "x_dot", "y_dot", "beta_dot_1", "beta_dot_2"];
        assert_eq!(dimensions(&two), [0, 1, 4, 6, 2, 3, 5, 7]);
        // Axes of models outside of the crate.
        let names = ["position_1_m", "position_2_m", "velocity_1_m_s", "velocity_2_m_s"];
        assert_eq!(dimensions(&names), [0, 1, 2, 3]);
        assert_eq!(dimensions(&["angle_rad", "x"]), [0, 1]);
        assert_eq!(dimensions(&["x", "position_m"]), [0, 1]);
        assert_eq!(dimensions(&["beta_9", "beta_1"]), [0, 1]);
    }
}
