//! Sampling designs: strata as properties, uniformity by statistics.

use std::collections::HashSet;

use super::{assert_follows, coordinates, fractions, study, with_design};

#[test]
fn stratified_has_every_sample_in_its_own_cell() {
    let study = with_design("{stratified: {parts_per_axis: 2, samples_per_cell: 3}}", "");
    assert_eq!(study.run_count(), 768);
    for run in 0..768 {
        let planned = study.planned_run(run);
        assert_eq!((planned.cell, planned.replicate), (run % 256, run / 256));
        let cell = fractions(&study, run)
            .iter()
            .fold(0, |cell, fraction| 2 * cell + u64::from(*fraction >= 0.5));
        assert_eq!(cell, planned.cell);
    }
}

#[test]
fn a_fixed_coordinate_is_not_stratified() {
    let text = super::text_with_design("{stratified: {parts_per_axis: 3, samples_per_cell: 2}}");
    let study = study(&format!("{text}  box: {{x: [0.01, 0.01], beta: [1, 1]}}\n"));
    assert_eq!(study.run_count(), 2 * 3_u64.pow(5));
    assert!((0..study.run_count()).all(|run| {
        let all = coordinates(&study, run);
        all[0] == 0.01 && all[2] == 1.0 && all[3] == 1.0
    }));
}

#[test]
fn latin_hypercube_has_one_sample_in_each_stratum_of_each_axis() {
    for samples in [1_u64, 2, 3, 7, 64, 1000] {
        let study = with_design(&format!("{{latin_hypercube: {{samples: {samples}}}}}"), "");
        let mut seen = vec![HashSet::new(); 8];
        for run in 0..samples {
            for (axis, fraction) in fractions(&study, run).iter().enumerate() {
                assert!(seen[axis].insert((fraction * samples as f64).floor() as u64));
            }
        }
        assert!(seen.iter().all(|strata| strata.len() as u64 == samples));
    }
}

#[test]
fn latin_hypercube_orders_of_two_axes_are_unrelated() {
    let samples = 2000;
    let study = with_design(&format!("{{latin_hypercube: {{samples: {samples}}}}}"), "");
    let all: Vec<Vec<f64>> = (0..samples).map(|run| fractions(&study, run)).collect();
    for left in 0..8 {
        // Each axis against the next, and against the order of the samples.
        let right = (left + 1) % 8;
        let (mut next, mut index) = (0.0, 0.0);
        for (run, sample) in all.iter().enumerate() {
            next += 12.0 * (sample[left] - 0.5) * (sample[right] - 0.5);
            index += 12.0 * (sample[left] - 0.5) * (run as f64 / samples as f64 - 0.5);
        }
        // The standard deviation of the correlation is 1/sqrt(n); four of them, 16 tests.
        let bound = 4.0 * (samples as f64).sqrt();
        assert!(f64::abs(next) < bound && f64::abs(index) < bound, "{left}: {next}, {index}");
    }
}

#[test]
fn monte_carlo_and_cells_are_uniform_on_every_axis() {
    for (design, samples) in [
        ("{monte_carlo: {samples: 10000}}", 10_000),
        ("{stratified: {parts_per_axis: 1, samples_per_cell: 5000}}", 5000),
    ] {
        let study = with_design(design, "");
        let all: Vec<Vec<f64>> = (0..samples).map(|run| fractions(&study, run)).collect();
        for axis in 0..8 {
            let of_axis = all.iter().map(|sample| sample[axis]).collect();
            assert_follows(of_axis, |fraction| fraction, 1.0e-3);
        }
    }
}

#[test]
fn sobol_fills_every_stratum_of_every_axis() {
    let samples = 1024;
    let study = with_design(&format!("{{sobol: {{samples: {samples}}}}}"), "");
    let all: Vec<Vec<f64>> = (0..samples).map(|run| fractions(&study, run)).collect();
    for axis in 0..8 {
        // The small margin covers the transformation to the box and back.
        let strata: HashSet<u64> =
            all.iter().map(|sample| (sample[axis] * 1024.0 + 1.0e-6).floor() as u64).collect();
        assert!(strata.len() >= 1020, "axis {axis}: {} strata", strata.len());
    }
}

#[test]
fn grid_takes_midpoints_so_that_no_angle_is_taken_twice() {
    let study = with_design("{grid: {points_per_axis: 3}}", "");
    assert_eq!(study.run_count(), 3_u64.pow(8));
    let mut angles = HashSet::new();
    for run in 0..study.run_count() {
        let planned = study.planned_run(run);
        assert_eq!((planned.cell, planned.replicate), (run, 0));
        for fraction in fractions(&study, run) {
            let thirds = 6.0 * fraction;
            assert!([1.0, 3.0, 5.0].iter().any(|middle| (thirds - middle).abs() < 1.0e-9));
        }
        angles.insert(planned.start.0[2].to_bits());
    }
    assert_eq!(angles.len(), 3);
    // The last coordinate changes fastest.
    assert_eq!(study.planned_run(0).start.0[0], study.planned_run(1).start.0[0]);
    assert_ne!(study.planned_run(0).start.0[7], study.planned_run(1).start.0[7]);
}

#[test]
fn one_balls_range_wins_over_that_of_all() {
    let text = super::text_with_design("{monte_carlo: {samples: 100}}");
    let study = study(&format!("{text}  box: {{beta: [0, 1], beta_2: [2, 3]}}\n"));
    for run in 0..100 {
        let start = study.planned_run(run).start;
        assert!((0.0..=1.0).contains(&start.0[2]) && (2.0..=3.0).contains(&start.0[3]));
    }
}
