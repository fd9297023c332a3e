//! The same seed gives the same values: in later versions, in larger samples, in richer studies.

use stickslip::study::Study;

use super::{coordinates, with_design};
use crate::support::cases;

/// Designs, numbers of runs, and their pinned coordinates. A change here breaks reproducibility and must be announced in the
/// changelog.
const PINNED: &str = "{stratified: {parts_per_axis: 2, samples_per_cell: 3}} ¦ 300 ¦ -0.023437353024183757 -0.005594625841120408 3.723860209823801 0.19640650847825614 0.03786673594356636 0.02377393221230939 -0.10768799342498092 -0.5793419616514685
{latin_hypercube: {samples: 100}} ¦ 17 ¦ 0.04974087837163817 -0.03944200699676374 0.21248509202453572 0.07091218139188665 -0.03774809112801435 0.00021184898677464176 0.9486865547068921 -0.9619992374467865
{sobol: {samples: 128}} ¦ 17 ¦ -0.012923943996429446 -0.014149856567382817 4.639611029576629 3.965959771309178 0.03245353698730469 0.007651281356811521 -0.17464089393615723 0.37586402893066406
{monte_carlo: {samples: 100}} ¦ 17 ¦ -0.01650467788562226 -0.04562425575811796 1.1627523891053448 0.6476870604383116 -0.013762218174986386 0.04284939405152598 -0.7964153693058467 -0.17621781914632328
{grid: {points_per_axis: 2}} ¦ 17 ¦ -0.025 -0.025 1.5707963267948966 4.71238898038469 -0.025 -0.025 -0.5 0.5";

#[test]
fn designs_keep_their_values() {
    for [design, run, pinned] in cases(PINNED) {
        let found = coordinates(&with_design(&design, ""), run.parse().expect("a run"));
        let pinned: Vec<f64> =
            pinned.split(' ').map(|number| number.parse().expect("a number")).collect();
        assert_eq!(found, pinned, "{design}");
    }
}

const UNCERTAIN: &str = "uncertain:
  stiffness_n_m: {normal: {mean: 1.0e4, std_dev: 100}}
  ring_radius_m: {truncated_normal: {mean: 0.01, std_dev: 0.001, min: 0.009, max: 0.0115}}
  ball_mass_1_kg: {lognormal: {mean: 1.0e-4, std_dev: 1.0e-5}}
  ball_mass_2_kg: {uniform: {min: 1.0e-4, max: 2.0e-4}}
  ball_diameter_m: {triangular: {min: 0.001, mode: 0.003, max: 0.004}}
  speed_rad_s: {choice: {values: [-1, -2, -3]}}
";

#[test]
fn distributions_keep_their_values() {
    let study = with_design("{monte_carlo: {samples: 100}}", UNCERTAIN);
    let names: Vec<&str> = study.uncertain().iter().map(|column| column.name.as_str()).collect();
    assert_eq!(
        names.join(" "),
        "stiffness_n_m ring_radius_m ball_mass_1_kg ball_mass_2_kg ball_diameter_m speed_rad_s"
    );
    let found = study.planned_run(17).uncertain;
    let expected = [
        10074.446699356546,
        0.010304773310985412,
        0.00010487123168541051,
        0.00017384674643008735,
        0.002300911318600965,
        -1.0,
    ];
    for (found, expected) in found.iter().zip(expected) {
        // Logarithms and exponentials may differ in the last digits between platforms.
        assert!((found - expected).abs() <= 1.0e-13 * expected.abs(), "{found:?} {expected:?}");
    }
}

/// Asserts that every sample of the smaller study is in the larger one under the same cell and
/// replicate.
fn assert_contains(larger: &Study, smaller: &Study, runs: impl Iterator<Item = (u64, u64)>) {
    for (in_larger, in_smaller) in runs {
        let (new, old) = (larger.planned_run(in_larger), smaller.planned_run(in_smaller));
        assert_eq!((new.cell, new.replicate), (old.cell, old.replicate));
        assert_eq!(new.start, old.start);
        for (column, value) in smaller.uncertain().iter().zip(&old.uncertain) {
            let index = larger.uncertain().iter().position(|other| other == column).unwrap();
            assert_eq!(new.uncertain[index], *value);
        }
    }
}

#[test]
fn larger_samples_keep_the_old_ones() {
    let same = |runs: u64| (0..runs).map(|run| (run, run));
    for (small, large, runs) in [
        ("monte_carlo: {samples: 50}", "monte_carlo: {samples: 80}", 50),
        ("sobol: {samples: 64}", "sobol: {samples: 100}", 64),
        (
            "stratified: {parts_per_axis: 2, samples_per_cell: 1}",
            "stratified: {parts_per_axis: 2, samples_per_cell: 3}",
            256,
        ),
    ] {
        let small = with_design(&format!("{{{small}}}"), UNCERTAIN);
        let large = with_design(&format!("{{{large}}}"), UNCERTAIN);
        assert_contains(&large, &small, same(runs));
    }
}

#[test]
fn further_sweep_values_and_uncertain_parameters_keep_the_old_draws() {
    let design = "{monte_carlo: {samples: 20}}";
    let stiffness = "uncertain: {stiffness_n_m: {normal: {mean: 1.0e4, std_dev: 100}}}\n";
    let old =
        with_design(design, &format!("sweep: [{{grid: {{damping_n_s_m: [2]}}}}]\n{stiffness}"));
    let sweep = "sweep: [{grid: {damping_n_s_m: [1, 2, 3]}}]\n";
    let new = with_design(design, &format!("{sweep}{UNCERTAIN}"));
    // The old point is now the second; its runs have moved by twenty.
    assert_contains(&new, &old, (0..20).map(|run| (run + 20, run)));
}

#[test]
fn a_further_ball_keeps_the_coordinates_of_the_others() {
    for design in ["{monte_carlo: {samples: 20}}", "{sobol: {samples: 20}}"] {
        let two = with_design(design, "");
        let text = super::text_with_design(design)
            .replace("{kind: ball_balancer}", "{kind: ball_balancer, parameters: {balls: 3}}");
        let three = super::study(&text);
        for run in 0..20 {
            let (old, new) = (two.planned_run(run).start, three.planned_run(run).start);
            // x, y, beta_1, beta_2, x_dot, y_dot, beta_dot_1, beta_dot_2 among those of three
            // balls.
            assert_eq!(old.0, [0, 1, 2, 3, 5, 6, 7, 8].map(|index: usize| new.0[index]));
        }
    }
}
