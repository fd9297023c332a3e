//! The column `basin_entropy` from the rows of `runs.parquet`.

use std::collections::BTreeMap;

use crate::cli::support::{Scratch, counts, numbers, study_text, words};

/// Blocks on a belt: some come into the limit cycle, and others keep sliding. Some draws of the mass are negative.
fn results(design: &str) -> Scratch {
    let rest = "model: {kind: block_on_belt, parameters: {mass_kg: 1, stiffness_n_m: 100, normal_force_n: 10, \
                friction_coefficient: 0.1}, friction: {stribeck: {static_friction_coefficient: 0.2, \
                stribeck_speed_m_s: 0}}}\n\
                sweep: [{grid: {belt_speed_m_s: [0.2, 0.35]}}]\n\
                uncertain: {mass_kg: {normal: {mean: 1, std_dev: 0.6}}}\n";
    let design = format!("{design}, box: {{position_m: [-0.03, 0.05], velocity_m_s: [-0.4, 0.4]}}");
    let scratch = Scratch::with(study_text("a", &design, 20.0, rest));
    assert_eq!(scratch.stickslip("run a.yaml --out out").code, Some(3));
    scratch
}

#[test]
fn the_entropy_is_that_of_the_runs_in_each_cell() {
    let scratch = results("{stratified: {parts_per_axis: 3, samples_per_cell: 8}}");
    let [runs, points] = ["runs", "points"].map(|name| scratch.table("out", name));
    let [of_point, cell] = ["point_id", "cell"].map(|name| counts(&runs, name));
    let [label, class] = ["label", "cycle_class"].map(|name| words(&runs, name));
    let found = numbers(&points, "basin_entropy");
    for point in [0, 1] {
        let mut cells: BTreeMap<u64, BTreeMap<[Option<&str>; 2], u64>> = BTreeMap::new();
        for row in (0..runs.num_rows()).filter(|&row| of_point[row] == point) {
            let outcome = [label[row].as_deref(), class[row].as_deref()];
            if outcome[0] != Some("failed") {
                *cells.entry(cell[row]).or_default().entry(outcome).or_default() += 1;
            }
        }
        let harmonic = |n: u64| (1..n).map(|j| 1.0 / j as f64).sum::<f64>();
        let entropies: Vec<f64> = cells
            .values()
            .map(|outcomes| (outcomes, outcomes.values().sum::<u64>()))
            .filter(|(_, runs)| *runs >= 2)
            .map(|(outcomes, runs)| {
                let inner: f64 = outcomes.values().map(|&n| n as f64 * harmonic(n)).sum();
                harmonic(runs) - inner / runs as f64
            })
            .collect();
        let mixed = entropies.iter().filter(|entropy| **entropy > 0.1).count();
        assert!(mixed > 1 && entropies.len() > 5, "{entropies:?}");
        let expected = entropies.iter().sum::<f64>() / entropies.len() as f64;
        let found = found[point as usize].expect("cells");
        assert!((found - expected).abs() < 1e-13, "{found} {expected}");
        assert!(counts(&points, "failed_runs")[point as usize] > 0);
    }
}

#[test]
fn designs_without_cells_have_no_entropy() {
    for design in ["{monte_carlo: {samples: 32}}", "{sobol: {samples: 32}}"] {
        let scratch = results(design);
        let points = scratch.table("out", "points");
        assert_eq!(numbers(&points, "basin_entropy"), [None, None], "{design}");
    }
}
