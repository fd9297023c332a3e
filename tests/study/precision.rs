//! Runs that are reserved for a required precision: which, how many, and their independence from
//! it.

use stickslip::study::{Sampling, Study};

use super::{coordinates, refused, study, text_with_design};
use crate::support::cases;

fn precise(design: &str, max_runs: u64, rest: &str) -> Study {
    let precision = format!("precision: {{equilibrium_fraction: 0.02, max_runs: {max_runs}}}\n");
    study(&format!("{}{precision}{rest}", text_with_design(design)))
}

fn sampling(design: &str, max_runs: u64) -> (u64, u64, u64) {
    let Sampling { first, replicate, most } = precise(design, max_runs, "").point(0).sampling;
    (first, replicate, most)
}

#[test]
fn whole_replicates_are_reserved() {
    let stratified = "{stratified: {parts_per_axis: 2, samples_per_cell: 3}}";
    assert_eq!(sampling(stratified, 20_000), (768, 256, 19_968));
    assert_eq!(sampling(stratified, 1024), (768, 256, 1024));
    assert_eq!(sampling(stratified, 1023), (768, 256, 768));
    // The runs of the design are always computed.
    assert_eq!(sampling(stratified, 1), (768, 256, 768));
    assert_eq!(sampling("{monte_carlo: {samples: 300}}", 1000), (300, 300, 900));
    assert_eq!(sampling("{sobol: {samples: 64}}", 1_000_000), (64, 64, 65_536));
    assert_eq!(sampling("{sobol: {samples: 100}}", 1_000_000), (100, 100, 65_500));
    let fixed =
        "x: [0, 0], y: [0, 0], x_dot: [0, 0], y_dot: [0, 0], beta: [1, 1], beta_dot: [2, 2]";
    let text =
        text_with_design(stratified).replace("  design", &format!("  box: {{{fixed}}}\n  design"));
    let precision = "precision: {equilibrium_fraction: 0.1, max_runs: 10}\n";
    let Sampling { first, replicate, most } = study(&(text + precision)).point(0).sampling;
    assert_eq!((first, replicate, most), (3, 1, 10));
}

/// A run's number, start and samples depend on its point and its sample only; the last reserved run
/// can be planned as well as the first.
#[test]
fn samples_continue_where_they_would_have_stopped() {
    let uncertain = "uncertain: {imbalance_mass_kg: {uniform: {min: 5.0e-5, max: 6.0e-5}}}\n";
    for (design, more) in [
        ("{stratified: {parts_per_axis: 2, samples_per_cell: 1}}", "samples_per_cell: 4"),
        ("{monte_carlo: {samples: 256}}", "samples: 1024"),
        ("{sobol: {samples: 256}}", "samples: 1024"),
    ] {
        let sequential = precise(design, 1024, uncertain);
        let (key, _) = more.split_once(' ').unwrap();
        let at = design.find(key).unwrap();
        let enlarged = format!("{}{more}}}}}", &design[..at]);
        let whole = study(&(text_with_design(&enlarged) + uncertain));
        assert_eq!((sequential.run_count(), sequential.least_run_count()), (1024, 256));
        assert_eq!(whole.run_count(), 1024);
        for run in [0, 255, 256, 700, 1023] {
            assert_eq!(sequential.planned_run(run), whole.planned_run(run));
        }
        assert_ne!(coordinates(&sequential, 255), coordinates(&sequential, 511));
    }
    let last = precise("{sobol: {samples: 64}}", 1_000_000, "");
    assert_eq!(last.planned_run(65_535).replicate, 65_535);
}

#[test]
fn points_follow_one_another_by_what_is_reserved() {
    let sweep = "sweep:
  - grid: {speed_rad_s: [-1, -2]}
  - grid: {speed_rad_s: [-3]}
    design: {sobol: {samples: 16}}
";
    let study = precise("{monte_carlo: {samples: 10}}", 35, sweep);
    assert_eq!((study.run_count(), study.least_run_count()), (30 + 30 + 32, 10 + 10 + 16));
    let first: Vec<u64> = (0..3).map(|id| study.point(id).first_run).collect();
    assert_eq!(first, [0, 30, 60]);
    for (run, point, replicate) in [(29, 0, 29), (30, 1, 0), (59, 1, 29), (60, 2, 0), (91, 2, 31)] {
        let planned = study.planned_run(run);
        assert_eq!((planned.point_id, planned.replicate), (point, replicate));
    }
    let point_ranges: Vec<_> = study.point_ranges().collect();
    assert_eq!(point_ranges, [(0..2, 30), (2..3, 32)]);
}

#[test]
fn amplitudes_have_half_widths_with_units() {
    let text = text_with_design("{sobol: {samples: 4}}");
    let with = |keys: &str| study(&format!("{text}precision: {{{keys}, max_runs: 64}}\n"));
    let metres = with("amplitude_p50_m: 1.0e-6, amplitude_p95_m: 5.0e-6");
    let precision = metres.precision().expect("a precision");
    assert_eq!(precision.equilibrium_fraction, None);
    assert_eq!(precision.amplitudes_m(), [None, Some(1.0e-6), Some(5.0e-6)]);
    assert_eq!(with("amplitude_p95: 5 µm, amplitude_p50: 1 um").hash(), metres.hash());
    let all = with("equilibrium_fraction: 0.1, amplitude_p05_m: 2.0e-6, amplitude_p95_m: 5.0e-6");
    assert_ne!(all.hash(), metres.hash());
    assert_eq!(study(&all.resolved_yaml()).precision(), all.precision());
    assert!(metres.resolved_yaml().contains("amplitude_p50_m: 1.0e-6"));
    let words = "the half width of the 95 % interval of equilibrium_fraction is at most 0.1, and that of \
                 amplitude_p05_m is at most 2e-6 m, and that of amplitude_p95_m is at most 5e-6 m";
    assert_eq!(all.precision().map(|precision| precision.in_words()).as_deref(), Some(words));
}

const PRECISION: &str = "precision: {equilibrium_fraction: 0.02, max_runs: 20000}\n";

#[test]
fn designs_that_cannot_be_enlarged_are_refused() {
    let allowed = "stratified, monte_carlo or sobol, or no `precision`";
    let table = "{table: {columns: [x, y, beta_1, beta_2, x_dot, y_dot, beta_dot_1, beta_dot_2], \
                 rows: [[0, 0, 0, 0, 0, 0, 0, 0]]}}";
    for (design, kind) in [
        ("{latin_hypercube: {samples: 4}}", "latin_hypercube"),
        ("{grid: {points_per_axis: 2}}", "grid"),
        (table, "table"),
    ] {
        let text = text_with_design(design) + PRECISION;
        refused(&text, 6, &format!("initial_conditions.design.{kind}"), kind, allowed);
    }
    let sweep = "sweep: [{grid: {speed_rad_s: [1]}, design: {latin_hypercube: {samples: 4}}}]\n";
    let text = text_with_design("{sobol: {samples: 4}}") + PRECISION + sweep;
    refused(&text, 8, "sweep[0].design.latin_hypercube", "latin_hypercube", allowed);
}

/// A precision, the key of the message, what it found, and what it allows.
const WRONG: &str = r"equilibrium_fraction: 0, max_runs: 100 ¦ precision.equilibrium_fraction ¦ 0 ¦ above 0 and below 0.5
equilibrium_fraction: -0.1, max_runs: 100 ¦ precision.equilibrium_fraction ¦ -0.1 ¦ above 0 and below 0.5
equilibrium_fraction: 0.5, max_runs: 100 ¦ precision.equilibrium_fraction ¦ 0.5 ¦ above 0 and below 0.5
equilibrium_fraction: 2, max_runs: 100 ¦ precision.equilibrium_fraction ¦ 2 ¦ above 0 and below 0.5
equilibrium_fraction: 0.1, max_runs: 0 ¦ precision.max_runs ¦ 0 ¦ a whole number from 1 to 1e15
max_runs: 10 ¦ precision ¦ only max_runs ¦ equilibrium_fraction: 0.02 or amplitude_p95_m: 1.0e-6
amplitude_p95_m: 1e-6 ¦ precision.max_runs ¦  ¦ a value for
amplitude_p05_m: 0, max_runs: 10 ¦ precision.amplitude_p05_m ¦  ¦ a number above 0
amplitude_p50_m: -1e-6, max_runs: 10 ¦ precision.amplitude_p50_m ¦  ¦ a number above 0
amplitude_p95_m: 0.0, max_runs: 10 ¦ precision.amplitude_p95_m ¦  ¦ a number above 0
amplitude_p95: 5e-6, max_runs: 10 ¦ precision.amplitude_p95 ¦ 5e-6 ¦ amplitude_p95_m
amplitude_p99_m: 5e-6, max_runs: 10 ¦ precision.amplitude_p99_m ¦ p99 ¦ amplitude_p95_m (did you mean";

#[test]
fn invalid_values_are_refused() {
    let with = |precision: &str| {
        text_with_design("{monte_carlo: {samples: 4}}") + "precision: {" + precision + "}\n"
    };
    for [precision, key, found, allowed] in cases(WRONG) {
        refused(&with(&precision), 7, &key, &found, &allowed);
    }
    let huge = "{stratified: {parts_per_axis: 1000, samples_per_cell: 5}}";
    let huge = text_with_design(huge) + PRECISION;
    let found = "e24 runs (points: 1, samples";
    refused(&huge, 6, "initial_conditions.design", found, "at most 1e15 runs");
    let most = with("equilibrium_fraction: 0.1, max_runs: 1e15");
    let many = most.clone() + "sweep: [{grid: {speed_rad_s: [1, 2]}}]\n";
    let found = "2e15 runs (points: 2, samples at each: 1e15)";
    refused(&many, 6, "initial_conditions.design", found, "at most 1e15 runs");
    assert_eq!(study(&most).run_count(), 1_000_000_000_000_000);
}
