//! Samples of uncertain parameters follow their distributions (Kolmogorov-Smirnov, alpha 0.001 for
//! each test with a fixed seed).

use statrs::distribution::{ContinuousCDF, LogNormal, Normal};

use stickslip::study::DesignValue;

use crate::support::cases;

use super::{assert_follows, parse, study, text_with_design};

const ALPHA: f64 = 1.0e-3;

fn draws(distribution: &str) -> Vec<f64> {
    let text = text_with_design("{monte_carlo: {samples: 10000}}");
    let study = study(&format!("{text}uncertain: {{speed_rad_s: {distribution}}}\n"));
    (0..10_000).map(|run| study.planned_run(run).uncertain[0]).collect()
}

#[test]
fn normal_and_uniform_samples_follow_their_distributions() {
    let normal = Normal::new(-200.0, 5.0).expect("the deviation is positive");
    assert_follows(draws("{normal: {mean: -200, std_dev: 5}}"), |x| normal.cdf(x), ALPHA);
    assert_follows(draws("{uniform: {min: -3, max: 5}}"), |x| (x + 3.0) / 8.0, ALPHA);
}

#[test]
fn lognormal_is_given_by_the_parameter_s_own_mean_and_standard_deviation() {
    let samples = draws("{lognormal: {mean: 10, std_dev: 4}}");
    let variance = (1.0_f64 + 0.16).ln();
    let expected = LogNormal::new(10.0_f64.ln() - variance / 2.0, variance.sqrt()).unwrap();
    let mean = samples.iter().sum::<f64>() / 10_000.0;
    assert!((mean - 10.0).abs() < 4.0 * 4.0 / 100.0, "{mean}");
    assert_follows(samples, |x| expected.cdf(x), ALPHA);
}

#[test]
fn truncated_normal_in_the_middle_and_in_both_tails() {
    let normal = Normal::new(2.0, 1.0).unwrap();
    for (min, max) in [(1.0, 4.0), (4.5, 9.0), (-9.0, -0.5), (8.0, 9.0)] {
        let range =
            format!("{{truncated_normal: {{mean: 2, std_dev: 1, min: {min}, max: {max}}}}}");
        let samples = draws(&range);
        assert!(samples.iter().all(|x| (min..=max).contains(x)));
        let within = normal.sf(min) - normal.sf(max);
        assert_follows(samples, |x| (normal.sf(min) - normal.sf(x)) / within, ALPHA);
    }
}

#[test]
fn triangular_with_its_mode_inside_and_at_the_ends() {
    for (min, mode, max) in [(0.0, 1.0, 4.0), (0.0, 0.0, 2.0), (0.0, 2.0, 2.0)] {
        let cdf = |x: f64| {
            if x < mode {
                (x - min).powi(2) / ((max - min) * (mode - min))
            } else if x < max {
                1.0 - (max - x).powi(2) / ((max - min) * (max - mode))
            } else {
                1.0
            }
        };
        let range = format!("{{triangular: {{min: {min}, mode: {mode}, max: {max}}}}}");
        assert_follows(draws(&range), cdf, ALPHA);
    }
}

#[test]
fn choice_takes_values_by_weight_and_never_one_without() {
    let samples = draws("{choice: {values: [5, 6, 7, 8], weights: [1, 0, 3, 0]}}");
    let count = |value: f64| samples.iter().filter(|x| **x == value).count();
    assert_eq!((count(6.0), count(8.0), count(5.0) + count(7.0)), (0, 0, 10_000));
    // Four standard deviations of a binomial count with probability 1/4.
    assert!((count(5.0) as f64 - 2500.0).abs() < 4.0 * 1875.0_f64.sqrt());
    let equal = draws("{choice: {values: [1, 2]}}");
    assert!((equal.iter().sum::<f64>() - 15_000.0).abs() < 4.0 * 50.0);
}

#[test]
fn draws_of_different_parameters_are_unrelated() {
    let text = text_with_design("{monte_carlo: {samples: 10000}}");
    let uniform = "{uniform: {min: 1, max: 2}}";
    let study = study(&format!(
        "{text}uncertain: {{ball_mass_1_kg: {uniform}, ball_mass_2_kg: {uniform}}}\n"
    ));
    let correlation: f64 = (0..10_000)
        .map(|run| study.planned_run(run))
        .map(|run| 12.0 * (run.uncertain[0] - 1.5) * (run.uncertain[1] - 1.5) / 10_000.0)
        .sum();
    assert!(correlation.abs() < 0.04, "{correlation}");
}

/// A factor multiplies the value from the model, a point of the sweep or a design; the samples of
/// the factor are those of the distribution itself.
#[test]
fn times_multiplies_what_is_set() {
    let plain = draws("{uniform: {min: 0.5, max: 2}}");
    let text = text_with_design("{monte_carlo: {samples: 10000}}");
    let times = "uncertain: {speed_rad_s: {times: {uniform: {min: 0.5, max: 2}}}}\n";
    let swept =
        study(&format!("{text}sweep: [{{grid: {{speed_rad_s: [-160, -216.5]}}}}]\n{times}"));
    for (run, factor) in (0..).zip(&plain) {
        for (first, speed) in [(0, -160.0), (10_000, -216.5)] {
            let planned = swept.planned_run(first + run);
            assert_eq!(planned.uncertain, [speed * factor]);
            let case = planned.case.unwrap();
            assert_eq!(case.model.ball_balancer().unwrap().speed_rad_s, speed * factor);
        }
    }
    let varied =
        study(&format!("{text}{times}design: {{speed_rad_s: {{from: -300, to: -100}}}}\n"));
    let base = varied.model().ball_balancer().expect("a balancer").speed_rad_s;
    assert_eq!(varied.planned_run(7).uncertain, [base * plain[7]]);
    let set = varied.set(&[DesignValue::Number(-250.0)]).expect("one variable");
    assert_eq!(set.planned_run(7).uncertain, [-250.0 * plain[7]]);
    assert_eq!(study(&varied.resolved_yaml()).hash(), varied.hash());
}

#[test]
fn invalid_factors_are_refused() {
    let text = text_with_design("{monte_carlo: {samples: 2}}");
    for [rest, problem] in cases(
        r"uncertain: {balls: {times: {uniform: {min: 1, max: 2}}}} ¦ not a parameter
uncertain: {stiffness_n_m: {times: {times: {uniform: {min: 1, max: 2}}}}} ¦ a factor of a factor
uncertain: {stiffness_n_m: {times: {uniform: {min: -1, max: 2}}}} ¦ no physical meaning
sweep: [{grid: {friction_coefficient_1: [1e-3]}}]\nuncertain: {friction_coefficient: {times: {uniform: {min: 1, max: 2}}}} ¦ both uncertain and swept
sweep: [{grid: {friction_coefficient: [1e-3]}}]\nuncertain: {friction_coefficient_1: {times: {uniform: {min: 1, max: 2}}}} ¦ both uncertain and swept
uncertain: {stiffness_n_m: {uniform: {min: 9e3, max: 1e4}}}\ndesign: {stiffness_n_m: {from: 9e3, to: 1e4}}\nresponses: {a: median_time_to_rest} ¦ varied twice",
    ) {
        let error = parse(&format!("{text}{rest}\n")).unwrap_err();
        assert!(error.to_string().contains(&problem), "{rest}\n{error}");
    }
}
