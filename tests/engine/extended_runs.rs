//! Continued runs: their rows are those of the study with the longer end time.

use arrow::array::AsArray;

use crate::cli::support::{Scratch, assert_has, column, counts, numbers, row, study_text};

const BALLS: &str = "sweep: [{grid: {speed_rad_s: [-160.8103, -216.3772]}}]\n";
const BLOCK: &str = "model:\n  kind: block_on_belt\n\
                     \x20 friction: {stribeck: {static_friction_coefficient: 0.2, \
                     stribeck_speed_m_s: 0.05}}\n";

/// Runs a study to a short end time, with continuation by a factor, and to the long end time, and compares the rows.
fn three_ways(rest: &str, end_time_s: f64, factor: f64) -> Scratch {
    let scratch = Scratch::new();
    let text = |end_time_s| study_text("a", "{latin_hypercube: {samples: 24}}", end_time_s, rest);
    let short = text(end_time_s);
    let extend = format!("simulation: {{extend: {{factor: {factor}}}, ");
    let extended = short.replace("simulation: {", &extend);
    for (name, text) in
        [("short", short), ("extended", extended), ("long", text(factor * end_time_s))]
    {
        scratch.write(&format!("{name}.yaml"), text);
        scratch.well(&format!("run {name}.yaml --out {name}"));
    }
    let [short, extended, long] =
        ["short", "extended", "long"].map(|name| scratch.table(name, "runs"));
    let continued = column(&extended, "extended").as_boolean().values().clone();
    let runs = extended.num_rows();
    assert!(continued.count_set_bits() >= 5 && continued.count_set_bits() < runs);
    for run in 0..runs {
        let expected = if continued.value(run) { &long } else { &short };
        let cells = |table| row(table, run, &["extended"]);
        assert_eq!(cells(&extended), cells(expected));
    }
    for table in [&short, &long] {
        assert!(!column(table, "extended").as_boolean().has_true());
    }
    scratch
}

/// The rows are those of the longer or the shorter study. If every undecided run is continued, the point tables are those of
/// the longer study, byte for byte except for the study's identity, including runs that found their cycle late. Runs with
/// other labels are stopped, and censored, at the study's own end time.
#[test]
fn continued_runs_are_those_of_the_longer_study() {
    three_ways(BLOCK, 3.0, 2.0);
    let scratch = three_ways(BALLS, 3.0, 2.0);
    for name in ["points", "time_to_rest", "equilibria"] {
        let [extended, long] = ["extended", "long"].map(|way| scratch.table(way, name));
        assert_eq!(extended.columns(), long.columns(), "{name}");
    }
    let last = |directory: &str| {
        let rest = scratch.table(directory, "time_to_rest");
        let point = counts(&rest, "point_id");
        let rows = (0..rest.num_rows()).filter(|row| point[*row] == 1);
        let row = rows.max().expect("rows");
        (numbers(&rest, "time_s")[row], counts(&rest, "at_risk")[row])
    };
    let (time_s, moving) = last("extended");
    assert_eq!(time_s, Some(6.0));
    assert!(moving > 0 && moving < last("short").1);
    let text = scratch.text("extended.yaml");
    scratch.write("none.yaml", text.replace("factor: 2", "factor: 2, labels: [irregular]"));
    scratch.well("run none.yaml --out none");
    assert_eq!(last("none"), last("short"));
    let said = scratch.well("check none.yaml");
    assert_has(&said, &["each to 3 s (irregular runs to 6 s) or until"]);
    let said = scratch.well("check extended.yaml");
    assert_has(&said, &["each to 3 s (undecided and irregular runs to 6 s) or until"]);
    let cost = |name: &str| -> f64 {
        let report = scratch.json(&format!("check {name}.yaml --json"));
        report["core_seconds"].as_f64().expect("a cost")
    };
    assert_eq!(cost("extended"), cost("long"));
}
