//! The equilibrium set of any number of balls at quasi-random positions.
//!
//! Sobol' points with hashed Owen scrambling (B. Burley, J. Comput. Graph. Tech. 9 (2020) 4), in
//! several independent scrambles: each gives an unbiased share, and their scatter an interval.

use std::f64::consts::TAU;

use statrs::distribution::{ContinuousCDF, StudentsT};

use super::interval::{Z_95, wilson};
use super::rest_form::RestForm;

/// Independent scrambles.
pub const REPLICATES: u32 = 16;

/// The angles of one sample, one per ball, rad.
pub fn sample(balls: usize, replicate: u32, index: u32) -> Vec<f64> {
    let angle = |axis| f64::from(sobol_burley::sample(index, axis, replicate)) * TAU;
    (0..balls as u32).map(angle).collect()
}

/// The share of one scramble's samples that are in the set, on the calling thread.
pub fn share(form: &RestForm, replicate: u32, samples: u32) -> f64 {
    let balls = form.mass.len();
    let inside =
        (0..samples).filter(|&i| form.at_rest(&sample(balls, replicate, i)).in_set()).count();
    inside as f64 / f64::from(samples.max(1))
}

/// Mean and 95 % interval from the shares of independent scrambles of `samples` each: Student's t.
/// Where all or none of the samples are in the set and nothing scatters, the interval is Wilson's
/// for as many independent samples, which quasi-random ones outdo.
pub fn share_with_interval(shares: &[f64], samples: u32) -> (f64, (f64, f64)) {
    let n = shares.len() as f64;
    let mean = shares.iter().sum::<f64>() / n;
    let all = shares.len() as u64 * u64::from(samples);
    if mean == 0.0 || mean == 1.0 {
        return (mean, wilson(if mean == 0.0 { 0 } else { all }, all, Z_95));
    }
    let variance = shares.iter().map(|share| (share - mean).powi(2)).sum::<f64>() / (n - 1.0);
    // No degrees of freedom, no interval but the whole.
    let half = StudentsT::new(0.0, 1.0, n - 1.0)
        .map_or(f64::INFINITY, |student| student.inverse_cdf(0.975) * (variance / n).sqrt());
    (mean, ((mean - half).max(0.0), (mean + half).min(1.0)))
}

#[cfg(test)]
mod tests {
    use super::share_with_interval;

    /// Student's t for 15 degrees of freedom is 2.131450 in every table.
    #[test]
    fn interval_is_students() {
        let shares: Vec<f64> =
            (0..16).map(|i| 0.5 + if i % 2 == 0 { 0.01 } else { -0.01 }).collect();
        let (mean, (low, high)) = share_with_interval(&shares, 1024);
        let deviation = (16.0 * 1e-4 / 15.0_f64).sqrt();
        let half = 2.131_449_545_559_323 * deviation / 4.0;
        assert!((mean - 0.5).abs() < 1e-15);
        assert!((high - mean - half).abs() < 1e-9 && (mean - low - half).abs() < 1e-9, "{high}");
    }

    #[test]
    fn all_or_nothing_is_not_called_certain() {
        let (mean, (low, high)) = share_with_interval(&[1.0; 16], 4096);
        assert_eq!((mean, high), (1.0, 1.0));
        assert!(low < 1.0 && low > 0.9999, "{low}");
        assert_eq!(share_with_interval(&[0.0; 16], 4096).1.0, 0.0);
    }
}
