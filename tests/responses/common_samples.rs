//! Designs share their start states and samples (common random numbers), which reduces the error of
//! differences.

use std::sync::atomic::AtomicBool;

use crate::docs::generated::compare_or_write_part;
use crate::support::parse;
use stickslip::engine::WorkerPool;
use stickslip::study::{DesignValue, Plan, Study};

/// Returns a machine with an uncertain imbalance below the critical speed; `box_` is for the start
/// states.
fn balancer(seed: u64, box_: &str, sampling: &str) -> Study {
    parse(format!(
        "
schema: 1
name: a
seed: {seed}
model: {{kind: ball_balancer, parameters: {{balls: 1, speed_rad_s: -130}}}}
uncertain:
  imbalance_mass_kg: {{truncated_normal: {{mean: 5.6e-5, std_dev: 5e-6, min: 4e-5, max: 7.2e-5}}}}
initial_conditions: {{box: {{{box_}}}, design: {{{sampling}}}}}
simulation: {{end_time_s: 6}}
design:
  stiffness_n_m: {{from: 1e4, to: 1.2e4}}
  balls: {{from: 1, to: 3}}
"
    ))
}

fn set(study: &Study, stiffness: f64, balls: f64) -> Plan {
    study.set(&[DesignValue::Number(stiffness), DesignValue::Number(balls)]).unwrap()
}

/// Designs with the same number of balls have equal starts and samples; with more balls, the common
/// coordinates are equal, in designs whose samples do not depend on the number of coordinates. (The
/// cells of a stratified design do.)
#[test]
fn designs_share_their_samples() {
    for sampling in
        ["monte_carlo: {samples: 16}", "sobol: {samples: 16}", "latin_hypercube: {samples: 16}"]
    {
        let study = balancer(2003, "beta_dot: [-0.5, 0.5]", sampling);
        let [soft, hard, more] = [(1.0e4, 1.0), (1.2e4, 1.0), (1.0e4, 3.0)]
            .map(|(stiffness, balls)| set(&study, stiffness, balls));
        for run in 0..16 {
            let [soft, hard, more] = [&soft, &hard, &more].map(|set| set.planned_run(run));
            assert_eq!((&soft.start, &soft.uncertain), (&hard.start, &hard.uncertain));
            assert_ne!(soft.case, hard.case, "another stiffness");
            assert_eq!(soft.uncertain, more.uncertain);
            let [x, y, beta, x_dot, y_dot, beta_dot] = soft.start.0[..] else { panic!("one ball") };
            let [mx, my, mb, .., mx_dot, my_dot, mb_dot, _, _] = more.start.0[..] else {
                panic!("three balls")
            };
            assert_eq!([x, y, beta, x_dot, y_dot, beta_dot], [mx, my, mb, mx_dot, my_dot, mb_dot]);
        }
    }
    // Coordinates outside the study's own box have defaults: the range of a third ball.
    let study = balancer(2003, "beta_dot: [-0.5, 0.5]", "monte_carlo: {samples: 64}");
    let again = parse(study.resolved_yaml());
    assert_eq!(again.hash(), study.hash());
    for run in 0..64 {
        let [planned, again] =
            [&study, &again].map(|study| set(study, 1.1e4, 3.0).planned_run(run));
        assert_eq!(planned, again);
        assert!(planned.start.0[7..].iter().all(|speed| speed.abs() <= 0.5));
    }
}

/// Returns the amplitudes of all runs of a design.
fn amplitudes(plan: &Plan) -> Vec<f64> {
    let workers = WorkerPool::new(2).unwrap();
    let points = workers.sample(&[(plan, 0)], &AtomicBool::new(false), &|_| {});
    let points = points.expect("nothing stops it");
    points.concat().iter().map(|run| run.outcome.amplitude_m.expect("no failure")).collect()
}

fn variance(values: &[f64]) -> f64 {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    values.iter().map(|value| (value - mean) * (value - mean)).sum::<f64>() / (n - 1.0)
}

/// Returns the ratio of the standard errors, with independent and with common samples, of the
/// difference between the mean amplitudes of two designs with 1 % less and 1 % more stiffness.
fn reduction(box_: &str) -> f64 {
    let sampling = "monte_carlo: {samples: 256}";
    let [study, independent] = [2003, 2004].map(|seed| balancer(seed, box_, sampling));
    let soft = amplitudes(&set(&study, 0.99 * 1.07e4, 1.0));
    let hard = amplitudes(&set(&study, 1.01 * 1.07e4, 1.0));
    let other = amplitudes(&set(&independent, 1.01 * 1.07e4, 1.0));
    let difference: Vec<f64> = soft.iter().zip(&hard).map(|(soft, hard)| soft - hard).collect();
    let unpaired = variance(&soft) + variance(&other);
    (unpaired / variance(&difference)).sqrt()
}

/// If a ball hardly moves along the ring before it stops, it stops at nearly the same place in both
/// designs, and common samples reduce the standard error of the difference at least fivefold. From
/// the default box the ball starts with up to the natural frequency and goes round: its rest
/// position is so sensitive to the start that neighbouring designs have little in common except the
/// imbalance, and common samples help little.
#[test]
fn differences_between_neighbours_are_known_better() {
    let near = "x: [-0.01, 0.01], y: [-0.01, 0.01], x_dot: [-0.01, 0.01], y_dot: [-0.01, 0.01], \
                beta_dot: [-0.1, 0.1]";
    let [slow, fast] = [near, ""].map(reduction);
    println!(
        "standard error of the difference, times smaller: slow balls {slow:.1}, all {fast:.1}"
    );
    let times = |factor: f64, digits: usize| format!("{factor:.digits$} times");
    let page = "docs/evaluate.md";
    compare_or_write_part(page, "common-draws-slow", &times(slow, 0));
    compare_or_write_part(page, "common-draws", &times(fast, 1));
    assert!(slow > 5.0, "{slow}");
    assert!(fast > 0.9 && fast < slow, "{fast}");
}
