//! Exchanging two balls in the start state and in the machine exchanges the results, to the last
//! digit.

use crate::cli::support::{Scratch, numbers, parse, row, study_text, words};

/// Returns start states in the default box for runs that come to rest, keep running, and slip late.
fn starts() -> Vec<[f64; 8]> {
    let source = study_text("a", "{monte_carlo: {samples: 24}}", 5.0, "");
    let study = parse(&source);
    (0..study.run_count())
        .map(|run| study.planned_run(run).start.0.try_into().expect("two balls"))
        .collect()
}

/// Runs a study from a table of starts and returns the scratch directory with its results.
fn run(method: &str, starts: impl Iterator<Item = [f64; 8]>, rest: &str) -> Scratch {
    let scratch = Scratch::new();
    let mut table = "x,y,beta_1,beta_2,x_dot,y_dot,beta_dot_1,beta_dot_2\n".to_owned();
    for start in starts {
        let cells: Vec<String> = start.iter().map(|number| format!("{number:e}")).collect();
        table += &(cells.join(",") + "\n");
    }
    scratch.write("starts.csv", table);
    let text = study_text("a", "{table: starts.csv}", 5.0, rest);
    let simulation = format!("simulation: {{method: {method}, ");
    scratch.write("a.yaml", text.replace("simulation: {", &simulation));
    scratch.well("run a.yaml --out out");
    scratch
}

const OF_ONE_BALL: [&str; 8] = [
    "initial_beta_1",
    "initial_beta_2",
    "initial_beta_dot_1",
    "initial_beta_dot_2",
    "beta_1_rad",
    "beta_2_rad",
    "ball_speed_1_rad_s",
    "ball_speed_2_rad_s",
];

/// Returns a class of limit cycles with its balls in the opposite order.
fn reversed(class: &str) -> String {
    class.rsplit('|').collect::<Vec<_>>().join("|")
}

fn exchanged_gives_exchanged(method: &str, rest: &str, exchanged_rest: &str) {
    let starts = starts();
    let exchanged =
        starts.iter().map(|&[x, y, b1, b2, xd, yd, d1, d2]| [x, y, b2, b1, xd, yd, d2, d1]);
    let first = run(method, starts.iter().copied(), &format!("{rest}{SPEEDS}"));
    let other = run(method, exchanged, &format!("{exchanged_rest}{SPEEDS}"));
    let (runs, other) = (first.table("out", "runs"), other.table("out", "runs"));
    assert_eq!(runs.num_rows(), other.num_rows());
    for (first, second) in OF_ONE_BALL.iter().zip(OF_ONE_BALL.iter().skip(1)).step_by(2) {
        let exact = |numbers: Vec<Option<f64>>| -> Vec<Option<u64>> {
            numbers.into_iter().map(|number| number.map(f64::to_bits)).collect()
        };
        assert_eq!(exact(numbers(&runs, first)), exact(numbers(&other, second)), "{first}");
        assert_eq!(exact(numbers(&runs, second)), exact(numbers(&other, first)), "{second}");
    }
    // Identical balls have no order in a class; different balls have changed places there, too.
    let alike = rest == exchanged_rest;
    let classes = |table| words(table, "cycle_class").into_iter();
    let exchanged_class = |class: String| if alike { class } else { reversed(&class) };
    assert!(classes(&runs).eq(classes(&other).map(|class| class.map(exchanged_class))));
    // All other columns are equal: label, evidence, times, amplitude, steps, switches.
    let apart = [&OF_ONE_BALL[..], &["cycle_class"]].concat();
    for index in 0..runs.num_rows() {
        assert_eq!(row(&runs, index, &apart), row(&other, index, &apart), "run {index}");
    }
    let labels = words(&runs, "label");
    let at_rest = labels.iter().filter(|label| label.as_deref() == Some("equilibrium")).count();
    assert!(at_rest > 0 && at_rest < labels.len(), "{at_rest}: the study is too small");
}

const SPEEDS: &str = "sweep: [{grid: {speed_rad_s: [-160.8103, -191.6372, -216.3772]}}]\n";

#[test]
fn identical_balls_exchange_their_results() {
    for method in ["switch", "event"] {
        exchanged_gives_exchanged(method, "", "");
    }
}

#[test]
fn balls_that_differ_change_places_in_the_machine_too() {
    let balls = |first: &str, second: &str| {
        format!("model: {{kind: ball_balancer, parameters: {{balls: [{first}, {second}]}}}}\n")
    };
    let light = "{mass_kg: 1.2e-4, friction_coefficient: 2.0e-3}";
    let heavy = "{mass_kg: 1.6e-4, friction_coefficient: 3.0e-3, diameter_m: 3.2e-3}";
    for method in ["switch", "event"] {
        exchanged_gives_exchanged(method, &balls(light, heavy), &balls(heavy, light));
    }
}
