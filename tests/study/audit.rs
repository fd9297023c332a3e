//! The selection of audited runs: a random fraction, independent at every point, and permanent.

use stickslip::study::Study;

use super::{study, text_with_design};
use crate::support::cases;

fn audited(fraction: f64, samples: u64, sweep: &str) -> Study {
    let design = format!("{{monte_carlo: {{samples: {samples}}}}}");
    study(&format!("{}audit: {{fraction: {fraction}}}\n{sweep}", text_with_design(&design)))
}

fn choices(study: &Study) -> Vec<bool> {
    (0..study.run_count()).map(|run| study.planned_run(run).audited).collect()
}

fn chosen(study: &Study) -> Vec<u64> {
    (0..study.run_count()).filter(|run| study.planned_run(*run).audited).collect()
}

/// The number of selected runs is binomial: five standard deviations, alpha below 1e-6 each.
#[test]
fn the_requested_fraction_is_audited() {
    let runs = 20_000;
    for fraction in [0.01, 0.05, 0.5, 0.93] {
        let found = chosen(&audited(fraction, runs, "")).len() as f64;
        let deviation = (runs as f64 * fraction * (1.0 - fraction)).sqrt();
        let distance = (found - fraction * runs as f64).abs() / deviation;
        assert!(distance < 5.0, "{fraction}: {found}, {distance} standard deviations");
    }
    assert_eq!(chosen(&audited(1.0, 1000, "")).len(), 1000);
    assert!(chosen(&super::with_design("{monte_carlo: {samples: 1000}}", "")).is_empty());
}

/// The number of runs that are selected at both of two points is that of independent selections:
/// five standard deviations, alpha below 1e-6 each.
#[test]
fn points_choose_independently() {
    let samples = 10_000;
    let sweep =
        "sweep: [{grid: {speed_rad_s: [-160, -160.1], normal_force: [lagrange, newton]}}]\n";
    let all = choices(&audited(0.3, samples, sweep));
    let points: Vec<&[bool]> = all.chunks(samples as usize).collect();
    assert_eq!(points.len(), 4);
    let expected = samples as f64 * 0.09;
    let deviation = (expected * (1.0 - 0.09)).sqrt();
    for (index, first) in points.iter().enumerate() {
        for second in &points[index + 1..] {
            let both = first.iter().zip(*second).filter(|(here, there)| **here && **there).count();
            let distance = (both as f64 - expected).abs() / deviation;
            assert!(distance < 5.0, "{both} instead of {expected}");
        }
    }
}

/// The selection is pinned: a change would alter every study with an audit.
#[test]
fn the_choice_is_pinned() {
    let sweep = "sweep: [{zip: {speed_rad_s: [-160.5, 0], normal_force: [newton, lagrange]}}]\n";
    assert_eq!(chosen(&audited(0.1, 50, sweep)), PINNED);
    let turned =
        "sweep: [{zip: {normal_force: [newton, lagrange], speed_rad_s: [-160.5, -0.0]}}]\n";
    assert_eq!(chosen(&audited(0.1, 50, turned)), PINNED);
}

const PINNED: [u64; 6] = [1, 30, 36, 89, 91, 97];

/// A larger fraction, more samples, further points and further uncertain parameters preserve all
/// selections.
#[test]
fn choices_are_kept() {
    let speeds = |list: &str| format!("sweep: [{{grid: {{speed_rad_s: [{list}]}}}}]\n");
    let old = choices(&audited(0.2, 300, &speeds("-160, -200")));
    let larger = choices(&audited(0.4, 300, &speeds("-160, -200")));
    assert!(old.iter().zip(&larger).all(|(old, new)| !old || *new));
    let (old, larger) = (count(&old), count(&larger));
    assert!(larger > old + 60, "{old} {larger}");

    let old = choices(&audited(0.2, 300, &speeds("-160, -200")));
    let more = choices(&audited(0.2, 500, &speeds("-160, -200")));
    assert_eq!((&old[..300], &old[300..]), (&more[..300], &more[500..800]));
    let further = choices(&audited(0.2, 300, &speeds("-170, -160, -180, -200")));
    assert_eq!((&old[..300], &old[300..]), (&further[300..600], &further[900..]));
    let uncertain = "uncertain: {imbalance_mass_kg: {uniform: {min: 5.0e-5, max: 6.0e-5}}}\n";
    assert_eq!(old, choices(&audited(0.2, 300, &(speeds("-160, -200") + uncertain))));
}

fn count(choices: &[bool]) -> usize {
    choices.iter().filter(|chosen| **chosen).count()
}

/// An audit does not affect any other sample.
#[test]
fn an_audit_changes_no_draw() {
    let rest = "uncertain: {imbalance_mass_kg: {uniform: {min: 5.0e-5, max: 6.0e-5}}}\n";
    let with = audited(0.5, 40, rest);
    let without = super::with_design("{monte_carlo: {samples: 40}}", rest);
    for run in 0..40 {
        let mut planned = with.planned_run(run);
        planned.audited = false;
        assert_eq!(planned, without.planned_run(run));
    }
}

#[test]
fn invalid_fractions_are_refused() {
    let text = text_with_design("{sobol: {samples: 4}}");
    for [rest, key, found, allowed] in cases(
        r"audit: {fraction: 0} ¦ audit.fraction ¦ 0 ¦ a number above 0 and at most 1
audit: {fraction: -0.1} ¦ audit.fraction ¦ -0.1 ¦ a number above 0 and at most 1
audit: {fraction: 1.01} ¦ audit.fraction ¦ 1.01 ¦ a number above 0 and at most 1
audit: {} ¦ audit.fraction ¦  ¦
expect: [{audit_flip_rate: [0, 0.1]}] ¦ expect[0].audit_flip_rate ¦  ¦ audit: {fraction: 0.05}
expect: [{audit_flip_rate: [0.2, 0.1]}]\naudit: {fraction: 0.5} ¦ expect[0].audit_flip_rate ¦  ¦",
    ) {
        super::refused(&format!("{text}{rest}\n"), 7, &key, &found, &allowed);
    }
    let right = "audit: {fraction: 0.5}\nexpect: [{audit_flip_rate: [0, 0.1]}]\n";
    let right = study(&format!("{text}{right}"));
    assert_eq!(right.expectations()[0].audit_flip_rate, Some([0.0, 0.1]));
}
