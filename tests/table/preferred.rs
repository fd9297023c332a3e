//! Preferred equilibria: `density.parquet`, and distances to the equilibria without friction.

use std::collections::BTreeMap;

use arrow::array::RecordBatch;
use stickslip::analysis::{bin_edges, wilson};

use super::contract::columns;
use crate::cli::support::{AT_ONCE, Scratch, counts, numbers, study_text, words};

fn results(model: &str, speeds: &str, samples: u32, end_time_s: f64) -> Scratch {
    let scratch = Scratch::new();
    let design = format!("{{monte_carlo: {{samples: {samples}}}}}");
    let rest = format!("{model}sweep: [{{grid: {{speed_rad_s: [{speeds}]}}}}]\n");
    scratch.write("a.yaml", study_text("a", &design, end_time_s, &rest));
    scratch.well("run a.yaml --out out");
    scratch
}

fn all(table: &RecordBatch, name: &str) -> Vec<f64> {
    numbers(table, name).into_iter().map(|number| number.expect("a number")).collect()
}

/// Rows of equilibria by point and bins are what the density's rows count.
#[test]
fn bins_count_the_equilibria() {
    let scratch = results("", "-160.0, -216.0", 100, 8.0);
    let [equilibria, density] = ["equilibria", "density"].map(|name| scratch.table("out", name));
    let expected = [
        "point_id c -",
        "speed_rad_s n rad/s",
        "bin_1 c -",
        "beta_1_from_rad n rad",
        "beta_1_to_rad n rad",
        "bin_2 c -",
        "beta_2_from_rad n rad",
        "beta_2_to_rad n rad",
        "runs c -",
        "share n 1",
        "ci_low n 1",
        "ci_high n 1",
        "density_1_rad2 n 1/rad²",
        "kernel_width_rad n rad",
    ];
    assert_eq!(columns(&density), expected);
    let key = |table: &RecordBatch| -> Vec<[u64; 3]> {
        let [points, first, second] =
            ["point_id", "bin_1", "bin_2"].map(|name| counts(table, name));
        (0..points.len()).map(|row| [points[row], first[row], second[row]]).collect()
    };
    let mut seen: BTreeMap<[u64; 3], u64> = BTreeMap::new();
    for (row, key) in key(&equilibria).into_iter().enumerate() {
        *seen.entry(key).or_default() += 1;
        for (ball, bin) in [("beta_1_rad", key[1]), ("beta_2_rad", key[2])] {
            let angle = all(&equilibria, ball)[row];
            let [from, to] = bin_edges(bin as usize);
            assert!(from <= angle && angle < to, "{angle} {bin}");
        }
        assert!(key[1] <= key[2]);
    }
    assert!(seen.len() > 20, "the study shows too little");
    let counted: BTreeMap<[u64; 3], u64> =
        key(&density).into_iter().zip(counts(&density, "runs")).collect();
    assert_eq!(counted, seen);
    let points = scratch.table("out", "points");
    let at_rest = counts(&points, "equilibrium_runs");
    let [share, low, high, from] =
        ["share", "ci_low", "ci_high", "beta_1_from_rad"].map(|name| all(&density, name));
    for (row, (key, runs)) in counted.iter().enumerate() {
        let of_point = at_rest[key[0] as usize];
        assert_eq!(share[row], *runs as f64 / of_point as f64);
        assert_eq!((low[row], high[row]), wilson(*runs, of_point, stickslip::analysis::Z_95));
        assert_eq!(from[row], bin_edges(key[1] as usize)[0]);
    }
}

/// Medians of `points.parquet` are those of `equilibria.parquet`; between 179.3 and 181.6 rad/s no
/// equilibrium without friction is stable, and there is nothing to be near to.
#[test]
fn distances_to_frictionless_equilibria() {
    let scratch = results("", "-160.0, -181.0, -216.0", 60, 8.0);
    let equilibria = scratch.table("out", "equilibria");
    let distances = numbers(&equilibria, "distance_to_frictionless_rad");
    let kinds = words(&equilibria, "nearest_frictionless");
    let of_point = counts(&equilibria, "point_id");
    let points = scratch.table("out", "points");
    let medians = numbers(&points, "distance_to_frictionless_p50_rad");
    let by_chance = numbers(&points, "distance_to_frictionless_p50_uniform_rad");
    for (point, kind) in [(0, Some("a1_plus")), (1, None), (2, Some("b1"))] {
        let rows: Vec<usize> =
            (0..of_point.len()).filter(|&row| of_point[row] == point as u64).collect();
        assert!(rows.iter().all(|&row| kinds[row].as_deref() == kind), "{point}");
        let mut sorted: Vec<f64> = rows.iter().filter_map(|&row| distances[row]).collect();
        sorted.sort_by(f64::total_cmp);
        assert_eq!(
            (medians[point].is_some(), by_chance[point].is_some()),
            (kind.is_some(), kind.is_some())
        );
        if kind.is_some() {
            assert!(sorted.len() == rows.len() && rows.len() > 5);
            let middle = sorted.len() / 2;
            let median = 0.5 * (sorted[(sorted.len() - 1) / 2] + sorted[middle]);
            assert!((medians[point].unwrap() - median).abs() < 1e-12);
        }
    }
}

/// Three balls and more: one angle, by balls that are alike; a block has no ring.
#[test]
fn other_numbers_of_balls() {
    let model = "model: {kind: ball_balancer, parameters: {balls: [{mass_kg: 1.4e-4}, \
                 {mass_kg: 1.0e-4}, {mass_kg: 1.4e-4}]}}\n";
    let scratch = results(model, "-160.0", 30, 8.0);
    let [equilibria, density] = ["equilibria", "density"].map(|name| scratch.table("out", name));
    let expected = [
        "point_id c -",
        "speed_rad_s n rad/s",
        "ball c -",
        "bin_1 c -",
        "beta_1_from_rad n rad",
        "beta_1_to_rad n rad",
        "runs c -",
        "share n 1",
        "ci_low n 1",
        "ci_high n 1",
        "density_1_rad n 1/rad",
        "kernel_width_rad n rad",
    ];
    assert_eq!(columns(&density), expected);
    let bins = [1, 2, 3].map(|ball| counts(&equilibria, &format!("bin_{ball}")));
    let (ball, bin, runs) =
        (counts(&density, "ball"), counts(&density, "bin_1"), counts(&density, "runs"));
    assert!(equilibria.num_rows() > 5, "the study shows too little");
    for row in 0..density.num_rows() {
        let alike: &[usize] = if ball[row] == 1 { &[0, 2] } else { &[1] };
        let holds = |run: &usize| alike.iter().any(|&place| bins[place][*run] == bin[row]);
        assert_eq!((0..equilibria.num_rows()).filter(holds).count() as u64, runs[row]);
    }
    let block = "model: {kind: block_on_spring}\n";
    let scratch = Scratch::new();
    scratch.write("a.yaml", study_text("a", "{monte_carlo: {samples: 3}}", AT_ONCE, block));
    scratch.well("run a.yaml --out out");
    assert_eq!(scratch.table("out", "density").num_rows(), 0);
}
