//! Quantiles with intervals and standard errors: tables, resamples and bimodal samples.

use crate::support::TestRng;
use stickslip::analysis::{Sample, quantile};

fn sample(amplitudes: &[f64]) -> Sample {
    let amplitudes: Vec<Option<f64>> = amplitudes.iter().copied().map(Some).collect();
    super::sample(&amplitudes, None)
}

/// Conover, Practical Nonparametric Statistics, and tables of the sign test: the median of ten values lies between
/// the second and the ninth, of twenty between the sixth and the fifteenth.
#[test]
fn intervals_of_the_table() {
    let interval = |values: &[f64], fraction| {
        let found = quantile(&sample(values), fraction);
        [found.low, found.high]
    };
    let values: Vec<f64> = (1..=20).map(f64::from).collect();
    assert_eq!(interval(&values[..10], 0.5), [Some(2.0), Some(9.0)]);
    assert_eq!(interval(&values, 0.5), [Some(6.0), Some(15.0)]);
    assert_eq!(interval(&values[..5], 0.5), [None, None], "1/32 in each tail");
    assert_eq!(interval(&values[..6], 0.5), [Some(1.0), Some(6.0)], "1/64 in each tail");
    assert_eq!(interval(&values, 0.95)[1], None, "0.95^20 = 0.36 exceeds the tail");
    assert_eq!(interval(&[], 0.5), [None, None]);
}

#[test]
fn quantiles_are_linear_between_values() {
    let value = |values: &[f64], fraction| quantile(&sample(values), fraction).value;
    assert_eq!(value(&[1.0, 2.0, 4.0], 0.5), Some(2.0));
    assert_eq!(value(&[1.0, 2.0, 4.0], 0.75), Some(3.0));
    assert_eq!(value(&[7.0], 0.1), Some(7.0));
    assert_eq!(value(&[], 0.1), None);
}

/// The standard error of the median of seven values is the standard deviation of the medians of
/// all 7^7 resamples.
#[test]
fn the_standard_error_is_that_of_all_resamples() {
    let values = [1.0, 2.0, 4.0, 5.0, 9.0, 12.0, 20.0];
    let all = 7_usize.pow(7);
    let (mut first, mut second) = (0.0, 0.0);
    for number in 0..all {
        let mut resample: [f64; 7] =
            std::array::from_fn(|digit| values[number / 7_usize.pow(digit as u32) % 7]);
        resample.sort_by(f64::total_cmp);
        first += resample[3];
        second += resample[3] * resample[3];
    }
    let (mean, square) = (first / all as f64, second / all as f64);
    let found = quantile(&sample(&values), 0.5).standard_error.unwrap();
    assert!((found - (square - mean * mean).sqrt()).abs() < 1e-9, "{found}");
    assert_eq!(quantile(&sample(&[3.0; 9]), 0.5).standard_error, Some(0.0), "all identical");
    assert_eq!(quantile(&sample(&values[..3]), 0.5).standard_error, None, "no interval");
    assert_eq!(quantile(&sample(&[]), 0.5).standard_error, None);
}

/// The median over 400 seeded samples of the ratio of the standard error to the true one, which is the scatter of
/// the quantile over the samples. The width of the interval gives 0.53 to 0.57 if the quantile lies in the gap
/// between two modes, and 0.03 to 0.4 near it. The standard deviations are below 0.1 for a median of 400 ratios
/// and 0.035 for the scatter.
#[test]
fn bimodal_samples_have_a_standard_error() {
    let mut draws = TestRng::new(15);
    for (modes, fraction) in [(0.0, 0.9), (0.9, 0.9), (0.88, 0.9), (0.5, 0.5), (0.45, 0.5)] {
        for runs in [128, 384] {
            let mut quantiles = Vec::new();
            let mut errors = Vec::new();
            for _ in 0..400 {
                let mut draw = |_| {
                    let mode = if draws.uniform() < modes { 1.0 } else { 3.0 };
                    mode + 0.2 * draws.uniform()
                };
                let values: Vec<f64> = (0..runs).map(&mut draw).collect();
                let found = quantile(&sample(&values), fraction);
                quantiles.push(found.value.unwrap());
                errors.push(found.standard_error.unwrap());
            }
            let mean = quantiles.iter().sum::<f64>() / 400.0;
            let scatter = (quantiles.iter().map(|quantile| (quantile - mean).powi(2)).sum::<f64>()
                / 399.0)
                .sqrt();
            errors.sort_by(f64::total_cmp);
            let ratio = errors[200] / scatter;
            println!("modes {modes}, quantile {fraction}, {runs} runs: {ratio:.2}");
            assert!((0.75..1.3).contains(&ratio), "{modes} {fraction} {runs}: {ratio}");
        }
    }
}
