//! The probability density of measured angles, from simulated positions of rest.
//!
//! The density is the mean of kernels at the simulated positions. A ball at rest has a normal kernel whose variance is that of
//! the measurement plus the square of a bandwidth. Balls that rest in touch have exact distances between them: their group is
//! displaced as a whole by the bandwidth, and each ball by the measurement. Balls are not told apart in measurements: the
//! kernels are summed over all assignments of measured angles to balls.

use std::f64::consts::{PI, TAU};

use super::site::BallsEnd;

/// The largest number of balls: the number of their permutations is the cost of a kernel.
pub const MOST_BALLS: usize = 5;

/// Kernels below the exponential of this are zero.
const SMALLEST_EXPONENT: f64 = -30.0;

/// The simulated ends at a site for one parameter set.
#[derive(Clone, Debug, Default)]
pub struct Rests {
    balls: usize,
    /// All different groupings of the balls: for each group the balls in it.
    groupings: Vec<Vec<Vec<usize>>>,
    /// The grouping of each position.
    grouping: Vec<usize>,
    /// The angles of the balls in each position, one position after another, in [0, 2π].
    angles: Vec<f64>,
    /// For each ball its angles in ascending order, with the numbers of their positions.
    by_angle: Vec<Vec<(f64, usize)>>,
    /// For each ball all assignments in which it has the first measured angle: the measured angle of each ball.
    orders: Vec<Vec<Vec<usize>>>,
    /// The number of moving runs.
    pub moving: usize,
}

impl Rests {
    /// Returns the known ends at a site.
    pub fn new<'a>(balls: usize, ends: impl IntoIterator<Item = &'a BallsEnd>) -> Self {
        let mut all = Rests { balls, ..Rests::default() };
        for end in ends {
            match end {
                BallsEnd::Rest { angles, groups } => {
                    let grouping = grouping(groups);
                    let known = all.groupings.iter().position(|seen| *seen == grouping);
                    let index = known.unwrap_or_else(|| {
                        all.groupings.push(grouping);
                        all.groupings.len() - 1
                    });
                    all.grouping.push(index);
                    all.angles.extend(angles.iter().map(|angle| angle.rem_euclid(TAU)));
                }
                BallsEnd::Moving => all.moving += 1,
                BallsEnd::Unknown => {}
            }
        }
        let of_ball = |ball: usize| -> Vec<(f64, usize)> {
            let angles = all.positions().map(|angles| angles[ball]);
            let mut sorted: Vec<(f64, usize)> = angles.zip(0..).collect();
            sorted.sort_by(|left, right| left.0.total_cmp(&right.0));
            sorted
        };
        all.by_angle = (0..balls).map(of_ball).collect();
        let orders = permutations(balls);
        let with_first = |ball: usize| orders.iter().filter(move |order| order[ball] == 0);
        all.orders = (0..balls).map(|ball| with_first(ball).cloned().collect()).collect();
        all
    }

    /// Returns the number of runs whose end is known.
    pub fn runs(&self) -> usize {
        self.at_rest() + self.moving
    }

    /// Returns the number of runs at rest.
    pub fn at_rest(&self) -> usize {
        self.grouping.len()
    }

    /// Returns the angles of the balls in each run at rest.
    pub fn positions(&self) -> impl Iterator<Item = &[f64]> {
        self.angles.chunks_exact(self.balls.max(1))
    }

    /// Returns the angles of the balls in a run, or `None` if it moves; runs at rest come first.
    pub fn run(&self, index: usize) -> Option<&[f64]> {
        self.positions().nth(index)
    }

    /// Returns the density at which one further run would rest anywhere, for balls that are not told apart.
    pub fn uniform(&self) -> f64 {
        let balls = self.balls as f64;
        permutations(self.balls).len() as f64 / TAU.powf(balls)
    }

    /// Returns the kernel of each position at rest for measured angles.
    pub fn kernels(&self, measured: &[f64], std_dev_rad: f64, bandwidth_rad: f64) -> Vec<f64> {
        let variance = std_dev_rad.powi(2);
        let shapes: Vec<Vec<GroupKernel>> = self
            .groupings
            .iter()
            .map(|groups| {
                let groups = groups.iter();
                groups.map(|balls| GroupKernel::new(balls, variance, bandwidth_rad)).collect()
            })
            .collect();
        let norms: Vec<f64> = shapes
            .iter()
            .map(|groups| libm::exp(groups.iter().map(|group| group.log_norm).sum::<f64>()))
            .collect();
        let reach = reach(variance, bandwidth_rad);
        let measured: Vec<f64> = measured.iter().map(|angle| angle.rem_euclid(TAU)).collect();
        let mut kernels = vec![0.0; self.grouping.len()];
        // The first measured angle is that of each ball in turn, in the positions where this ball is near enough.
        for (sorted, orders) in self.by_angle.iter().zip(&self.orders) {
            for (_, position) in near(sorted, measured[0], reach).into_iter().flatten() {
                let angles = &self.angles[position * self.balls..];
                let grouping = self.grouping[*position];
                for order in orders {
                    let distance = |ball: usize| on_circle(measured[order[ball]] - angles[ball]);
                    let exponent: f64 =
                        shapes[grouping].iter().map(|group| group.exponent(distance)).sum();
                    if exponent > SMALLEST_EXPONENT {
                        kernels[*position] += norms[grouping] * libm::exp(exponent);
                    }
                }
            }
        }
        kernels
    }
}

/// Returns the sorted angles in [0, 2π] that are within `reach` of an angle, in two parts.
fn near(sorted: &[(f64, usize)], angle: f64, reach: f64) -> [&[(f64, usize)]; 2] {
    if reach >= PI {
        return [sorted, &[]];
    }
    let below = |angle: f64| sorted.partition_point(|entry| entry.0 < angle);
    let (low, high) = (angle - reach, angle + reach);
    if low < 0.0 {
        [&sorted[..below(high)], &sorted[below(low + TAU)..]]
    } else if high > TAU {
        [&sorted[..below(high - TAU)], &sorted[below(low)..]]
    } else {
        [&sorted[below(low)..below(high)], &[]]
    }
}

/// Returns the distance between a ball and a measured angle above which the kernel is zero: its exponent is at most that of
/// the marginal distribution of one angle.
fn reach(variance: f64, bandwidth_rad: f64) -> f64 {
    (-2.0 * SMALLEST_EXPONENT * (variance + bandwidth_rad.powi(2))).sqrt()
}

/// Returns a difference of two angles in [0, 2π] as a distance in [-π, π].
fn on_circle(difference: f64) -> f64 {
    if difference > PI {
        difference - TAU
    } else if difference < -PI {
        difference + TAU
    } else {
        difference
    }
}

/// The normal kernel of a group of balls: the covariance of their angles is the measurement's on the diagonal plus the square
/// of the bandwidth everywhere.
struct GroupKernel<'a> {
    balls: &'a [usize],
    log_norm: f64,
    /// Factors of the sum of squares and of the square of the sum in the exponent.
    squares: f64,
    square_of_sum: f64,
}

impl<'a> GroupKernel<'a> {
    fn new(balls: &'a [usize], variance: f64, bandwidth_rad: f64) -> Self {
        let count = balls.len() as f64;
        let along = variance + count * bandwidth_rad.powi(2);
        let log_norm =
            count * libm::log(TAU) + (count - 1.0) * libm::log(variance) + libm::log(along);
        GroupKernel {
            balls,
            log_norm: -0.5 * log_norm,
            squares: -0.5 / variance,
            square_of_sum: 0.5 * bandwidth_rad.powi(2) / (variance * along),
        }
    }

    fn exponent(&self, distance: impl Fn(usize) -> f64) -> f64 {
        let (mut sum, mut squares) = (0.0, 0.0);
        for ball in self.balls {
            let distance = distance(*ball);
            sum += distance;
            squares += distance * distance;
        }
        self.squares * squares + self.square_of_sum * sum * sum
    }
}

/// Returns the balls of each group.
fn grouping(groups: &[u8]) -> Vec<Vec<usize>> {
    let mut all: Vec<(u8, Vec<usize>)> = Vec::new();
    for (ball, group) in groups.iter().enumerate() {
        match all.iter_mut().find(|(other, _)| other == group) {
            Some((_, balls)) => balls.push(ball),
            None => all.push((*group, vec![ball])),
        }
    }
    all.into_iter().map(|(_, balls)| balls).collect()
}

/// Returns all orders of a number of balls.
pub(super) fn permutations(balls: usize) -> Vec<Vec<usize>> {
    let mut all = vec![Vec::new()];
    for ball in 0..balls {
        let longer = |order: &Vec<usize>| -> Vec<Vec<usize>> {
            let with = |place: usize| {
                let mut longer = order.clone();
                longer.insert(place, ball);
                longer
            };
            (0..=order.len()).map(with).collect()
        };
        all = all.iter().flat_map(longer).collect();
    }
    all
}

#[cfg(test)]
mod tests {
    use super::{Rests, permutations};
    use crate::identify::site::BallsEnd;

    const BANDWIDTH_RAD: f64 = 0.1;

    fn rest(angles: &[f64], groups: &[u8]) -> BallsEnd {
        BallsEnd::Rest { angles: angles.to_vec(), groups: groups.to_vec() }
    }

    #[test]
    fn permutations_are_all_orders() {
        assert_eq!(permutations(1), [[0]]);
        let mut three = permutations(3);
        three.sort();
        assert_eq!(three, [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]]);
    }

    /// The density over unordered positions integrates to one: half of the integral over the torus, for two balls.
    #[test]
    fn densities_integrate_to_one() {
        for groups in [[0, 1], [0, 0]] {
            let rests = Rests::new(2, &[rest(&[0.1, 0.4], &groups), rest(&[3.0, 6.2], &groups)]);
            let cells = 400;
            let width = std::f64::consts::TAU / f64::from(cells);
            let mut sum = 0.0;
            for first in 0..cells {
                for second in 0..cells {
                    let angles = [first, second].map(|cell| width * f64::from(cell));
                    sum += rests.kernels(&angles, 0.1, BANDWIDTH_RAD).iter().sum::<f64>();
                }
            }
            let integral = 0.5 * sum * width * width / 2.0;
            assert!((integral - 1.0).abs() < 1e-9, "{groups:?}: {integral}");
        }
    }

    /// A single ball has a normal density with the sum of both variances; the order of measured angles does not matter.
    #[test]
    fn kernels_of_one_ball_and_of_exchanged_balls() {
        let rests = Rests::new(1, &[rest(&[6.2], &[0])]);
        let density = rests.kernels(&[0.1], 0.05, BANDWIDTH_RAD)[0];
        let (distance, variance) =
            (0.1 - 6.2 + std::f64::consts::TAU, 0.05_f64.powi(2) + 0.1_f64.powi(2));
        let expected = (-0.5 * distance * distance / variance).exp()
            / (std::f64::consts::TAU * variance).sqrt();
        assert!((density - expected).abs() < 1e-13, "{density} {expected}");
        let rests = Rests::new(3, &[rest(&[1.0, 1.26, 4.0], &[0, 0, 2])]);
        let [kernel, exchanged] = [[1.1, 1.3, 4.1], [4.1, 1.1, 1.3]]
            .map(|angles| rests.kernels(&angles, 0.1, BANDWIDTH_RAD)[0]);
        assert!((kernel - exchanged).abs() < 1e-13 * kernel, "{kernel} {exchanged}");
    }

    /// Positions around the whole circle: the kernel of each one is the sum over all assignments, also next to the angle 0.
    #[test]
    fn kernels_of_positions_around_the_circle() {
        let ends: Vec<BallsEnd> = (0..200)
            .map(|number| {
                let angle = 0.0314 * f64::from(number);
                rest(&[angle, 2.0 * angle, 0.3], &[0, 1, 2])
            })
            .collect();
        let rests = Rests::new(3, &ends);
        for measured in [[0.05, 0.1, 0.3], [6.2, 6.1, 0.2], [3.0, 0.3, 6.0]] {
            for std_dev_rad in [0.1, 0.5] {
                let kernels = rests.kernels(&measured, std_dev_rad, BANDWIDTH_RAD);
                let variance = std_dev_rad * std_dev_rad + BANDWIDTH_RAD * BANDWIDTH_RAD;
                let normal = |distance: f64| {
                    let distance = crate::model::wrap_to_pi(distance);
                    (-0.5 * distance * distance / variance).exp()
                        / (std::f64::consts::TAU * variance).sqrt()
                };
                for (kernel, angles) in kernels.iter().zip(rests.positions()) {
                    let product = |order: &Vec<usize>| -> f64 {
                        (0..3).map(|ball| normal(measured[order[ball]] - angles[ball])).product()
                    };
                    let expected: f64 = permutations(3).iter().map(product).sum();
                    assert!((kernel - expected).abs() < 1e-9, "{angles:?}: {kernel} {expected}");
                }
            }
        }
    }

    /// Balls in touch keep their distance: only the measurement blurs it.
    #[test]
    fn balls_in_touch_move_together() {
        let apart = |groups: &[u8]| {
            let rests = Rests::new(2, &[rest(&[1.0, 1.26], groups)]);
            let [near, far] = [[1.1, 1.36], [1.1, 1.56]]
                .map(|angles| rests.kernels(&angles, 0.02, BANDWIDTH_RAD)[0]);
            near / far
        };
        assert!(
            apart(&[0, 0]) > 1e10 && apart(&[0, 1]) < 1e2,
            "{} {}",
            apart(&[0, 0]),
            apart(&[0, 1])
        );
    }
}
