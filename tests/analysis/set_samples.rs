//! Sampled fractions of equilibrium sets and their intervals.

use stickslip::analysis::{
    EquilibriumSet, REPLICATES, Resolution, RestForm, Z_95, sample, set_fraction, wilson,
};
use stickslip::model::{Ball, Machine};

fn machine(balls: usize, friction_coefficient: f64) -> Machine {
    let ball = Ball { friction_coefficient, ..Ball::default() };
    Machine { balls: vec![ball; balls], ..Machine::default() }
}

/// Returns how many of the first samples of a scramble are in the set.
fn held(form: &RestForm, replicate: u32, samples: u32) -> usize {
    let positions = (0..samples).map(|index| sample(form.mass.len(), replicate, index));
    positions.filter(|beta| form.at_rest(beta).in_set()).count()
}

/// The quick estimate counts the first 1024 samples of each scramble, also if their positions are
/// cached from another machine.
#[test]
fn the_quick_estimate_counts_the_first_samples() {
    for (balls, friction_coefficient) in [(3, 2.75e-3), (3, 2.75e-4), (4, 2.75e-3), (3, 0.0)] {
        let machine = machine(balls, friction_coefficient);
        let form = RestForm::new(&machine).unwrap();
        let held: usize = (0..REPLICATES).map(|replicate| held(&form, replicate, 1024)).sum();
        assert_eq!(held == 0, friction_coefficient == 0.0);
        assert_eq!(set_fraction(&machine), Some(held as f64 / 16_384.0));
    }
}

/// The interval is Student's for the fractions of 16 scrambles: 2.131450 standard errors for 15
/// degrees of freedom, in published tables.
#[test]
fn the_interval_is_that_of_students_t() {
    let machine = machine(3, 2.75e-3);
    let form = RestForm::new(&machine).unwrap();
    let fractions: Vec<f64> =
        (0..REPLICATES).map(|replicate| held(&form, replicate, 1024) as f64 / 1024.0).collect();
    let mean = fractions.iter().sum::<f64>() / 16.0;
    let squares = fractions.iter().map(|fraction| (fraction - mean).powi(2));
    let half = 2.131_449_545_559_323 * (squares.sum::<f64>() / 15.0 / 16.0).sqrt();
    assert!(0.0 < half && half < mean, "{half} {mean}");
    let set = EquilibriumSet::of(&machine, Resolution::Samples(1024)).unwrap();
    let (low, high) = set.fraction_interval.unwrap();
    assert!((set.fraction - mean).abs() < 1e-15);
    assert!((high - mean - half).abs() < 1e-9 && (mean - low - half).abs() < 1e-9, "{high}");
}

/// At standstill every position is in the set; without friction no sample is.
#[test]
fn fractions_of_zero_and_one_have_wilsons_interval() {
    let still = Machine { speed_rad_s: 0.0, ..machine(3, 2.75e-3) };
    let all = u64::from(REPLICATES) * 4096;
    for (machine, fraction, held) in [(still, 1.0, all), (machine(3, 0.0), 0.0, 0)] {
        let set = EquilibriumSet::of(&machine, Resolution::Samples(4096)).unwrap();
        assert_eq!(set.fraction, fraction);
        assert_eq!(set.fraction_interval, Some(wilson(held, all, Z_95)));
    }
}
