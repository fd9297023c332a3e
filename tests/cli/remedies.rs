//! What the table of points says below its rows: remedies, caveats of columns, and short numbers.

use super::support::{AT_ONCE, Scratch, assert_has};

/// Returns a study whose balls start near the imbalance.
fn study(end_time_s: f64, rest: &str) -> String {
    format!(
        "schema: 1\nname: a\nseed: 5\nmodel: {{kind: ball_balancer}}\n\
         initial_conditions:\n  box: {{x: [0, 0.01], y: [0, 0.01], beta: [0, 0.4], x_dot: [0, 0.01], y_dot: [0, 0.01], \
         beta_dot: [0, 0.01]}}\n  design: {{monte_carlo: {{samples: 8}}}}\n\
         simulation: {{end_time_s: {end_time_s:e}}}\n{rest}"
    )
}

/// Points at which most runs vibrate more than without balls have a remedy where closed forms show one.
#[test]
fn points_that_vibrate_more_have_a_remedy() {
    let sweep = "sweep:\n  - zip:\n      speed_rad_s: [-160.8, -216.4, -216.4]\n      \
                 friction_coefficient: [2.75e-3, 0.05, 0.05]\n      \
                 imbalance_mass_kg: [5.6e-5, 5.6e-5, 1.0e-4]\n";
    let scratch = Scratch::with(study(6.0, sweep));
    let printed = scratch.well("run a.yaml --out out");
    let remedy = "Remedy: a speed above the natural frequency (point 0); heavier balls or a larger ring, to balance the \
                  imbalance (point 2); less friction, which holds the balls in every position (point 1); see \
                  `stickslip check`.\n";
    assert_has(&printed, &["At 3 of 3 points most runs vibrate more", remedy]);
    scratch.prints("summary out", &[remedy]);
    scratch.prints("summary out --format markdown", &[remedy]);
    let held = "sweep: [{zip: {friction_coefficient: [0.05]}}]\n";
    scratch.write("b.yaml", study(6.0, held));
    let remedy =
        "Remedy: less friction, which holds the balls in every position; see `stickslip check`.\n";
    scratch.prints("run b.yaml --out b", &["0.0 % of the runs vibrate less", remedy]);
}

/// Many undecided runs need more time, unless the study looks for rests only.
#[test]
fn undecided_runs_need_more_time() {
    let study = study(AT_ONCE, "");
    let scratch = Scratch::with(&study);
    let line = "8 of 8 runs are undecided; a larger simulation.end_time_s or simulation.extend decides more.\n";
    scratch.prints("run a.yaml --out a", &[line]);
    let rests = study.replace("simulation: {", "simulation: {endings: rest, ");
    scratch.write("b.yaml", rests);
    let printed = scratch.well("run b.yaml --out b");
    assert!(!printed.contains("are undecided"), "{printed}");
}

/// The column `no balls` is a median over the runs; a line says so if the draws change this amplitude.
#[test]
fn draws_of_the_machine_without_balls_are_explained() {
    let scratch = Scratch::new();
    for (name, parameter, expected) in [
        ("a", "imbalance_mass_kg: {uniform: {min: 5.0e-5, max: 6.0e-5}}", true),
        ("b", "friction_coefficient: {uniform: {min: 1.0e-3, max: 2.0e-3}}", false),
    ] {
        let file = format!("{name}.yaml");
        scratch.write(&file, study(AT_ONCE, &format!("uncertain: {{{parameter}}}\n")));
        let printed = scratch.well(&format!("run {file} --out {name}"));
        let line = "The amplitude without balls is the median over the runs; `worse` compares each run with its own \
                    machine without balls.\n";
        assert_eq!(printed.contains(line), expected, "{printed}");
    }
}

/// Speeds from rpm have few digits on the terminal and in figures in rad/s, too, and all digits in JSON.
#[test]
fn swept_values_have_few_digits() {
    let scratch = Scratch::with(study(
        AT_ONCE,
        "sweep: [{grid: {speed: [2000 rpm, 3000 rpm]}}]\nunits: {speed: rad/s}\n",
    ));
    let ran = scratch.stickslip("run a.yaml --out out");
    for text in [scratch.well("check a.yaml"), ran.out, scratch.well("summary out")] {
        assert_has(&text, &["209.44", "314.159"]);
        assert!(!text.contains("314.1592"), "{text}");
    }
    assert!(!ran.err.contains("314.1592"), "{}", ran.err);
    let json = scratch.json("summary out --format json");
    assert_has(&json["points"][1]["speed_rad_s"].to_string(), &["314.159265358979"]);
    scratch.well("report out");
    let page = scratch.text("out-report.html");
    assert!(page.contains("314.159<"), "a short number in the table of the page");
}
