//! Seeded random numbers for tests.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use rand_distr::Distribution;

/// A stream of random numbers.
pub struct TestRng(ChaCha8Rng);

impl TestRng {
    /// Creates the stream of a seed.
    pub fn new(seed: u64) -> Self {
        TestRng(ChaCha8Rng::seed_from_u64(seed))
    }

    /// Returns a number uniform in the open interval (0, 1).
    pub fn uniform(&mut self) -> f64 {
        ((self.0.next_u64() >> 11) as f64 + 0.5) / (1_u64 << 53) as f64
    }

    /// Returns a whole number from 0 to below `bound`.
    pub fn below(&mut self, bound: u64) -> u64 {
        self.0.next_u64() % bound
    }

    /// Returns a normally distributed number with a mean of 0 and a standard deviation of 1.
    pub fn normal(&mut self) -> f64 {
        rand_distr::StandardNormal.sample(&mut self.0)
    }

    /// Returns an exponentially distributed number with the given rate.
    pub fn exponential(&mut self, rate: f64) -> f64 {
        -self.uniform().ln() / rate
    }

    /// Returns a gamma-distributed number with the given shape and a scale of 1.
    ///
    /// Source: J. H. Ahrens, U. Dieter, Computing 12 (1974) 223, doi:10.1007/BF02293108, algorithm
    /// GS for shapes up to 1; larger shapes are sums.
    fn gamma(&mut self, shape: f64) -> f64 {
        if shape > 1.0 {
            return self.exponential(1.0) + self.gamma(shape - 1.0);
        }
        let bound = 1.0 + shape / std::f64::consts::E;
        loop {
            let (p, threshold) = (bound * self.uniform(), self.exponential(1.0));
            if p <= 1.0 {
                let x = p.powf(1.0 / shape);
                if x <= threshold {
                    return x;
                }
            } else {
                let x = -((bound - p) / shape).ln();
                if (1.0 - shape) * x.ln() <= threshold {
                    return x;
                }
            }
        }
    }

    /// Returns a Beta-distributed number.
    pub fn beta(&mut self, a: f64, b: f64) -> f64 {
        let (a, b) = (self.gamma(a), self.gamma(b));
        if a + b > 0.0 { a / (a + b) } else { 0.0 }
    }

    /// Returns an angle in [0, 2π) from a von Mises distribution, by rejection.
    pub fn von_mises(&mut self, centre: f64, concentration: f64) -> f64 {
        loop {
            let angle = std::f64::consts::TAU * self.uniform();
            if self.uniform() < (concentration * ((angle - centre).cos() - 1.0)).exp() {
                return angle;
            }
        }
    }
}
