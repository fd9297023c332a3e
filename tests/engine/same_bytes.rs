//! Data files do not depend on the distribution of the work, byte for byte.

use crate::cli::support::{AT_ONCE, DATA_FILES, Scratch, study_text};

/// Designs, end times, further lines, exit codes, and the ways to run each study.
const STUDIES: [(&str, f64, &str, i32, &[&str]); 5] = [
    // Runs of all lengths: at rest early, late and never, with some failures.
    (
        "{latin_hypercube: {samples: 24}}",
        5.0,
        "sweep: [{grid: {speed_rad_s: [-160.8103, -216.3772]}}]\n\
         uncertain: {ball_mass_kg: {normal: {mean: 1.4e-4, std_dev: 1.0e-4}}}\n",
        3,
        &[
            "--threads 1",
            "--threads 2",
            "--threads 7",
            "--threads 1 --chunk 1",
            "--threads 2 --chunk 5",
            "--threads 7 --chunk 5",
            "--threads 7 --chunk 1",
            "--threads 2 --chunk 1024",
        ],
    ),
    // Limit cycles, with every run on the same one.
    (
        "{monte_carlo: {samples: 700}}",
        20.0,
        "model: {kind: block_on_belt, friction: {stribeck: {static_friction_coefficient: 0.2, stribeck_speed_m_s: 0}}}\n\
         sweep: [{grid: {belt_speed_m_s: [0.1, 0.2]}}]\n",
        0,
        &["--threads 1", "--threads 7 --chunk 5", "--threads 2 --chunk 333"],
    ),
    // Some runs fail at once: with Newton's normal force a ball would leave the ring. More rows than are written at a time
    // (4096) and than one row group has (32768).
    (
        "{monte_carlo: {samples: 9000}}",
        AT_ONCE,
        "sweep: [{grid: {speed_rad_s: [-160.0, -170.0], normal_force: [newton, lagrange]}}]\n",
        3,
        &["--threads 1", "--threads 7 --chunk 777", "--threads 2 --chunk 4096"],
    ),
    // The number of runs depends on their endings, not on the distribution of the work.
    (
        "{monte_carlo: {samples: 16}}",
        4.0,
        "sweep:\n\
         \x20 - grid: {speed_rad_s: [-160.8103, -216.3772]}\n\
         \x20 - {grid: {speed_rad_s: [-191.6372]}, design: {sobol: {samples: 7}}}\n\
         precision: {equilibrium_fraction: 0.09, max_runs: 100}\naudit: {fraction: 0.2}\n",
        0,
        &["--threads 1", "--threads 3", "--threads 3 --chunk 1", "--threads 1 --chunk 5"],
    ),
    // Points with different numbers of balls.
    (
        "{stratified: {parts_per_axis: 2, samples_per_cell: 1}}",
        0.3,
        "sweep: [{grid: {speed_rad_s: [-160.8103, -216.3772], balls: [2, 1]}}]\naudit: {fraction: 0.1}\n",
        0,
        &["--threads 1", "--threads 3 --chunk 7"],
    ),
];

/// Runs a study in these ways and compares all data files with those of the first.
fn same_bytes(text: &str, code: i32, ways: &[&str]) {
    let scratch = Scratch::with(text);
    let mut first: Option<Vec<Vec<u8>>> = None;
    for (index, way) in ways.iter().enumerate() {
        let out = format!("out-{index}");
        scratch.ended(&format!("run a.yaml --out {out} {way}"), code);
        let found = scratch.data(&out);
        let expected = first.get_or_insert_with(|| found.clone());
        for ((name, found), expected) in DATA_FILES.iter().zip(&found).zip(&*expected) {
            assert!(found == expected, "{name} differs with {way}");
        }
    }
}

#[test]
fn for_any_number_of_threads_and_any_chunk() {
    for (design, end_time_s, rest, code, ways) in STUDIES {
        same_bytes(&study_text("a", design, end_time_s, rest), code, ways);
    }
}

/// Some runs are continued past the end time, some have ended before.
#[test]
fn for_runs_that_are_continued() {
    let text = study_text("a", "{latin_hypercube: {samples: 24}}", 3.0, "");
    let text = text.replace("end_time_s: 3e0", "end_time_s: 3, extend: {factor: 2.5}");
    same_bytes(
        &text,
        0,
        &["--threads 1", "--threads 2 --chunk 5", "--threads 7 --chunk 1", "--threads 2"],
    );
}
