//! The bandwidths of kernels: those that predict left-out simulated rests best.
//!
//! Each of a sample of rests is left out in turn and measured with the error of the measurements; the bandwidth with the
//! largest mean logarithm of its density is chosen (likelihood cross-validation; B. W. Silverman, *Density Estimation for
//! Statistics and Data Analysis*, 1986, section 3.4.4). The bandwidths of a site are the same for all parameter sets, so that
//! the likelihood is smooth.

use rand_chacha::ChaCha8Rng;

use super::density::Rests;
use super::sampler::normal;
use super::site::Site;

/// The bandwidths of a site, rad.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bandwidths {
    /// Of a ball that touches no other.
    pub single: f64,
    /// Of a group of balls in touch, which moves as a whole.
    pub touching: f64,
}

/// The bandwidths that are compared, rad.
const CANDIDATES: [f64; 8] = [0.015, 0.025, 0.04, 0.065, 0.1, 0.16, 0.25, 0.4];
/// The bandwidth with which the comparison begins.
const FIRST: f64 = 0.1;
/// The number of rests that are left out, over all parameter sets.
const LEFT_OUT: usize = 400;

impl Default for Bandwidths {
    fn default() -> Self {
        Bandwidths { single: FIRST, touching: FIRST }
    }
}

impl Bandwidths {
    /// Returns the best bandwidths of a site for the simulated rests of several parameter sets.
    pub(super) fn chosen(site: &Site, all: &[&Rests], random: &mut ChaCha8Rng) -> Self {
        let Some(measured) = site.rests.first() else { return Bandwidths::default() };
        let each = LEFT_OUT.div_ceil(all.len().max(1));
        let mut left_out: Vec<(&Rests, usize, Vec<f64>)> = Vec::new();
        for rests in all {
            let count = rests.positions().count();
            let every = count.div_ceil(each).max(1);
            for (place, angles) in rests.positions().enumerate().step_by(every) {
                let blurred = |angle: &f64| angle + measured.std_dev_rad * normal(random);
                left_out.push((rests, place, angles.iter().map(blurred).collect()));
            }
        }
        let score = |bandwidths: Bandwidths| -> f64 {
            let of = |(rests, place, angles): &(&Rests, usize, Vec<f64>)| {
                let kernels = rests.kernels(angles, measured.std_dev_rad, bandwidths);
                let own = kernels.get(*place).copied().unwrap_or_default();
                libm::log(rests.uniform() + (kernels.iter().sum::<f64>() - own).max(0.0))
            };
            left_out.iter().map(of).sum()
        };
        let best = |with: &dyn Fn(f64) -> Bandwidths| {
            let scored = CANDIDATES.map(|candidate| (score(with(candidate)), with(candidate)));
            let best = scored.into_iter().max_by(|one, other| one.0.total_cmp(&other.0));
            best.map_or_else(Bandwidths::default, |(_, bandwidths)| bandwidths)
        };
        let single = best(&|single| Bandwidths { single, touching: FIRST });
        if !all.iter().any(|rests| rests.touches()) {
            return single;
        }
        best(&|touching| Bandwidths { touching, ..single })
    }
}
