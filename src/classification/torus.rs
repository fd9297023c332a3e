//! Quasi-periodic motion: the returns of a run to a section fill a torus.
//!
//! The weighted average of a smooth function of the returns,
//!
//! ```text
//! Σ w(n/N) f(x_n) / Σ w(n/N),    w(t) = exp(-1 / (t (1 - t)))
//! ```
//!
//! converges faster than any power of `N` if the motion is quasi-periodic with two frequencies, and as `N^-1/2` if it is
//! irregular (S. Das, Y. Saiki, E. Sander, J. A. Yorke, *Quantitative quasiperiodicity*, Nonlinearity 30 (2017) 4111,
//! doi:10.1088/1361-6544/aa84c2). A run fills a torus if the averages over both halves of its later returns agree in
//! [`DIGITS`] digits, those of the function and those of its square, and the returns neither repeat nor come nearer to it. A run
//! that still approaches another motion has a different square in each half; one that locks to a closed orbit of many returns
//! has nearly the same averages all the time, but what is missing to its repetition decays. With three or more frequencies, thousands of returns are not
//! enough: such a run stays undecided.

/// The number of digits in which averages agree, relative to the spread of the returns. Of irregular returns, about one
/// sequence in a hundred million does so.
const DIGITS: f64 = 1e-5;
/// The least number of returns in each half.
const LEAST_RETURNS: usize = 200;
/// The most returns that are kept. When there are more, the earlier half is forgotten: over many more, errors of integration change
/// the torus of a system without damping.
const MOST_RETURNS: usize = 2048;
/// The smallest spread of returns that are no fixed point, and the largest difference of returns that repeat, over the spread.
const LEAST_SPREAD: f64 = 1e-6;
const REPEATS: f64 = 1e-6;
/// The number of successive returns that repeat on a closed orbit.
const IN_A_ROW: usize = 4;
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
        let half = later.len() / 2;
        if half < LEAST_RETURNS {
            return false;
        }
        let mean = later.iter().sum::<f64>() / later.len() as f64;
        let centred: Vec<f64> = later.iter().map(|value| value - mean).collect();
        let square: f64 = centred.iter().map(|value| value * value).sum();
        let spread = (square / later.len() as f64).sqrt();
        if spread.is_nan() || spread < LEAST_SPREAD || repeats(&centred, REPEATS * spread) {
            return false;
        }
        let agree = |of: fn(f64) -> f64| {
            let [early, late] = [&centred[..half], &centred[half..2 * half]]
                .map(|values| weighted_average(values, |value| of(value / spread)));
            (early - late).abs() <= DIGITS
        };
        agree(|value| value) && agree(|value| value * value) && keeps_its_distance(&centred)
    }
}

/// Returns the weighted average of a function of some values.
fn weighted_average(values: &[f64], of: impl Fn(f64) -> f64) -> f64 {
    let (mut sum, mut weights) = (0.0, 0.0);
    for (place, value) in values.iter().enumerate() {
        let t = (place as f64 + 0.5) / values.len() as f64;
        let weight = libm::exp(-1.0 / (t * (1.0 - t)));
        sum += weight * of(*value);
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

/// Returns whether what is missing to the repetition that comes nearest, after at most a quarter of all returns, stays the same:
/// on a torus, it is a shift by a constant angle.
fn keeps_its_distance(values: &[f64]) -> bool {
    let part = values.len() / 4;
    let missing = |returns: usize, from: usize| -> f64 {
        let squares = (from..from + part).map(|n| (values[n + returns] - values[n]).powi(2));
        squares.sum::<f64>()
    };
    let late = |returns: &usize| missing(*returns, values.len() - part - returns);
    let nearest = (1..part).min_by(|left, right| late(left).total_cmp(&late(right)));
    nearest.is_some_and(|returns| {
        let ratio = (late(&returns) / missing(returns, 0)).sqrt();
        (LASTS.0..LASTS.1).contains(&ratio)
    })
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

    /// Chaotic maps: the logistic map, the Hénon map, and the circle map far above its critical strength.
    #[test]
    fn no_irregular_returns_are_recognised() {
        let mut rng = ChaCha8Rng::seed_from_u64(2);
        for _ in 0..1000 {
            let start: [f64; 2] = [rng.random(), rng.random()];
            let logistic = returns(1200, &mut [start[0], 0.0], |[x, _]| [4.0 * x * (1.0 - x), 0.0]);
            assert!(!logistic.fill_a_torus(), "logistic {start:?}");
            let mut near = [0.1 * start[0], 0.1 * start[1]];
            let henon = returns(1200, &mut near, |[x, y]| [1.0 - 1.4 * x * x + y, 0.3 * x]);
            assert!(!henon.fill_a_torus(), "Hénon {start:?}");
        }
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
