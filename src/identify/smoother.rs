//! Densities between parameter sets: local quadratic regression over the parameters.
//!
//! The density of a measurement at a place is a weighted sum of its densities for the parameter sets around it. The weights are
//! those of a quadratic polynomial that is fitted with weights that fall with the distance (W. S. Cleveland and S. J. Devlin 1988,
//! doi:10.1080/01621459.1988.10478639). They are the same for all measurements. Because runs of several parameter sets
//! contribute, the error of a finite number of runs is smaller than that of one set.

use nalgebra::{DMatrix, DVector};

/// Where the weight becomes zero, in widths, squared.
const REACH_SQUARED: f64 = 8.0;
/// At least this many times as many sets as the polynomial has coefficients are nearer than `sqrt(REACH_SQUARED / 2)` widths.
const SETS_PER_COEFFICIENT: f64 = 1.5;
/// A ridge that keeps the regression regular.
const RIDGE: f64 = 1e-9;
/// A smoothed density is at least this part of the plain mean.
const LEAST_OF_MEAN: f64 = 0.2;

/// The weights of a parameter set.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SetWeight {
    /// The number of the set.
    pub set: usize,
    /// Its weight in the regression.
    pub regression: f64,
    /// Its weight in a plain mean.
    pub mean: f64,
}

/// A local regression over places in the unit cube.
#[derive(Clone, Debug)]
pub struct Smoother {
    /// The places of the parameter sets.
    pub places: Vec<Vec<f64>>,
    /// The width of the weight in each coordinate.
    pub widths: Vec<f64>,
}

impl Smoother {
    /// Returns the regression over parameter sets at these places.
    pub fn new(places: Vec<Vec<f64>>, widths: Vec<f64>) -> Self {
        Smoother { places, widths }
    }

    /// Returns the weights of the parameter sets at a place: those of the regression and those of a plain mean, which are
    /// positive. The sum of either is 1. Each set has an own weight `of_set` besides that of its distance; sets whose own weight
    /// is 0 are left out.
    pub fn weights(&self, place: &[f64], of_set: impl Fn(usize) -> f64) -> Vec<SetWeight> {
        let dimensions = place.len();
        let scaled = |set: usize| {
            let parts = self.places[set].iter().zip(place).zip(&self.widths);
            parts.map(|((set, place), width)| (set - place) / width)
        };
        let sets = (0..self.places.len()).filter(|set| of_set(*set) > 0.0);
        let mut near: Vec<(usize, f64)> =
            sets.map(|set| (set, scaled(set).map(|x| x * x).sum())).collect();
        // A quadratic polynomial where there are enough sets, else a linear one.
        let quadratic = 1 + dimensions + dimensions * (dimensions + 1) / 2;
        let is_quadratic = near.len() >= 2 * quadratic;
        let coefficients = if is_quadratic { quadratic } else { 1 + dimensions };
        let needed = ((SETS_PER_COEFFICIENT * coefficients as f64) as usize).min(near.len());
        let Some(last) = needed.checked_sub(1) else { return Vec::new() };
        let mut distances: Vec<f64> = near.iter().map(|(_, distance)| *distance).collect();
        let (_, last, _) = distances.select_nth_unstable_by(last, f64::total_cmp);
        // Where few sets are near, the weights are wider.
        let reach = REACH_SQUARED.max(2.0 * *last);
        // Nearly `exp(-distance / 2)`, if `distance` is the squared distance in widths.
        let weight = |(set, distance): &(usize, f64)| {
            of_set(*set) * (1.0 - distance / reach).max(0.0).powi(4)
        };
        near.retain(|(_, distance)| *distance < reach);
        let row = |from: &[f64]| -> Vec<f64> {
            let mut row = vec![1.0];
            row.extend_from_slice(from);
            if is_quadratic {
                for (index, x) in from.iter().enumerate() {
                    row.extend(from[index..].iter().map(|y| x * y));
                }
            }
            row
        };
        let rows: Vec<Vec<f64>> =
            near.iter().map(|(set, _)| row(&scaled(*set).collect::<Vec<f64>>())).collect();
        let mut matrix = DMatrix::<f64>::zeros(coefficients, coefficients);
        for (row, neighbour) in rows.iter().zip(&near) {
            let weight = weight(neighbour);
            for (i, x) in row.iter().enumerate() {
                for (j, y) in row.iter().enumerate() {
                    matrix[(i, j)] += weight * x * y;
                }
            }
        }
        for i in 1..coefficients {
            matrix[(i, i)] += RIDGE * matrix[(0, 0)];
        }
        let mut first = DVector::<f64>::zeros(coefficients);
        first[0] = 1.0;
        let solution = matrix.cholesky().map(|factors| factors.solve(&first));
        let weighted = rows.iter().zip(&near).map(|(row, neighbour)| {
            let value = match &solution {
                Some(solution) => row.iter().zip(solution.iter()).map(|(x, y)| x * y).sum(),
                None => 1.0,
            };
            let mean = weight(neighbour);
            SetWeight { set: neighbour.0, regression: mean * value, mean }
        });
        let weighted: Vec<SetWeight> = weighted.collect();
        let regression: f64 = weighted.iter().map(|weight| weight.regression).sum();
        let mean: f64 = weighted.iter().map(|weight| weight.mean).sum();
        let scaled = |weight: SetWeight| SetWeight {
            set: weight.set,
            regression: weight.regression / regression,
            mean: weight.mean / mean,
        };
        weighted.into_iter().map(scaled).collect()
    }
}

/// Returns the sums of the regression and of the plain mean over the parameter sets.
pub fn sums(parts: impl Iterator<Item = (SetWeight, f64)>) -> [f64; 2] {
    parts.fold([0.0; 2], |[regression, mean], (weight, value)| {
        [regression + weight.regression * value, mean + weight.mean * value]
    })
}

/// Returns a smoothed density: that of the regression, but at least a part of the mean, because a polynomial may be negative.
pub fn positive([regression, mean]: [f64; 2]) -> f64 {
    regression.max(LEAST_OF_MEAN * mean)
}

#[cfg(test)]
mod tests {
    use super::{SetWeight, Smoother, positive, sums};

    fn scattered(count: u32) -> Vec<Vec<f64>> {
        let at = |index, dimension| f64::from(sobol_burley::sample(index, dimension, 3));
        (0..count).map(|index| vec![at(index, 0), at(index, 1)]).collect()
    }

    /// Quadratic polynomials are reproduced exactly, everywhere in the cube, also with a set left out or with other own weights.
    #[test]
    fn quadratic_polynomials_are_exact() {
        let smoother = Smoother::new(scattered(64), vec![0.1, 0.3]);
        let polynomial = |place: &[f64]| {
            let [x, y] = [place[0], place[1]];
            1.0 + 2.0 * x - y + 3.0 * x * x - x * y + 0.5 * y * y
        };
        for place in [[0.5, 0.5], [0.0, 1.0], [0.02, 0.4]] {
            for (of_fifth, others) in [(1.0, 1.0), (0.0, 1.0), (3.0, 0.5)] {
                let of_set = |set| if set == 5 { of_fifth } else { others };
                let weights = smoother.weights(&place, of_set);
                let value: f64 = weights
                    .iter()
                    .map(|weight| weight.regression * polynomial(&smoother.places[weight.set]))
                    .sum();
                assert!((value - polynomial(&place)).abs() < 1e-6, "{place:?}: {value}");
                let is_left_out = |set| of_set(set) == 0.0;
                assert!(weights.iter().all(|weight| !is_left_out(weight.set) && weight.mean > 0.0));
            }
        }
    }

    /// With few sets the regression is linear, and with one set its value is that of the set.
    #[test]
    fn few_sets() {
        let smoother = Smoother::new(scattered(8), vec![0.05, 0.05]);
        let value: f64 = smoother
            .weights(&[0.4, 0.6], |_| 1.0)
            .iter()
            .map(|weight| weight.regression * (1.0 + smoother.places[weight.set][0]))
            .sum();
        assert!((value - 1.4).abs() < 1e-6, "{value}");
        let single = Smoother::new(vec![vec![0.5]], vec![0.1]);
        let alone = SetWeight { set: 0, regression: 1.0, mean: 1.0 };
        assert_eq!(single.weights(&[0.2], |_| 1.0), [alone]);
    }

    /// Where the polynomial is negative, a part of the mean takes its place.
    #[test]
    fn densities_are_positive() {
        let smoother =
            Smoother::new((0..8).map(|number| vec![f64::from(number) / 7.0]).collect(), vec![0.2]);
        let step = |weight: SetWeight| if weight.set < 4 { 0.0 } else { 1.0 };
        for place in [0.2, 0.3, 0.4, 0.5] {
            let weights = smoother.weights(&[place], |_| 1.0);
            let value = positive(sums(weights.into_iter().map(|weight| (weight, step(weight)))));
            assert!(value > 0.0 && value < 1.5, "{place}: {value}");
        }
    }
}
