//! The criterion that a proposed design maximises: the expected improvement times the probability that the design meets
//! all limits, as a logarithm.
//!
//! With two objectives, the improvement is the gain of dominated area. While no design meets all limits, the criterion
//! is the probability alone. Where the processes already know the objective better than the runs of a design would, the
//! improvement is discounted (augmented expected improvement; D. Huang, T. T. Allen, W. I. Notz, N. Zeng, J. Glob. Optim.
//! 34 (2006) 441, doi:10.1007/s10898-005-2454-3).

use std::f64::consts::{PI, SQRT_2};

use super::goal::{Goal, pareto_front};
use super::process::ScaledQuantity;

/// Normal distribution of a quantity of a design: mean and standard deviation.
pub(super) type Prediction = (f64, f64);

/// The criterion after some designs.
pub(super) struct Criterion {
    /// Quantity and sign of each cost.
    costs: Vec<(usize, f64)>,
    /// Typical standard error of each quantity.
    errors: Vec<f64>,
    /// Quantity, sign and value of each limit; the excess is the sign times the difference of quantity and value.
    limits: Vec<(usize, f64, f64)>,
    /// Costs of the best designs that meet all limits, by increasing first cost.
    front: Vec<Vec<f64>>,
    /// With two objectives: costs that bound the dominated area.
    corner: [f64; 2],
}

impl Criterion {
    /// Returns the criterion for the goal and its quantities.
    pub fn new(goal: &Goal, quantities: &[ScaledQuantity]) -> Criterion {
        let sign = |negative: bool| if negative { -1.0 } else { 1.0 };
        let objectives = goal.objectives.iter();
        let costs: Vec<(usize, f64)> =
            objectives.map(|(quantity, objective)| (*quantity, sign(objective.maximize))).collect();
        let limit = |(quantity, limit): &(usize, crate::study::Limit)| {
            let value = quantities.get(*quantity)?.scale.scaled(limit.value);
            Some((*quantity, sign(limit.least), value))
        };
        let limits: Vec<(usize, f64, f64)> = goal.limits.iter().filter_map(limit).collect();
        let designs = quantities.first().map_or(0, |quantity| quantity.values.len());
        let of = |quantity: usize, design: usize| quantities[quantity].values[design];
        let feasible_costs = |design: usize| {
            let excess = |(quantity, sign, value): &(usize, f64, f64)| {
                sign * (of(*quantity, design) - value)
            };
            let met = limits.iter().all(|limit| excess(limit) <= 0.0);
            met.then(|| costs.iter().map(|(quantity, sign)| sign * of(*quantity, design)).collect())
        };
        let all: Vec<Option<Vec<f64>>> = (0..designs).map(feasible_costs).collect();
        let corner = [0, 1].map(|place| corner(all.iter().flatten(), place));
        // With one objective, the front is the best design.
        let mut front: Vec<Vec<f64>> =
            pareto_front(&all).into_iter().filter_map(|index| all.get(index)?.clone()).collect();
        front.sort_by(|left, right| left[0].total_cmp(&right[0]));
        let errors = quantities.iter().map(|quantity| quantity.noise.sqrt()).collect();
        Criterion { costs, errors, limits, front, corner }
    }

    /// Returns the logarithm of the criterion of a design from the prediction of each quantity.
    pub fn value(&self, predictions: &[Prediction]) -> f64 {
        let of = |quantity: usize| predictions.get(quantity).copied().unwrap_or((f64::NAN, 0.0));
        let met = self.limits.iter().map(|(quantity, sign, limit)| {
            let (mean, deviation) = of(*quantity);
            let excess = sign * (mean - limit);
            match deviation > 0.0 {
                true => log_probability(-excess / deviation),
                false if excess <= 0.0 => 0.0,
                false => f64::NEG_INFINITY,
            }
        });
        let met: f64 = met.sum();
        let costs: Vec<Prediction> = self
            .costs
            .iter()
            .map(|(quantity, sign)| {
                let (mean, deviation) = of(*quantity);
                (sign * mean, deviation)
            })
            .collect();
        let discount =
            |(quantity, _): &(usize, f64)| discount(of(*quantity).1, self.errors[*quantity]).ln();
        let discount: f64 = self.costs.iter().map(discount).sum();
        let value = match (&self.front[..], &costs[..]) {
            ([], _) => met,
            ([best, ..], [cost]) => met + discount + log_expected_improvement(best[0], *cost),
            (front, [first, second, ..]) => met + discount + self.area(front, *first, *second).ln(),
            _ => f64::NEG_INFINITY,
        };
        if value.is_nan() { f64::NEG_INFINITY } else { value }
    }

    /// Returns the expected gain of dominated area: the area consists of strips between the first costs of neighbours
    /// on the front, and the two costs are independent.
    fn area(&self, front: &[Vec<f64>], first: Prediction, second: Prediction) -> f64 {
        let mut gain = 0.0;
        let mut below = 0.0;
        for strip in 0..=front.len() {
            let end = front.get(strip).map_or(self.corner[0], |costs| costs[0]);
            let ceiling = match strip {
                0 => self.corner[1],
                _ => front[strip - 1][1],
            };
            let up_to_end = expected_improvement(end, first);
            gain += (up_to_end - below).max(0.0) * expected_improvement(ceiling, second);
            below = up_to_end;
        }
        gain
    }
}

/// Returns the largest cost of all designs, and a tenth of the range of costs more.
fn corner<'a>(all: impl Iterator<Item = &'a Vec<f64>>, place: usize) -> f64 {
    let costs: Vec<f64> = all.filter_map(|costs| costs.get(place).copied()).collect();
    let most = costs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let least = costs.iter().copied().fold(f64::INFINITY, f64::min);
    most + 0.1 * (most - least)
}

/// Returns the factor `1 - error / √(deviation² + error²)` of the improvement, in a form that does not cancel. It is
/// small where the deviation of the prediction is small compared with the standard error of the runs of a design.
fn discount(deviation: f64, error: f64) -> f64 {
    if error <= 0.0 {
        return 1.0;
    }
    let both = deviation.hypot(error);
    deviation * deviation / (both * (both + error))
}

/// Returns the mean amount by which a normal variable is below a threshold, counted as zero above it.
fn expected_improvement(threshold: f64, (mean, deviation): Prediction) -> f64 {
    if deviation <= 0.0 {
        return (threshold - mean).max(0.0);
    }
    let z = (threshold - mean) / deviation;
    (deviation * (density(z) + z * probability(z))).max(0.0)
}

fn log_expected_improvement(threshold: f64, (mean, deviation): Prediction) -> f64 {
    let z = (threshold - mean) / deviation;
    if deviation > 0.0 && z < -20.0 {
        // The first term of the asymptotic series; the direct formula would underflow.
        return deviation.ln() - 0.5 * z * z - 0.5 * (2.0 * PI).ln() - 2.0 * (-z).ln();
    }
    expected_improvement(threshold, (mean, deviation)).ln()
}

fn density(z: f64) -> f64 {
    (-0.5 * z * z).exp() / (2.0 * PI).sqrt()
}

/// Returns the probability that a standard normal variable is below `z`.
fn probability(z: f64) -> f64 {
    0.5 * libm::erfc(-z / SQRT_2)
}

fn log_probability(z: f64) -> f64 {
    if z < -20.0 {
        return -0.5 * z * z - 0.5 * (2.0 * PI).ln() - (-z).ln();
    }
    probability(z).ln()
}

#[cfg(test)]
mod tests {
    use super::{
        Criterion, discount, expected_improvement, log_expected_improvement, log_probability,
    };

    /// Returns the mean of a function of a normal variable, by the midpoint rule.
    fn mean_over(mean: f64, deviation: f64, function: impl Fn(f64) -> f64) -> f64 {
        let parts = 400;
        let each = (0..parts).map(|part| {
            let z = -8.0 + 16.0 * (f64::from(part) + 0.5) / f64::from(parts);
            (-0.5 * z * z).exp() * function(mean + deviation * z)
        });
        each.sum::<f64>() * 16.0 / f64::from(parts) / (2.0 * std::f64::consts::PI).sqrt()
    }

    #[test]
    fn improvement_is_an_integral() {
        for (threshold, mean, deviation) in [(1.0, 0.5, 0.3), (1.0, 2.0, 0.7), (-2.0, 1.0, 1.5)] {
            let found = expected_improvement(threshold, (mean, deviation));
            let expected = mean_over(mean, deviation, |value| (threshold - value).max(0.0));
            assert!((found - expected).abs() < 1e-4, "{found} {expected}");
        }
        assert_eq!(expected_improvement(3.0, (1.0, 0.0)), 2.0);
    }

    #[test]
    fn discount_of_known_objectives() {
        for (deviation, error) in [(0.3_f64, 0.4_f64), (2.0, 0.1)] {
            let expected = 1.0 - error / (deviation * deviation + error * error).sqrt();
            assert!((discount(deviation, error) - expected).abs() < 1e-12);
        }
        assert_eq!((discount(0.0, 0.1), discount(0.0, 0.0)), (0.0, 1.0));
    }

    /// The asymptotic formulas continue the direct ones.
    #[test]
    fn logarithms_are_continuous() {
        for of in [|z| log_probability(z), |z: f64| log_expected_improvement(z, (0.0, 1.0))] {
            let [above, below] = [of(-19.999), of(-20.001)];
            assert!(above > below && above - below < 0.06, "{above} {below}");
        }
    }

    /// The gain of area of independent costs is an integral over the squares that they gain.
    #[test]
    fn area_is_an_integral() {
        let front = vec![vec![1.0, 3.0], vec![2.0, 1.0]];
        let criterion = Criterion {
            costs: vec![(0, 1.0), (1, 1.0)],
            errors: vec![0.0; 2],
            limits: Vec::new(),
            front: front.clone(),
            corner: [4.0, 4.0],
        };
        let gain = |x: f64, y: f64| {
            let cells = 40;
            let side = 8.0 / f64::from(cells);
            let middle = |index: i32| -4.0 + (f64::from(index) + 0.5) * side;
            let gained = |a: f64, b: f64| {
                a > x && b > y && !front.iter().any(|point| a > point[0] && b > point[1])
            };
            let count = (0..cells * cells)
                .filter(|cell| gained(middle(cell / cells), middle(cell % cells)))
                .count();
            count as f64 * side * side
        };
        // Certain costs at corners of the cells, for which counting cells is exact.
        for (x, y) in [(0.4, 0.4), (1.6, 1.6), (3.0, 0.4), (2.4, 2.4)] {
            let found = criterion.value(&[(x, 0.0), (y, 0.0)]).exp();
            assert!((found - gain(x, y)).abs() < 1e-9, "{x} {y}: {found} {}", gain(x, y));
        }
        // Uncertain costs: the mean over both.
        let certain = |x: f64, y: f64| criterion.value(&[(x, 0.0), (y, 0.0)]).exp();
        let expected = mean_over(1.5, 0.4, |x| mean_over(1.8, 0.6, |y| certain(x, y)));
        let found = criterion.value(&[(1.5, 0.4), (1.8, 0.6)]).exp();
        assert!((found - expected).abs() < 1e-3, "{found} {expected}");
    }
}
