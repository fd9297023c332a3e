//! Quasi-periodic motion: the returns of a run to a section fill a torus.
//!
//! On a torus with two frequencies, a return map turns a closed curve like a rotation by an irrational angle. After some returns
//! every point comes back near its place, and after more returns still nearer, for ever: at the denominators of the best
//! rational approximations of the angle (A. Ya. Khinchin, *Continued Fractions*, 1964). Of irregular returns, neighbours separate, so
//! that no number of returns brings all of them back; bands of irregular motion come back to their band, but no nearer later.
//! A run fills a torus if
//!
//! - there is a number of returns after which all of its later returns have come back to [`BACK`] of their spread;
//! - it has come back nearer after more returns than after few ([`NEARER`]);
//! - what is missing to this repetition stays the same ([`LASTS`]): it decays if the run locks to a closed orbit;
//! - the weighted averages of the squares in both halves of the returns agree ([`SAME`]): they differ if the run approaches another
//!   motion.
//!
//! The weighted average `Σ w(n/N) f(x_n) / Σ w(n/N)` with `w(t) = exp(-1 / (t (1 - t)))` converges on tori much faster than that of
//! irregular returns (S. Das, Y. Saiki, E. Sander, J. A. Yorke, *Quantitative quasiperiodicity*, Nonlinearity 30 (2017) 4111,
//! doi:10.1088/1361-6544/aa84c2). To tell tori from irregular motion, it needs five digits, which it has only where the motion is
//! smooth. Stick and slip bend the torus: of circle maps with one kink, such averages recognise one in twenty, repetitions two in five.
//! With three or more frequencies, thousands of returns are not enough: such a run stays undecided.

/// The least number of later returns that are examined, three quarters of all.
const LEAST_RETURNS: usize = 450;
/// The most returns that are kept. When there are more, the earlier half is forgotten: over many more, errors of integration change
/// the torus of a system without damping.
const MOST_RETURNS: usize = 2048;
/// The smallest spread of returns that are no fixed point, and the largest difference of returns that repeat, over the spread.
const LEAST_SPREAD: f64 = 1e-6;
const REPEATS: f64 = 1e-6;
/// The number of successive returns that repeat on a closed orbit.
const IN_A_ROW: usize = 4;
/// The largest root mean square of what is missing to the nearest repetition, over the spread, and over that among the first eighth of
/// all numbers of returns. Of 1,000 irregular maps of the tests none passes these, and of maps in thin bands one in a hundred.
const BACK: f64 = 0.1;
const NEARER: f64 = 0.4;
/// The largest difference of the weighted averages of the squares in both halves, over the mean square.
const SAME: f64 = 1e-3;
/// The least and the greatest ratio of the late to the early root mean square of what is missing to the nearest repetition, on
/// a torus.
const LASTS: (f64, f64) = (0.85, 1.0 / 0.85);

/// A smooth function of the latest returns of a run.
#[derive(Clone, Debug, Default)]
pub(super) struct ReturnSeries(Vec<f64>);

impl ReturnSeries {
    /// Adds a return.
    pub(super) fn add(&mut self, value: f64) {
        if self.0.len() == MOST_RETURNS {
            self.0.drain(..MOST_RETURNS / 2);
        }
        self.0.push(value);
    }

    /// Returns whether the later three quarters of the returns fill a torus.
    pub(super) fn fill_a_torus(&self) -> bool {
        let later = &self.0[self.0.len() / 4..];
        if later.len() < LEAST_RETURNS {
            return false;
        }
        let mean = later.iter().sum::<f64>() / later.len() as f64;
        let squares: Vec<f64> = later.iter().map(|value| (value - mean) * (value - mean)).collect();
        let square = squares.iter().sum::<f64>() / later.len() as f64;
        let (spread, half) = (square.sqrt(), later.len() / 2);
        let difference = weighted_average(&squares[..half]) - weighted_average(&squares[half..]);
        spread >= LEAST_SPREAD
            && difference.abs() <= SAME * square
            && !repeats(later, REPEATS * spread)
            && comes_back(later, spread)
    }
}

/// Returns the weighted average of some values.
fn weighted_average(values: &[f64]) -> f64 {
    let (mut sum, mut weights) = (0.0, 0.0);
    for (place, value) in values.iter().enumerate() {
        let t = (place as f64 + 0.5) / values.len() as f64;
        let weight = libm::exp(-1.0 / (t * (1.0 - t)));
        sum += weight * value;
        weights += weight;
    }
    sum / weights
}

/// Returns whether the latest values are those some returns before, which are at most a quarter of all.
fn repeats(values: &[f64], difference: f64) -> bool {
    let latest = values.len() - IN_A_ROW..values.len();
    let after = |returns: usize| {
        let mut places = latest.clone();
        places.all(|place| (values[place] - values[place - returns]).abs() <= difference)
    };
    (1..values.len() / 4).any(after)
}

/// Returns whether values come back near their place, nearer after more returns, and always as near.
fn comes_back(values: &[f64], spread: f64) -> bool {
    let part = values.len() / 4;
    let missing = |returns: usize, from: usize| -> f64 {
        let squares = (from..from + part).map(|n| (values[n + returns] - values[n]).powi(2));
        (squares.sum::<f64>() / part as f64).sqrt()
    };
    let late: Vec<f64> =
        (1..part).map(|returns| missing(returns, values.len() - part - returns)).collect();
    let least = |of: &[f64]| of.iter().copied().fold(f64::INFINITY, f64::min);
    let (soon, nearest) = (least(&late[..part / 8]), least(&late));
    let after = late.iter().position(|missing| *missing == nearest);
    nearest <= BACK * spread
        && nearest <= NEARER * soon
        && after
            .is_some_and(|place| (LASTS.0..LASTS.1).contains(&(nearest / missing(place + 1, 0))))
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::ReturnSeries;

    /// Returns of a map whose state is observed smoothly, after a transient.
    fn returns(
        number: usize,
        state: &mut [f64; 2],
        map: impl Fn([f64; 2]) -> [f64; 2],
    ) -> ReturnSeries {
        let mut returns = ReturnSeries::default();
        for _ in 0..number {
            *state = map(*state);
            returns.add((TAU * state[0]).cos() + 0.3 * (2.0 * TAU * state[0]).sin() + state[1]);
        }
        returns
    }

    /// The circle map below its critical strength turns quasi-periodically or locks. At a strength of 0.4, it locks at about an
    /// eighth of all frequencies, and converges slowly near these.
    #[test]
    fn most_rotations_are_recognised() {
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        let trials = 200;
        let found = (0..trials).filter(|_| {
            let frequency: f64 = rng.random();
            let mut state = [rng.random(), 0.0];
            returns(2400, &mut state, |[angle, _]| {
                [angle + frequency - 0.4 / TAU * (TAU * angle).sin(), 0.0]
            })
            .fill_a_torus()
        });
        let found = found.count();
        assert!(found > trials * 6 / 10, "{found} of {trials}");
    }

    /// A circle map with a kink, as stick gives it.
    #[test]
    fn rotations_with_a_kink_are_recognised() {
        let mut rng = ChaCha8Rng::seed_from_u64(4);
        let trials = 100;
        let found = (0..trials).filter(|_| {
            let [frequency, size, place]: [f64; 3] = rng.random();
            let mut state = [rng.random(), 0.0];
            returns(2400, &mut state, |[angle, _]| {
                let from_kink = ((angle - place).rem_euclid(1.0) - 0.5).abs() - 0.25;
                [angle + frequency + (0.2 + 0.4 * size) * from_kink, 0.0]
            })
            .fill_a_torus()
        });
        let found = found.count();
        assert!(found > trials / 5, "{found} of {trials}");
    }

    /// Chaotic maps: the logistic map, the Hénon map, and the logistic map in thin bands.
    #[test]
    fn no_irregular_returns_are_recognised() {
        let mut rng = ChaCha8Rng::seed_from_u64(2);
        let mut in_bands = 0;
        for _ in 0..1000 {
            let start: [f64; 2] = [rng.random(), rng.random()];
            let logistic = returns(1200, &mut [start[0], 0.0], |[x, _]| [4.0 * x * (1.0 - x), 0.0]);
            assert!(!logistic.fill_a_torus(), "logistic {start:?}");
            let mut near = [0.1 * start[0], 0.1 * start[1]];
            let henon = returns(1200, &mut near, |[x, y]| [1.0 - 1.4 * x * x + y, 0.3 * x]);
            assert!(!henon.fill_a_torus(), "Hénon {start:?}");
            let strength = 3.571 + 0.009 * start[1];
            let mut settled = start[0];
            (0..3000).for_each(|_| settled = strength * settled * (1.0 - settled));
            let bands =
                returns(1200, &mut [settled, 0.0], |[x, _]| [strength * x * (1.0 - x), 0.0]);
            in_bands += usize::from(bands.fill_a_torus());
        }
        assert!(in_bands <= 10, "{in_bands}");
    }

    /// A locked rotation is a closed orbit; a spiral and noise are no rotations.
    #[test]
    fn closed_orbits_spirals_and_noise_are_no_tori() {
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        let mut noise = ReturnSeries::default();
        (0..2000).for_each(|_| noise.add(rng.random()));
        assert!(!noise.fill_a_torus());
        for turns in [1.0, 7.0, 36.0] {
            let mut closed = ReturnSeries::default();
            (0..2000).for_each(|n| closed.add((TAU * f64::from(n) / turns).cos() + 0.1 / turns));
            assert!(!closed.fill_a_torus(), "{turns}");
        }
        for rate in [1e-2, 1e-4, 1e-6] {
            let mut spiral = ReturnSeries::default();
            (0..2000).for_each(|n| {
                let n = f64::from(n);
                spiral.add((-rate * n).exp() * (TAU * 0.618_034 * n).cos());
            });
            assert!(!spiral.fill_a_torus(), "{rate}");
        }
        // It locks to an orbit of 36 returns.
        for rate in [3e-3, 1e-3, 5e-4] {
            let mut locks = ReturnSeries::default();
            (0..1400).for_each(|n| {
                let n = f64::from(n);
                locks.add((TAU * 5.0 / 36.0 * n + 0.3 * (-rate * n).exp()).cos());
            });
            assert!(!locks.fill_a_torus(), "{rate}");
        }
        let mut torus = ReturnSeries::default();
        (0..2000).for_each(|n| torus.add((TAU * 0.618_034 * f64::from(n)).cos()));
        assert!(torus.fill_a_torus());
    }
}
