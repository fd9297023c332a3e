//! How wide the kernels of a density should be: as wide as predicts each run best from the others.
//!
//! Of some widths, the one with the greatest likelihood of every run under the estimate made without it
//! (leave-one-out cross-validation; M. Rudemo, Scand. J. Stat. 9 (1982) 65, B. W. Silverman, *Density
//! Estimation*, Chapman and Hall 1986, section 3.4.4, doi:10.1201/9781315140919). It follows clusters
//! as narrow as a kernel and broad clouds alike, which a rule for one scale cannot. Angles are counted
//! in cells of 3°, so that it takes the same time and memory for any number of runs. Under no width is a
//! run less likely than a thousandth of an even spread: one run far from all others decides nothing.

use std::f64::consts::TAU;
use std::sync::LazyLock;

/// The standard deviations to choose from, rad.
pub(super) const WIDTHS_RAD: [f64; 8] = [0.05, 0.07, 0.1, 0.14, 0.2, 0.28, 0.4, 0.56];
/// Cells per angle.
const CELLS: usize = 120;
/// Of the greatest weight of a kernel, what is left out.
const LEFT_OUT: f64 = 1e-9;

/// The width for counts in fine bins, those of one angle or of two (the last changing fastest) in
/// ascending order; `mirrored` pairs are counted in both orders.
pub(super) fn width_rad(
    fine: &[(usize, u64)],
    per_angle: usize,
    angles: usize,
    mirrored: bool,
) -> f64 {
    static KERNELS: LazyLock<[Kernel; 8]> = LazyLock::new(|| WIDTHS_RAD.map(Kernel::new));
    let cell = |place: usize| place * CELLS / per_angle;
    let mut cells: Vec<Occupied> = fine
        .iter()
        .map(|&(place, count)| {
            let row = if angles == 1 { 0 } else { cell(place / per_angle) };
            Occupied { row, column: cell(place % per_angle), count }
        })
        .collect();
    cells.sort_unstable_by_key(|cell| (cell.row, cell.column));
    cells.dedup_by(|next, kept| {
        let same = (next.row, next.column) == (kept.row, kept.column);
        kept.count += if same { next.count } else { 0 };
        same
    });
    // Where all are equally likely, the widest.
    let mut best = (f64::NEG_INFINITY, WIDTHS_RAD[WIDTHS_RAD.len() - 1]);
    for (width, kernel) in WIDTHS_RAD.into_iter().zip(&*KERNELS).rev() {
        let likelihood = log_likelihood(&cells, angles, mirrored, kernel);
        if likelihood > best.0 {
            best = (likelihood, width);
        }
    }
    best.1
}

/// A cell that runs are in; of one angle the row is 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Occupied {
    row: usize,
    column: usize,
    count: u64,
}

/// The logarithm of the likelihood of all runs, each under the estimate without it. The cells are
/// those that are occupied, in ascending order: the estimate is needed nowhere else.
fn log_likelihood(cells: &[Occupied], angles: usize, mirrored: bool, kernel: &Kernel) -> f64 {
    let own = if mirrored { 2 } else { 1 };
    let others = cells.iter().map(|cell| cell.count).sum::<u64>().saturating_sub(own) as f64;
    let floor = 1e-3 / TAU.powi(angles as i32);
    let rows: Vec<&[Occupied]> = cells.chunk_by(|a, b| a.row == b.row).collect();
    let smoothed: Vec<[f64; CELLS]> = rows.iter().map(|row| kernel.round(row)).collect();
    let mut sum = 0.0;
    let mut estimates = [0.0; CELLS];
    for (at, row) in rows.iter().enumerate() {
        let estimates = &mut estimates[..row.len()];
        if angles == 1 {
            estimates.iter_mut().zip(*row).for_each(|(sum, cell)| *sum = smoothed[at][cell.column]);
        } else {
            estimates.fill(0.0);
            for (other, smoothed) in rows.iter().zip(&smoothed) {
                let weight = kernel.between(other[0].row, row[0].row);
                if weight > 0.0 {
                    let pairs = estimates.iter_mut().zip(*row);
                    pairs.for_each(|(sum, cell)| *sum += smoothed[cell.column] * weight);
                }
            }
        }
        for (estimate, cell) in estimates.iter().zip(*row) {
            let mut itself = kernel.apart[0].powi(angles as i32);
            if mirrored {
                itself += kernel.apart[cell.row.abs_diff(cell.column)].powi(2);
            }
            let density = if others > 0.0 { (estimate - itself) / others } else { 0.0 };
            sum += cell.count as f64 * libm::log(density.max(floor));
        }
    }
    sum
}

/// A kernel round a circle of cells.
struct Kernel {
    /// The von Mises density between cells so many apart.
    apart: [f64; CELLS],
    /// The same from `CELLS` cells before to as many after, without what is left out.
    about: [f64; 2 * CELLS],
}

impl Kernel {
    fn new(width_rad: f64) -> Self {
        let concentration = 1.0 / (width_rad * width_rad);
        let step = TAU / CELLS as f64;
        let weight =
            |apart: usize| libm::exp(concentration * (libm::cos(step * apart as f64) - 1.0));
        let whole: f64 = (0..CELLS).map(|apart| weight(apart) * step).sum();
        let apart = std::array::from_fn(|apart| weight(apart) / whole);
        let far = apart[..CELLS / 2].iter().position(|weight| *weight <= LEFT_OUT * apart[0]);
        let reach = far.unwrap_or(CELLS / 2);
        let about = std::array::from_fn(|place| {
            let way = place % CELLS;
            let way = way.min(CELLS - way);
            if way < reach { apart[way] } else { 0.0 }
        });
        Kernel { apart, about }
    }

    fn between(&self, from: usize, to: usize) -> f64 {
        self.about[CELLS + to - from]
    }

    /// Sums of kernels about the cells of a row, at each cell.
    fn round(&self, row: &[Occupied]) -> [f64; CELLS] {
        let mut sums = [0.0; CELLS];
        for cell in row {
            let count = cell.count as f64;
            let weights = &self.about[CELLS - cell.column..][..CELLS];
            sums.iter_mut().zip(weights).for_each(|(sum, weight)| *sum += count * weight);
        }
        sums
    }
}

#[cfg(test)]
mod tests {
    use super::{CELLS, Kernel, Occupied, WIDTHS_RAD, log_likelihood, width_rad};
    use crate::analysis::draws::Draws;

    fn sparse(counts: &[u64]) -> Vec<(usize, u64)> {
        counts.iter().copied().enumerate().filter(|(_, count)| *count > 0).collect()
    }

    /// Against the definition, run by run, for one angle, two, and two that are alike.
    #[test]
    fn likelihoods_are_those_of_each_run_without_itself() {
        let mut draws = Draws::new(5);
        for (angles, mirrored) in [(1, false), (2, false), (2, true)] {
            let cell = |draws: &mut Draws| 40 + (30.0 * draws.uniform() * draws.uniform()) as usize;
            let runs: Vec<[usize; 2]> =
                (0..40).map(|_| [cell(&mut draws), cell(&mut draws)]).collect();
            let mut counts = vec![0; CELLS.pow(angles as u32)];
            let places = |run: [usize; 2]| match (angles, mirrored) {
                (1, _) => vec![run[0]],
                (_, false) => vec![run[0] * CELLS + run[1]],
                (_, true) => vec![run[0] * CELLS + run[1], run[1] * CELLS + run[0]],
            };
            for &run in &runs {
                places(run).into_iter().for_each(|place| counts[place] += 1);
            }
            for width in WIDTHS_RAD {
                let kernel = Kernel::new(width);
                let apart = |a: usize, b: usize| kernel.apart[a.abs_diff(b)];
                let between = |a: usize, b: usize| match angles {
                    1 => apart(a, b),
                    _ => apart(a / CELLS, b / CELLS) * apart(a % CELLS, b % CELLS),
                };
                let mut expected = 0.0;
                for (index, &run) in runs.iter().enumerate() {
                    for place in places(run) {
                        let others = runs.iter().enumerate().filter(|(other, _)| *other != index);
                        let others: Vec<usize> =
                            others.flat_map(|(_, &other)| places(other)).collect();
                        let sum: f64 = others.iter().map(|&other| between(place, other)).sum();
                        let floor = 1e-3 / std::f64::consts::TAU.powi(angles as i32);
                        expected += (sum / others.len() as f64).max(floor).ln();
                    }
                }
                let occupied = |&(cell, count): &(usize, u64)| {
                    let (row, column) = (cell / CELLS, cell % CELLS);
                    Occupied { row, column, count }
                };
                let cells: Vec<Occupied> = sparse(&counts).iter().map(occupied).collect();
                let found = log_likelihood(&cells, angles, mirrored, &kernel);
                assert!((found / expected - 1.0).abs() < 1e-6, "{angles} {width}: {found}");
            }
        }
    }

    /// Narrow clusters get narrow kernels, broad clouds broad ones, nothing the broadest.
    #[test]
    fn widths_follow_the_runs() {
        let mut draws = Draws::new(6);
        let mut width = |concentration: f64| {
            let mut fine = vec![0; 360 * 360];
            for run in 0..200 {
                let beta = [0, 1]
                    .map(|_| draws.von_mises(if run % 2 == 0 { 1.0 } else { 4.0 }, concentration));
                let [a, b] = beta.map(|angle| {
                    (angle.rem_euclid(std::f64::consts::TAU).to_degrees()) as usize % 360
                });
                fine[a * 360 + b] += 1;
            }
            width_rad(&sparse(&fine), 360, 2, false)
        };
        assert_eq!(width(2000.0), 0.05);
        assert!((0.14..=0.4).contains(&width(4.0)));
        assert!(width(0.01) >= 0.4);
        assert_eq!(width_rad(&[], 360, 1, false), 0.56);
        assert_eq!(width_rad(&[(0, 1)], 360, 1, false), 0.56);
    }
}
