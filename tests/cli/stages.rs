//! Studies of a disc that starts and a table that is hit have the properties of others: nothing changes a byte.

use super::support::{Scratch, counts, numbers, words};

/// Returns a study of balls that touch, with a ramp, two hits in random directions, and this simulation.
fn study(simulation: &str) -> String {
    format!(
        "schema: 1\nname: stages\nseed: 5\n\
         model: {{kind: ball_balancer, contact: {{}}, protocol: {{startup_and_hammer: {{over_s: 0.4, wait_s: 0.5, hits: 2}}}}}}\n\
         sweep: [{{grid: {{speed_rad_s: [-150, -216], kick_speed_m_s: [0.01, 0.05]}}}}]\n\
         initial_conditions: {{design: {{monte_carlo: {{samples: 5}}}}}}\n{simulation}"
    )
}

/// Threads, chunks, interruptions and shards change no byte.
#[test]
fn tables_do_not_depend_on_how_runs_are_computed() {
    let scratch = Scratch::with(study(""));
    scratch.well("run a.yaml --out whole --threads 1");
    let whole = scratch.data("whole");
    scratch.well("run a.yaml --out chunks --threads 2 --chunk 3");
    assert_eq!(scratch.data("chunks"), whole);
    scratch.ended("run a.yaml --out stopped --chunk 2 --max-seconds 0", 130);
    scratch.well("resume stopped --threads 2");
    assert_eq!(scratch.data("stopped"), whole);
    for part in [1, 2, 3] {
        scratch.well(&format!("run a.yaml --shard {part}/3 --out part-{part}"));
    }
    scratch.well("merge part-3 part-1 part-2 --out merged");
    assert_eq!(scratch.data("merged"), whole);

    // Each run has four stages: the ramp, and the times before, between and after the hits.
    let stages = scratch.table("whole", "stages");
    assert_eq!(stages.num_rows(), 4 * 20);
    let ends = numbers(&stages, "end_s");
    let lasts: Vec<f64> = ends.chunks(4).filter_map(|of_run| of_run[3]).collect();
    assert!(lasts.iter().all(|end| *end > 1.4 && *end <= 1.9 + 1e-12), "{lasts:?}");
    let rows = scratch.table("whole", "runs");
    assert!(counts(&rows, "impacts").iter().any(|impacts| *impacts > 0));
    assert!(words(&rows, "error").iter().all(Option::is_none));
}

/// A continued run is that of a study with the later end.
#[test]
fn continued_runs_are_longer_runs() {
    let scratch = Scratch::new();
    let without_hits = |simulation: &str| {
        let study = study(simulation);
        let hits = "{startup_and_hammer: {over_s: 0.4, wait_s: 0.5, hits: 2}}";
        let study = study.replace(hits, "{startup: {over_s: 0.4}}");
        study.replace(", kick_speed_m_s: [0.01, 0.05]", "")
    };
    let extended = "simulation: {end_time_s: 1, extend: {factor: 2, labels: [undecided]}}\n";
    scratch.write("short.yaml", without_hits(extended));
    scratch.write("long.yaml", without_hits("simulation: {end_time_s: 2}\n"));
    scratch.well("run short.yaml --out short");
    scratch.well("run long.yaml --out long");
    let [short, long] = ["short", "long"].map(|name| scratch.table(name, "runs"));
    for column in ["end_time_s", "beta_1_rad", "beta_2_rad", "amplitude_m", "peak_amplitude_m"] {
        assert_eq!(numbers(&short, column), numbers(&long, column), "{column}");
    }
    assert!(numbers(&long, "end_time_s").contains(&Some(2.0)));
    assert_eq!(words(&short, "label"), words(&long, "label"));
}
