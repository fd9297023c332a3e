//! Preferred equilibria: `equilibrium_histogram.parquet`.

use std::collections::BTreeMap;

use arrow::array::RecordBatch;
use stickslip::analysis::{bin_edges, wilson};

use super::contract::{columns, listed};
use crate::cli::support::{AT_ONCE, Scratch, counts, numbers, study_text};

fn all(table: &RecordBatch, name: &str) -> Vec<f64> {
    numbers(table, name).into_iter().map(|number| number.expect("a number")).collect()
}

/// The histogram's rows count the equilibria by point and bins.
#[test]
fn bins_count_the_equilibria() {
    let sweep = "sweep: [{grid: {speed_rad_s: [-160.0, -216.0]}}]\n";
    let scratch = Scratch::ran(study_text("a", "{monte_carlo: {samples: 100}}", 8.0, sweep));
    let [equilibria, histogram] =
        ["equilibria", "equilibrium_histogram"].map(|name| scratch.table("out", name));
    let expected = listed(
        "point_id c -, speed_rad_s n rad/s, bin_1 c -, beta_1_from_rad n rad, beta_1_to_rad n rad, \
         bin_2 c -, beta_2_from_rad n rad, beta_2_to_rad n rad, runs c -, fraction n 1, \
         ci_low n 1, ci_high n 1",
    );
    assert_eq!(columns(&histogram), expected);
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
    assert!(seen.len() > 20, "the study is too small");
    let counted: BTreeMap<[u64; 3], u64> =
        key(&histogram).into_iter().zip(counts(&histogram, "runs")).collect();
    assert_eq!(counted, seen);
    let points = scratch.table("out", "points");
    let at_rest = counts(&points, "equilibrium_runs");
    let [fraction, low, high, from] =
        ["fraction", "ci_low", "ci_high", "beta_1_from_rad"].map(|name| all(&histogram, name));
    for (row, (key, runs)) in counted.iter().enumerate() {
        let of_point = at_rest[key[0] as usize];
        assert_eq!(fraction[row], *runs as f64 / of_point as f64);
        assert_eq!((low[row], high[row]), wilson(*runs, of_point, stickslip::analysis::Z_95));
        assert_eq!(from[row], bin_edges(key[1] as usize)[0]);
    }
}

/// Three or more balls have histograms of one angle, by identical balls; a block has none.
#[test]
fn other_numbers_of_balls_have_their_histograms() {
    let model = "model: {kind: ball_balancer, parameters: {balls: [{mass_kg: 1.4e-4}, \
                 {mass_kg: 1.0e-4}, {mass_kg: 1.4e-4}]}}\n\
                 sweep: [{grid: {speed_rad_s: [-160.0]}}]\n";
    let scratch = Scratch::ran(study_text("a", "{monte_carlo: {samples: 30}}", 8.0, model));
    let [equilibria, histogram] =
        ["equilibria", "equilibrium_histogram"].map(|name| scratch.table("out", name));
    let expected = listed(
        "point_id c -, speed_rad_s n rad/s, ball c -, bin_1 c -, beta_1_from_rad n rad, \
         beta_1_to_rad n rad, runs c -, fraction n 1, ci_low n 1, ci_high n 1",
    );
    assert_eq!(columns(&histogram), expected);
    let bins = [1, 2, 3].map(|ball| counts(&equilibria, &format!("bin_{ball}")));
    let (ball, bin, runs) =
        (counts(&histogram, "ball"), counts(&histogram, "bin_1"), counts(&histogram, "runs"));
    assert!(equilibria.num_rows() > 5, "the study is too small");
    for row in 0..histogram.num_rows() {
        let alike: &[usize] = if ball[row] == 1 { &[0, 2] } else { &[1] };
        let holds = |run: &usize| alike.iter().any(|&place| bins[place][*run] == bin[row]);
        assert_eq!((0..equilibria.num_rows()).filter(holds).count() as u64, runs[row]);
    }
    let block = "model: {kind: block_on_spring}\n";
    let scratch = Scratch::ran(study_text("a", "{monte_carlo: {samples: 3}}", AT_ONCE, block));
    assert_eq!(scratch.table("out", "equilibrium_histogram").num_rows(), 0);
}
