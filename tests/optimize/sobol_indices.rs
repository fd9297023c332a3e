//! Sobol' indices of functions with known indices.

use std::f64::consts::PI;

use stickslip::optimize::{pick_freeze_sample, sobol_indices};

/// Ishigami and Homma's function, whose indices are known (Saltelli et al., Global Sensitivity Analysis. The Primer,
/// Wiley 2008, section 4.6; a = 7, b = 0.1).
#[test]
fn ishigami() {
    let function = |place: &Vec<f64>| {
        let x: Vec<f64> = place.iter().map(|fraction| PI * (2.0 * fraction - 1.0)).collect();
        x[0].sin() + 7.0 * x[1].sin().powi(2) + 0.1 * x[2].powi(4) * x[0].sin()
    };
    let values: Vec<f64> = pick_freeze_sample(4096, 3, 3).iter().map(function).collect();
    let found = sobol_indices(&values, 3, Some(1)).unwrap();
    for (found, [first, total]) in
        found.iter().zip([[0.3139, 0.5576], [0.4424, 0.4424], [0.0, 0.2437]])
    {
        for (index, expected) in [(found.first_order, first), (found.total, total)] {
            assert!((index.value - expected).abs() < 0.02, "{found:?} {expected}");
            let (low, high) = index.low.zip(index.high).expect("bootstrap intervals");
            assert!(low <= index.value && index.value <= high && high - low < 0.12, "{found:?}");
        }
    }
}

/// The bootstrap's intervals contain the true first-order index of a sum in most of 200 independent designs: 95 %
/// would be 190; fewer than 172 would have a probability below 1e-9.
#[test]
fn intervals_hold() {
    let weights = [1.0, 2.0, 0.5];
    let truth = 4.0 / 5.25;
    let held = (0..200)
        .filter(|&seed| {
            let function = |place: &Vec<f64>| -> f64 {
                place.iter().zip(weights).map(|(fraction, weight)| fraction * weight).sum()
            };
            let values: Vec<f64> = pick_freeze_sample(64, 3, seed).iter().map(function).collect();
            let found = sobol_indices(&values, 3, Some(u64::from(seed))).unwrap()[1];
            let ends = found.first_order.low.zip(found.first_order.high);
            let (low, high) = ends.expect("bootstrap intervals");
            low <= truth && truth <= high
        })
        .count();
    assert!(held >= 172, "{held}");
}

#[test]
fn nothing_varies() {
    assert!(sobol_indices(&[3.0; 40], 3, Some(1)).is_err());
    assert!(sobol_indices(&[1.0; 7], 3, None).is_err());
}
