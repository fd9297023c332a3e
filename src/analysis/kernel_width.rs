//! How wide the kernels of a density should be: as wide as predicts each run best from the others.
//!
//! Of some widths, the one with the greatest likelihood of every run under the estimate made without it
//! (leave-one-out cross-validation; M. Rudemo, Scand. J. Stat. 9 (1982) 65, B. W. Silverman, *Density
//! Estimation*, Chapman and Hall 1986, section 3.4.4, doi:10.1201/9781315140919). It follows clusters
//! as narrow as a kernel and broad clouds alike, which a rule for one scale cannot. Angles are counted
//! in cells of 3°, so that it takes the same time and memory for any number of runs. Under no width is a
//! run less likely than a thousandth of an even spread: one run far from all others decides nothing.

use std::f64::consts::TAU;

/// The standard deviations to choose from, rad.
pub(super) const WIDTHS_RAD: [f64; 8] = [0.05, 0.07, 0.1, 0.14, 0.2, 0.28, 0.4, 0.56];
/// Cells per angle.
const CELLS: usize = 120;
/// Of the greatest weight of a kernel, what is left out.
const LEFT_OUT: f64 = 1e-9;

/// The width for counts in fine bins of one angle, or of two (the last changing fastest); `mirrored`
/// pairs are counted in both orders.
pub(super) fn width_rad(fine: &[u64], angles: usize, mirrored: bool) -> f64 {
    let per_angle = if angles == 1 { fine.len() } else { fine.len().isqrt() };
    let cell = |place: usize| place * CELLS / per_angle;
    let mut counts = vec![0; CELLS.pow(angles as u32)];
    for (place, &count) in fine.iter().enumerate().filter(|(_, count)| **count > 0) {
        let index = match angles {
            1 => cell(place),
            _ => cell(place / per_angle) * CELLS + cell(place % per_angle),
        };
        counts[index] += count;
    }
    // Where all are equally likely, the widest.
    let mut best = (f64::NEG_INFINITY, WIDTHS_RAD[WIDTHS_RAD.len() - 1]);
    for width in WIDTHS_RAD.into_iter().rev() {
        let likelihood = log_likelihood(&counts, angles, mirrored, width);
        if likelihood > best.0 {
            best = (likelihood, width);
        }
    }
    best.1
}

/// The logarithm of the likelihood of all runs, each under the estimate without it.
fn log_likelihood(counts: &[u64], angles: usize, mirrored: bool, width_rad: f64) -> f64 {
    let kernel = kernel(width_rad);
    let own = if mirrored { 2 } else { 1 };
    let others = counts.iter().sum::<u64>().saturating_sub(own) as f64;
    let sums = match angles {
        1 => round(&kernel, counts.iter().map(|&count| count as f64)),
        _ => {
            let rows = counts.chunks(CELLS);
            let rows = rows.map(|row| round(&kernel, row.iter().map(|&count| count as f64)));
            let rows: Vec<Vec<f64>> = rows.collect();
            let columns =
                (0..CELLS).map(|column| round(&kernel, rows.iter().map(|row| row[column])));
            let columns: Vec<Vec<f64>> = columns.collect();
            (0..CELLS * CELLS).map(|cell| columns[cell % CELLS][cell / CELLS]).collect()
        }
    };
    let floor = 1e-3 / TAU.powi(angles as i32);
    let mut sum = 0.0;
    for (cell, &count) in counts.iter().enumerate().filter(|(_, count)| **count > 0) {
        let (first, second) = (cell / CELLS, cell % CELLS);
        let mut itself = kernel[0].powi(angles as i32);
        if mirrored {
            itself += kernel[first.abs_diff(second)].powi(2);
        }
        let density = if others > 0.0 { (sums[cell] - itself) / others } else { 0.0 };
        sum += count as f64 * libm::log(density.max(floor));
    }
    sum
}

/// The von Mises density between cells so many apart.
fn kernel(width_rad: f64) -> Vec<f64> {
    let concentration = 1.0 / (width_rad * width_rad);
    let step = TAU / CELLS as f64;
    let weight = |apart: usize| libm::exp(concentration * (libm::cos(step * apart as f64) - 1.0));
    let whole: f64 = (0..CELLS).map(|apart| weight(apart) * step).sum();
    (0..CELLS).map(|apart| weight(apart) / whole).collect()
}

/// Sums of kernels about cells round a circle, at each cell.
fn round(kernel: &[f64], counts: impl Iterator<Item = f64>) -> Vec<f64> {
    let reach = kernel.iter().take(CELLS / 2).take_while(|weight| **weight > LEFT_OUT * kernel[0]);
    let reach = reach.count();
    let mut sums = vec![0.0; CELLS];
    for (cell, count) in counts.enumerate().filter(|(_, count)| *count > 0.0) {
        sums[cell] += count * kernel[0];
        for apart in 1..reach {
            let weight = count * kernel[apart];
            sums[(cell + apart) % CELLS] += weight;
            sums[(cell + CELLS - apart) % CELLS] += weight;
        }
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::{CELLS, WIDTHS_RAD, kernel, log_likelihood, width_rad};
    use crate::analysis::draws::Draws;

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
                let kernel = kernel(width);
                let apart = |a: usize, b: usize| kernel[a.abs_diff(b)];
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
                let found = log_likelihood(&counts, angles, mirrored, width);
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
            width_rad(&fine, 2, false)
        };
        assert_eq!(width(2000.0), 0.05);
        assert!((0.14..=0.4).contains(&width(4.0)));
        assert!(width(0.01) >= 0.4);
        assert_eq!(width_rad(&[0; 360], 1, false), 0.56);
        assert_eq!(width_rad(&[1; 1], 1, false), 0.56);
    }
}
