//! The log-likelihood of measured runs for one parameter set, with the error that comes from the number of simulated runs.
//!
//! With `n` simulated runs at a site, a measured position of rest `y` has the probability density
//!
//! ```text
//! p(y) = (u + Σ_r K(y | r)) / (n + 1)
//! ```
//!
//! where `K` is the kernel of a run at rest, and the density `u` counts as one further run that rests anywhere, so that no
//! measurement is impossible. A run that is seen to move has the probability `(m + 1/2) / (n + 1)` with `m` moving runs. The
//! logarithm of a noisy density is on average too small by half of the density's relative variance; this is added (delta
//! method). The variance of the log-likelihood is that of the sum over the simulated runs, which all measurements share.

use super::bandwidth::Bandwidths;
use super::density::Rests;
use super::site::Site;

/// The log-likelihood of all measured runs.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LogLikelihood {
    /// Its value.
    pub value: f64,
    /// The variance that comes from the finite number of simulated runs.
    pub variance: f64,
}

/// Returns the log-likelihood of the measured runs at all sites; `rests` and `bandwidths` have one entry per site. It is
/// infinitely negative if the ends of all runs at a site are unknown.
pub fn log_likelihood(sites: &[Site], rests: &[Rests], bandwidths: &[Bandwidths]) -> LogLikelihood {
    let mut all = LogLikelihood::default();
    for ((site, rests), bandwidths) in sites.iter().zip(rests).zip(bandwidths) {
        let of_site = at_site(site, rests, *bandwidths);
        all.value += of_site.value;
        all.variance += of_site.variance;
    }
    all
}

fn at_site(site: &Site, rests: &Rests, bandwidths: Bandwidths) -> LogLikelihood {
    let runs = rests.runs() as f64;
    if runs == 0.0 {
        return LogLikelihood { value: f64::NEG_INFINITY, variance: 0.0 };
    }
    let mut value = 0.0;
    // How much each simulated run contributes to the log-likelihood.
    let mut contributions = vec![0.0; rests.runs() - rests.moving()];
    for measured in &site.rests {
        let kernels = rests.kernels(&measured.angles, measured.std_dev_rad, bandwidths);
        let sum = rests.uniform() + kernels.iter().sum::<f64>();
        let mut squares = 0.0;
        for (contribution, kernel) in contributions.iter_mut().zip(&kernels) {
            let part = kernel / sum;
            *contribution += part;
            squares += part * part;
        }
        let relative_variance = (squares - 1.0 / runs).max(0.0);
        value += libm::log(sum / (runs + 1.0)) + 0.5 * relative_variance;
    }
    let (moving, seen) = (rests.moving() as f64, site.moving as f64);
    value += seen * libm::log((moving + 0.5) / (runs + 1.0));
    let of_moving = if moving > 0.0 { seen * seen / moving } else { seen * seen };
    let squares: f64 = contributions.iter().map(|one| one * one).sum::<f64>() + of_moving;
    let sum: f64 = contributions.iter().sum::<f64>() + seen;
    LogLikelihood { value, variance: (squares - sum * sum / runs).max(0.0) }
}

#[cfg(test)]
mod tests {
    use super::log_likelihood;
    use crate::identify::{Bandwidths, End, LogLikelihood, Measured, Rests, Site};

    /// The position that a hash gives: uniform on the circle.
    fn position(run: u64) -> f64 {
        let bits = (run + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        let bits = (bits ^ (bits >> 29)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        (bits >> 11) as f64 / (1_u64 << 53) as f64 * std::f64::consts::TAU
    }

    fn of_sample(sample: u64, runs: u64) -> LogLikelihood {
        let end = |run: u64| match run % 5 {
            0 => End::Moving,
            _ => End::Rest { angles: vec![position(sample * runs + run)], groups: vec![0] },
        };
        let ends: Vec<End> = (0..runs).map(end).collect();
        let measured = |k: u32| Measured { angles: vec![0.4 * f64::from(k)], std_dev_rad: 0.1 };
        let site = Site { point_id: 0, stage: 1, rests: (0..8).map(measured).collect(), moving: 2 };
        let bandwidths = [Bandwidths { single: 0.1, touching: 0.1 }];
        log_likelihood(&[site], &[Rests::new(1, &ends)], &bandwidths)
    }

    /// On average the log-likelihood of 200 samples is the exact one within its error, and its stated variance is that of the
    /// samples. The uniform density is exactly smooth, so that kernels have no bias. Four standard errors are exceeded with
    /// a probability of 6e-5.
    #[test]
    fn values_and_variances_are_those_of_many_samples() {
        let samples = 200;
        let exact = 8.0 * (0.8 / std::f64::consts::TAU).ln() + 2.0 * 0.2_f64.ln();
        let all: Vec<LogLikelihood> = (0..samples).map(|sample| of_sample(sample, 400)).collect();
        let count = samples as f64;
        let mean = all.iter().map(|one| one.value).sum::<f64>() / count;
        let variance =
            all.iter().map(|one| (one.value - mean).powi(2)).sum::<f64>() / (count - 1.0);
        let stated = all.iter().map(|one| one.variance).sum::<f64>() / count;
        assert!(
            (mean - exact).abs() < 4.0 * (variance / count).sqrt() + 0.02,
            "{mean} {exact} {variance}"
        );
        assert!(
            (variance / stated - 1.0).abs() < 4.0 * (2.0 / count).sqrt() + 0.1,
            "{variance} {stated}"
        );
    }

    /// A measurement far from all simulated rests is unlikely, but possible.
    #[test]
    fn nothing_is_impossible() {
        let end = End::Rest { angles: vec![0.0], groups: vec![0] };
        let rests = Rests::new(1, &[end.clone(), end]);
        let site = |angle: f64| Site {
            point_id: 0,
            stage: 1,
            rests: vec![Measured { angles: vec![angle], std_dev_rad: 0.01 }],
            moving: 0,
        };
        let bandwidths = [Bandwidths { single: 0.01, touching: 0.01 }];
        let [near, far] = [0.0, 3.0]
            .map(|angle| log_likelihood(&[site(angle)], std::slice::from_ref(&rests), &bandwidths));
        assert!(near.value > far.value + 4.0);
        assert!((far.value - (1.0 / (3.0 * std::f64::consts::TAU)).ln()).abs() < 1e-12, "{far:?}");
        let unknown = Rests::new(1, &[End::Unknown]);
        assert_eq!(log_likelihood(&[site(0.0)], &[unknown], &bandwidths).value, f64::NEG_INFINITY);
    }
}
