//! The columns about what the balls leave, from the rows of `runs.parquet` and `equilibria.parquet`.

use arrow::array::AsArray;
use stickslip::analysis::{Z_95, wilson_with_failures};

use crate::cli::support::{Scratch, column, counts, numbers, study_text, words};

/// The thesis's machine, as in the defaults of a study.
const TABLE_KG: f64 = 0.324;
const STIFFNESS_N_M: f64 = 1.07e4;
const DAMPING_N_S_M: f64 = 1.28;
const RING_M: f64 = 1.15e-2;
const IMBALANCE_RADIUS_M: f64 = 3.7e-2;
const BALL_DIAMETER_M: f64 = 3e-3;

/// Two speeds; each run has its own imbalance, and some masses of balls are negative.
fn results() -> Scratch {
    let rest = "sweep: [{grid: {speed_rad_s: [-160.8103, -216.3772]}}]\n\
                uncertain: {imbalance_mass_kg: {uniform: {min: 2.0e-5, max: 9.0e-5}}, \
                ball_mass_kg: {normal: {mean: 1.4e-4, std_dev: 1.0e-4}}}\n";
    let scratch = Scratch::with(study_text("a", "{monte_carlo: {samples: 40}}", 5.0, rest));
    assert_eq!(scratch.stickslip("run a.yaml --out out").code, Some(3));
    scratch
}

fn sorted(mut values: Vec<f64>) -> Vec<f64> {
    values.sort_by(f64::total_cmp);
    values
}

/// Quantile by linear interpolation between order statistics.
fn quantile(values: &[f64], fraction: f64) -> Option<f64> {
    let place = fraction * values.len().checked_sub(1)? as f64;
    let (low, high) = (values[place.floor() as usize], values[place.ceil() as usize]);
    Some(low + place.fract() * (high - low))
}

#[test]
fn columns_of_points_count_the_rows_of_runs_and_equilibria() {
    let scratch = results();
    let [runs, points, rests] =
        ["runs", "points", "equilibria"].map(|name| scratch.table("out", name));
    let of_runs = |name: &str| numbers(&runs, name);
    let [speed, imbalance, amplitude, relative] =
        ["speed_rad_s", "imbalance_mass_kg", "amplitude_m", "relative_amplitude"].map(of_runs);
    let label = words(&runs, "label");
    let (run_point, rest_point) = (counts(&runs, "point_id"), counts(&rests, "point_id"));
    let grade = numbers(&rests, "balance_quality_grade_mm_s");
    let overlapping = column(&rests, "overlapping").as_boolean().clone();
    let mut both = [0_u64; 2];
    for point in 0..2 {
        let (mut worse, mut compared, mut failed) = (0, 0, 0);
        let [mut alone, mut ratios] = [Vec::new(), Vec::new()];
        for row in (0..runs.num_rows()).filter(|&row| run_point[row] == point) {
            if label[row].as_deref() == Some("failed") {
                assert_eq!(relative[row], None);
                failed += 1;
                continue;
            }
            let (omega, imbalance) = (speed[row].unwrap(), imbalance[row].unwrap());
            let inertia = (TABLE_KG + imbalance) * omega * omega;
            let resistance = (STIFFNESS_N_M - inertia).hypot(DAMPING_N_S_M * omega);
            let without = imbalance * IMBALANCE_RADIUS_M * omega * omega / resistance;
            compared += 1;
            worse += u64::from(amplitude[row].unwrap() > without);
            assert_eq!(relative[row], Some(amplitude[row].unwrap() / without));
            alone.push(without);
            ratios.extend(relative[row]);
        }
        assert!(failed > 0 && compared > 10, "the study is too small");
        both[0] += worse;
        both[1] += compared - worse;
        let at = |name: &str| numbers(&points, name)[point as usize];
        let fraction = worse as f64 / compared as f64;
        assert_eq!(at("worse_than_without_balls_fraction"), Some(fraction));
        let ends = wilson_with_failures(worse, failed, compared + failed, Z_95);
        assert_eq!(at("worse_than_without_balls_low"), Some(ends.0));
        assert_eq!(at("worse_than_without_balls_high"), Some(ends.1));
        assert_eq!(at("amplitude_without_balls_m"), quantile(&sorted(alone), 0.5));
        let ratios = sorted(ratios);
        for (name, part) in [("p05", 0.05), ("p50", 0.5), ("p95", 0.95)] {
            assert_eq!(at(&format!("relative_amplitude_{name}")), quantile(&ratios, part));
        }

        let here: Vec<usize> =
            (0..rests.num_rows()).filter(|&row| rest_point[row] == point).collect();
        let grades = sorted(here.iter().map(|&row| grade[row].unwrap()).collect());
        assert_eq!(at("balance_quality_grade_p50_mm_s"), quantile(&grades, 0.5));
        assert_eq!(at("balance_quality_grade_p95_mm_s"), quantile(&grades, 0.95));
        let overlaps = here.iter().filter(|&&row| overlapping.value(row)).count();
        let fraction = (!here.is_empty()).then(|| overlaps as f64 / here.len() as f64);
        assert_eq!(at("overlapping_rest_fraction"), fraction);
    }
    assert!(both.iter().all(|&runs| runs > 0), "all runs are worse or none is: {both:?}");
}

/// The two sides of the polygon of unbalances, and the chord between the balls.
#[test]
fn columns_of_equilibria_follow_from_their_angles() {
    let rests = results().table("out", "equilibria");
    let of = |name: &str| -> Vec<f64> {
        numbers(&rests, name).into_iter().map(Option::unwrap).collect()
    };
    let [speed, imbalance, ball] = ["speed_rad_s", "imbalance_mass_kg", "ball_mass_kg"].map(of);
    let [first, second, grade] = ["beta_1_rad", "beta_2_rad", "balance_quality_grade_mm_s"].map(of);
    let overlapping = column(&rests, "overlapping").as_boolean();
    assert!(rests.num_rows() > 5, "the study is too small");
    for row in 0..rests.num_rows() {
        let along = imbalance[row] * IMBALANCE_RADIUS_M
            + ball[row] * RING_M * (first[row].cos() + second[row].cos());
        let across = ball[row] * RING_M * (first[row].sin() + second[row].sin());
        let mass = TABLE_KG + imbalance[row] + 2.0 * ball[row];
        let expected = 1e3 * along.hypot(across) / mass * speed[row].abs();
        assert!((grade[row] - expected).abs() < 1e-12 * (1.0 + expected), "row {row}");
        let apart =
            [first[row], second[row]].map(|beta| [RING_M * beta.cos(), RING_M * beta.sin()]);
        let distance = (apart[0][0] - apart[1][0]).hypot(apart[0][1] - apart[1][1]);
        assert_eq!(overlapping.value(row), distance < BALL_DIAMETER_M, "row {row}: {distance}");
    }
}
