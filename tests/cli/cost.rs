//! The cost that `check` predicts, against the steps that runs take.

use super::support::{Scratch, assert_has, counts, study_text};
use crate::support::cases;

/// Returns the steps of all runs of a study without and with switches, and the estimate and the
/// limit that `check` prints.
fn steps(rest: &str, end_time_s: f64, samples: u64) -> [f64; 4] {
    let design = format!("{{monte_carlo: {{samples: {samples}}}}}");
    let scratch = Scratch::with(study_text("a", &design, end_time_s, rest));
    let report = scratch.json("check a.yaml --json");
    let said = |key: &str| report[key].as_f64().unwrap();
    scratch.stickslip("run a.yaml --out out");
    let runs = scratch.table("out", "runs");
    assert_eq!(runs.num_rows() as u64, samples);
    let sum = |name: &str| counts(&runs, name).iter().sum::<u64>() as f64;
    let steps = sum("steps") + sum("rejected_steps");
    assert!(said("core_seconds") > 0.0 && said("most_core_seconds") > said("core_seconds"));
    [steps, steps + sum("switches"), said("steps"), said("most_steps")]
}

/// With little damping and a fast disc every ball sticks and slips twice a turn, which accounts for
/// most of the steps.
#[test]
fn weakly_damped_runs_take_the_predicted_steps() {
    for balls in [1, 2, 4, 8] {
        let stribeck = "{stribeck: {static_friction_coefficient: 3e-3, stribeck_speed_rad_s: 1}}";
        for (law, samples) in [("coulomb", 8), (stribeck, 2)] {
            let model = format!(
                "model: {{kind: ball_balancer, friction: {law}, \
                 parameters: {{balls: {balls}, speed_rad_s: 628, damping_n_s_m: 0.01}}}}\n"
            );
            let [taken, with_switches, about, most] = steps(&model, 2.0, samples);
            let part = taken / about;
            assert!((0.5..1.25).contains(&part), "{balls} balls, {law}: {part}");
            assert!(with_switches <= most, "{balls} balls, {law}: {with_switches} of {most}");
        }
    }
}

/// Each row of a table of speeds is a stage, which takes a step.
#[test]
fn tables_of_speeds_take_the_predicted_steps() {
    let row = |row: u32| format!("[{row}e-3, {}]", -50.0 - 0.02 * f64::from(row));
    let rows: Vec<String> = (0..=10_000).map(row).collect();
    let profile =
        format!("{{table: {{columns: [time_s, speed_rad_s], rows: [{}]}}}}", rows.join(", "));
    let model = format!("model: {{kind: ball_balancer, speed_profile: [{profile}]}}\n");
    let [taken, with_switches, about, most] = steps(&model, 11.0, 2);
    let part = taken / about;
    assert!((0.5..1.25).contains(&part) && with_switches <= most, "{part}");
}

#[test]
fn no_run_exceeds_the_predicted_limit() {
    for [model, end_time] in cases(
        r"model: {kind: ball_balancer, parameters: {ball_diameter_m: 1.0e9}}\n ¦ 1.0
model: {kind: ball_balancer, parameters: {speed_rad_s: -216, friction_coefficient: 2.75e-4}}\n ¦ 5.0
model: {kind: ball_balancer, friction: {smooth: {smoothing_speed_rad_s: 0.01}}}\n ¦ 0.5
model: {kind: block_on_belt, parameters: {belt_speed_m_s: 0.1}}\n ¦ 100.0
model: {kind: block_on_spring, friction: {viscous: {viscous_coefficient_n_s_m: 0}}}\n ¦ 1e10
model: {kind: ball_balancer, parameters: {speed_rad_s: -1.8e6, friction_coefficient: 1e-5}}\n ¦ 2e-3",
    ) {
        let [taken, with_switches, about, most] =
            steps(&model, end_time.parse().expect("a time"), 4);
        assert!(with_switches <= most, "{model}{with_switches} of {most}");
        // Only runs that are given up exceed the estimate.
        assert!(taken <= 1.25 * about || model.contains("1.0e9"), "{model}{taken}, about {about}");
    }
}

#[test]
fn a_cost_beyond_a_lifetime_is_not_counted_in_days() {
    let scratch = Scratch::new();
    let cost = |end_time_s: f64, samples: u64| {
        let design = format!("{{monte_carlo: {{samples: {samples}}}}}");
        scratch.write("a.yaml", study_text("a", &design, end_time_s, ""));
        let said = scratch.well("check a.yaml");
        assert!(said.lines().all(|line| line.len() < 200), "{said}");
        said.lines().find(|line| line.starts_with("cost ")).unwrap().to_owned()
    };
    assert_has(&cost(16.5, 1_000_000_000), &[" days on one core"]);
    let many = cost(16.5, 100_000_000_000_000);
    assert_has(&many, &["  more than 100 years on one core,", "; no bound below 100 years"]);
    // Each of these runs is given up after a second.
    let long = cost(1e150, 4);
    assert_has(&long, &["  about ", "; at most ", ", if every run reaches its step limit"]);
    assert!(!long.contains("years"), "{long}");
}
