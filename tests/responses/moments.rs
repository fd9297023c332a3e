//! Student's interval of means against printed tables.

use super::sample;
use stickslip::analysis::{Sample, mean};

/// Returns half of the width of the interval of the mean over its standard error.
fn standard_errors(sample: &Sample) -> f64 {
    let found = mean(sample);
    let half = 0.5 * (found.high.unwrap() - found.low.unwrap());
    half / found.standard_error.unwrap()
}

/// The interval of `n` runs has `n - 1` degrees of freedom.
#[test]
fn the_table_of_student() {
    for (runs, printed) in
        [(2, 12.706), (3, 4.303), (6, 2.571), (31, 2.042), (121, 1.980), (100_001, 1.960)]
    {
        let amplitudes: Vec<Option<f64>> = (0..runs).map(|run| Some(f64::from(run % 2))).collect();
        let found = standard_errors(&sample(&amplitudes, None));
        assert!((found - printed).abs() < 6e-4, "{runs} runs: {found} {printed}");
    }
}

/// Two cells of three runs, the second with half of the deviations of the first, have 2.94 degrees
/// of freedom (Satterthwaite), which are rounded down to 2.
#[test]
fn degrees_of_freedom_are_rounded_down() {
    let amplitudes = [0.0, 0.0, 1.0, 0.5, 2.0, 1.0].map(Some);
    let found = standard_errors(&sample(&amplitudes, Some(2)));
    assert!((found - 4.303).abs() < 6e-4, "{found}");
}
