//! The intervals of `points.parquet` and of the JSON fit the design, and their method is named.

use stickslip::analysis::{Z_95, wilson};
use stickslip::classification::Label;

use crate::cli::support::{Scratch, counts, numbers, study_text, words};

/// Returns the only point of a study with this design: method, ends, equilibria and runs.
fn point(design: &str, more: &str) -> (String, (f64, f64), u64, u64) {
    let scratch = Scratch::with(study_text("a", design, 5.0, ""));
    let json = scratch.json(&format!("run a.yaml --out out --json {more}"));
    let points = scratch.table("out", "points");
    let [low, high] = ["ci_low", "ci_high"].map(|name| numbers(&points, name)[0].unwrap());
    let method = words(&points, "ci_method")[0].clone().unwrap();
    assert_eq!(json["points"][0]["ci_method"], method.as_str());
    let printed_low = json["points"][0]["ci_low"].as_f64().unwrap();
    assert!((printed_low - low).abs() < 1e-12);
    let [equilibria, runs] = ["equilibrium_runs", "runs"].map(|name| counts(&points, name)[0]);
    for label in Label::ALL.map(Label::name) {
        let runs_of = counts(&points, &format!("{label}_runs"))[0] as f64 / runs as f64;
        let [low, high] =
            ["low", "high"].map(|end| numbers(&points, &format!("{label}_{end}"))[0].unwrap());
        assert!(low <= runs_of && runs_of <= high, "{label}: {low} {runs_of} {high}");
    }
    (method, (low, high), equilibria, runs)
}

/// Two or more samples in every cell give a stratified interval; fewer, or a design without cells,
/// give Wilson's interval.
#[test]
fn stratified_designs_have_stratified_intervals() {
    let stratified = |samples: u32| {
        format!("{{stratified: {{parts_per_axis: 2, samples_per_cell: {samples}}}}}")
    };
    let (method, (low, high), equilibria, runs) = point(&stratified(2), "");
    assert_eq!((method.as_str(), runs), ("stratified", 512));
    let whole = wilson(equilibria, runs, Z_95);
    assert!(equilibria > 50 && equilibria < 462, "the study is too small: {equilibria}");
    assert!(whole.0 < low && high < whole.1, "{low} {high}, {whole:?}");
    // A shard of two has only half of the cells.
    for (design, more) in [
        (stratified(1), ""),
        (stratified(2), "--shard 1/2"),
        ("{monte_carlo: {samples: 60}}".to_owned(), ""),
        ("{latin_hypercube: {samples: 60}}".to_owned(), ""),
        ("{grid: {points_per_axis: 2}}".to_owned(), ""),
    ] {
        let (method, interval, equilibria, runs) = point(&design, more);
        assert_eq!(method, "wilson", "{design} {more}");
        assert_eq!(interval, wilson(equilibria, runs, Z_95), "{design} {more}");
    }
}
