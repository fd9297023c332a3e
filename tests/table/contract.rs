//! Names, order, types, units and descriptions of columns. Readers rely on them: a change here
//! breaks user code and must be announced.

use arrow::array::RecordBatch;
use arrow::datatypes::DataType;

use crate::cli::support::{AT_ONCE, Scratch, counts, numbers, study_text, words};

const REST: &str = "sweep:\n\
                    \x20 - grid: {speed_rad_s: [-160.0], normal_force: [lagrange, newton]}\n\
                    uncertain: {ball_mass_2_kg: {uniform: {min: 1.3e-4, max: 1.5e-4}}}\n";

/// Returns name, type and unit of every column; `n` is a number, `l` a list of numbers, `c` a
/// count, `s` a small count, `i` a signed integer, `b` a boolean, `w` an enumerated word, `t` text.
pub fn columns(table: &RecordBatch) -> Vec<String> {
    let schema = table.schema();
    let describe = |field: &arrow::datatypes::FieldRef| {
        let kind = match field.data_type() {
            DataType::Float64 => "n",
            DataType::List(item) if *item.data_type() == DataType::Float64 => "l",
            DataType::Int32 => "i",
            DataType::UInt64 => "c",
            DataType::UInt8 => "s",
            DataType::Boolean => "b",
            DataType::Utf8 => "t",
            DataType::Dictionary(_, words) if **words == DataType::Utf8 => "w",
            other => panic!("{}: {other}", field.name()),
        };
        let unit = field.metadata().get("unit").map_or("-", String::as_str);
        let meaning = field.metadata().get("meaning").map_or("", String::as_str);
        assert!(meaning.len() > 5, "{} has no meaning", field.name());
        assert_eq!("nl".contains(kind), unit != "-", "{} has the unit {unit}", field.name());
        format!("{} {kind} {unit}", field.name())
    };
    schema.fields().iter().map(describe).collect()
}

/// Returns names that `, ` separates.
pub fn listed(names: &str) -> Vec<String> {
    names.split(", ").map(str::to_owned).collect()
}

const NON_DIMENSIONAL: &str = "n 1 (non-dimensional)";

#[test]
fn runs_and_points() {
    let scratch = Scratch::ran(study_text("a", "{monte_carlo: {samples: 5}}", AT_ONCE, REST));
    let start = |name: &str| format!("{name} {NON_DIMENSIONAL}");
    let mut expected = listed(
        "run_id c -, point_id c -, cell c -, replicate c -, speed_rad_s n rad/s, normal_force w -, \
         ball_mass_2_kg n kg",
    );
    expected.extend(["initial_x", "initial_y"].map(start));
    expected.extend(listed("initial_beta_1 n rad, initial_beta_2 n rad"));
    expected.extend(
        ["initial_x_dot", "initial_y_dot", "initial_beta_dot_1", "initial_beta_dot_2"].map(start),
    );
    expected.extend(listed(
        "label w -, evidence w -, balls_running s -, time_to_rest_s n s, end_time_s n s, \
         extended b -, beta_1_rad n rad, beta_2_rad n rad, amplitude_m n m, \
         relative_amplitude n 1, friction_margin n 1, period_s n s, cycle_class t -, \
         largest_multiplier n 1, neutral_directions s -, ball_speed_1_rad_s n rad/s, \
         ball_speed_2_rad_s n rad/s, lyapunov_exponent_per_s n 1/s, \
         lyapunov_exponent_low_per_s n 1/s, lyapunov_exponent_high_per_s n 1/s, \
         lyapunov_window_s n s, lyapunov_blocks c -, steps c -, rejected_steps c -, switches c -, \
         error t -, audit_label w -, audit_evidence w -",
    ));
    assert_eq!(columns(&scratch.table("out", "runs")), expected);
    points(&scratch);
}

/// A parameter that is swept and sampled by a factor has two columns for runs: the value of the run
/// under its own name, and the swept one as the nominal one. Points have only the swept one, under
/// its own name.
#[test]
fn a_parameter_that_is_swept_and_drawn() {
    let rest = "sweep: [{grid: {friction_coefficient: [2.0e-3, 4.0e-3]}}]\n\
                uncertain: {friction_coefficient: {times: {uniform: {min: 0.5, max: 1.5}}}}\n";
    let scratch = Scratch::ran(study_text("a", "{monte_carlo: {samples: 20}}", 5.0, rest));
    let [runs, points, equilibria] =
        ["runs", "points", "equilibria"].map(|name| scratch.table("out", name));
    let named = |table: &RecordBatch| -> Vec<String> {
        let mut names = columns(table);
        names.retain(|name| name.contains("friction_coefficient"));
        names
    };
    let both = ["nominal_friction_coefficient n 1", "friction_coefficient n 1"];
    assert_eq!(named(&runs), both);
    assert_eq!(named(&equilibria), both);
    assert_eq!(named(&points), ["friction_coefficient n 1"]);
    let swept = numbers(&points, "friction_coefficient");
    assert_eq!(swept, [Some(2.0e-3), Some(4.0e-3)]);
    for table in [&runs, &equilibria] {
        let [nominal, drawn] = ["nominal_friction_coefficient", "friction_coefficient"]
            .map(|name| numbers(table, name));
        assert!(table.num_rows() > 1);
        for ((nominal, drawn), point) in nominal.iter().zip(drawn).zip(counts(table, "point_id")) {
            assert_eq!(*nominal, swept[point as usize]);
            let factor = drawn.unwrap() / nominal.unwrap();
            assert!((0.5..1.5).contains(&factor) && factor != 1.0, "{factor}");
        }
    }
    let plan = scratch.well("expand a.yaml");
    let header = plan.lines().next().unwrap();
    assert_eq!(header.matches("nominal_friction_coefficient").count(), 1);
    assert_eq!(header.matches("friction_coefficient").count(), 2);
    let replayed = scratch.json("replay out 3 --json --out replayed");
    assert_eq!(replayed["differences"], serde_json::json!([]), "{replayed:#}");
    for command in ["report out", "summary out"] {
        scratch.well(command);
    }
}

fn points(scratch: &Scratch) {
    let expected = listed(
        "point_id c -, speed_rad_s n rad/s, normal_force w -, runs c -, equilibrium_runs c -, \
         limit_cycle_runs c -, periodic_runs c -, creep_runs c -, quasi_periodic_runs c -, irregular_runs c -, \
         undecided_runs c -, failed_runs c -, equilibrium_fraction n 1, ci_low n 1, ci_high n 1, \
         ci_method w -, equilibrium_low n 1, equilibrium_high n 1, limit_cycle_low n 1, \
         limit_cycle_high n 1, periodic_low n 1, periodic_high n 1, creep_low n 1, creep_high n 1, quasi_periodic_low n 1, \
         quasi_periodic_high n 1, irregular_low n 1, irregular_high n 1, undecided_low n 1, \
         undecided_high n 1, failed_low n 1, failed_high n 1, time_to_rest_p25_s n s, \
         time_to_rest_p50_s n s, time_to_rest_p75_s n s, time_to_rest_p95_s n s, \
         time_to_rest_p50_low_s n s, time_to_rest_p50_high_s n s, escape_rate_per_s n 1/s, \
         escape_rate_low_per_s n 1/s, escape_rate_high_per_s n 1/s, escape_from_s n s, \
         amplitude_p05_m n m, amplitude_p50_m n m, amplitude_p95_m n m, amplitude_p05_low_m n m, \
         amplitude_p05_high_m n m, amplitude_p50_low_m n m, amplitude_p50_high_m n m, \
         amplitude_p95_low_m n m, amplitude_p95_high_m n m, basin_entropy n 1, \
         precision_reached b -, audited_runs c -, audit_flips c -, audit_rest_flips c -, \
         audit_flip_rate n 1, audit_flip_low n 1, audit_flip_high n 1, \
         amplitude_without_balls_m n m, set_fraction n 1, uniqueness w -, min_principal_minor n 1, \
         worse_than_without_balls_fraction n 1, worse_than_without_balls_low n 1, \
         worse_than_without_balls_high n 1, relative_amplitude_p05 n 1, \
         relative_amplitude_p50 n 1, relative_amplitude_p95 n 1, \
         balance_quality_grade_p50_mm_s n mm/s, balance_quality_grade_p95_mm_s n mm/s, \
         overlapping_rest_fraction n 1",
    );
    let points = scratch.table("out", "points");
    assert_eq!(columns(&points), expected);
    assert_eq!(counts(&points, "point_id"), [0, 1]);
    assert_eq!(counts(&points, "runs"), [5, 5]);
    let words: Vec<String> = words(&points, "normal_force").into_iter().flatten().collect();
    assert_eq!(words, ["lagrange", "newton"]);
}

/// The curve of each point counts all of its runs, and its numbers are those of `points.parquet`.
#[test]
fn rest() {
    let rest = "sweep: [{grid: {speed_rad_s: [-160.0, -216.0]}}]\n";
    let scratch = Scratch::ran(study_text("a", "{monte_carlo: {samples: 40}}", 5.0, rest));
    let rest = scratch.table("out", "time_to_rest");
    let expected = listed(
        "point_id c -, speed_rad_s n rad/s, time_s n s, at_risk c -, came_to_rest c -, \
         censored c -, probability_at_rest n 1, ci_low n 1, ci_high n 1",
    );
    assert_eq!(columns(&rest), expected);
    let [point, at_risk, rests, censored] =
        ["point_id", "at_risk", "came_to_rest", "censored"].map(|name| counts(&rest, name));
    let [time, probability, low, high] = ["time_s", "probability_at_rest", "ci_low", "ci_high"]
        .map(|name| numbers(&rest, name).into_iter().map(Option::unwrap).collect::<Vec<f64>>());
    let points = scratch.table("out", "points");
    for id in [0, 1] {
        let rows: Vec<usize> = (0..point.len()).filter(|&row| point[row] == id).collect();
        let mut left = 40;
        let mut moving = 1.0;
        for &row in &rows {
            assert_eq!(at_risk[row], left);
            moving *= 1.0 - rests[row] as f64 / at_risk[row] as f64;
            assert!((1.0 - moving - probability[row]).abs() < 1e-12);
            assert!(low[row] <= probability[row] && probability[row] <= high[row]);
            left -= rests[row] + censored[row];
        }
        assert_eq!((time[rows[0]], left), (0.0, 0));
        assert!(rows.windows(2).all(|pair| time[pair[0]] < time[pair[1]]));
        let at_rest: u64 = rows.iter().map(|&row| rests[row]).sum();
        assert_eq!(at_rest, counts(&points, "equilibrium_runs")[id as usize]);
        let first = |curve: &[f64]| {
            rows.iter().find(|&&row| curve[row] >= 0.5 - 1e-12).map(|&row| time[row])
        };
        for (name, curve) in [
            ("time_to_rest_p50_s", &probability),
            ("time_to_rest_p50_low_s", &high),
            ("time_to_rest_p50_high_s", &low),
        ] {
            assert_eq!(numbers(&points, name)[id as usize], first(curve), "{name}");
        }
    }
    assert!(counts(&points, "equilibrium_runs")[0] > 5, "the study is too small");
}

/// Identical balls are interchangeable: their angles are sorted in equilibria.
#[test]
fn equilibria_of_identical_balls_are_sorted() {
    let scratch = Scratch::ran(study_text("a", "{monte_carlo: {samples: 40}}", 5.0, ""));
    let (runs, equilibria) = (scratch.table("out", "runs"), scratch.table("out", "equilibria"));
    let expected = listed(
        "run_id c -, point_id c -, beta_1_rad n rad, beta_2_rad n rad, amplitude_m n m, \
         friction_margin n 1, time_to_rest_s n s, evidence w -, bin_1 c -, bin_2 c -, \
         balance_quality_grade_mm_s n mm/s, overlapping b -",
    );
    assert_eq!(columns(&equilibria), expected);
    let angles = |table: &RecordBatch| -> Vec<(f64, f64)> {
        let [first, second] = ["beta_1_rad", "beta_2_rad"].map(|name| numbers(table, name));
        first.into_iter().zip(second).map(|(a, b)| (a.unwrap(), b.unwrap())).collect()
    };
    let (all, sorted) = (angles(&runs), angles(&equilibria));
    let ids = counts(&equilibria, "run_id");
    let at_rest: Vec<u64> = (0..40)
        .filter(|&run| words(&runs, "label")[run as usize].as_deref() == Some("equilibrium"))
        .collect();
    assert_eq!(ids, at_rest);
    let mut exchanged = 0;
    for (&run, &(low, high)) in ids.iter().zip(&sorted) {
        let (first, second) = all[run as usize];
        assert_eq!((low, high), (first.min(second), first.max(second)));
        assert!(low >= 0.0 && high < std::f64::consts::TAU);
        exchanged += usize::from(first > second);
    }
    assert!(exchanged > 0, "the study is too small");
}

#[test]
fn equilibria_of_balls_that_differ_keep_their_places() {
    let model = "model: {kind: ball_balancer, parameters: {speed_rad_s: -160.0, \
                 balls: [{mass_kg: 1.3e-4}, {mass_kg: 1.5e-4}]}}\n";
    let scratch = Scratch::ran(study_text("a", "{monte_carlo: {samples: 20}}", 8.0, model));
    let (runs, equilibria) = (scratch.table("out", "runs"), scratch.table("out", "equilibria"));
    let ids = counts(&equilibria, "run_id");
    assert!(ids.len() > 5);
    for name in ["beta_1_rad", "beta_2_rad"] {
        let all = numbers(&runs, name);
        let kept: Vec<Option<f64>> = ids.iter().map(|&run| all[run as usize]).collect();
        assert_eq!(numbers(&equilibria, name), kept);
    }
}
