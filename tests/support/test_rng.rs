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

    /// Returns a Beta-distributed number.
    pub fn beta(&mut self, a: f64, b: f64) -> f64 {
        let gamma = |shape| rand_distr::Gamma::new(shape, 1.0).expect("a positive shape");
        let [a, b] = [a, b].map(|shape| gamma(shape).sample(&mut self.0));
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
