//! Points that are sampled until their equilibrium fraction is known to the required precision.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use serde_json::Value;
use stickslip::analysis::{HalfWidths, PointAccumulator};
use stickslip::classification::{Evidence, Outcome, Rest};
use stickslip::model::Case;
use stickslip::study::Study;

use super::in_memory::{Kept, run_in_memory};
use crate::cli::support::{
    AT_ONCE, Scratch, assert_has, column, counts, names, parse, row, study_text, words,
};
use arrow::array::{AsArray, RecordBatch};

/// Two points of Monte Carlo samples and one of a stratified design, in a box of two directions.
const REST: &str = "sweep:\n\
                    \x20 - grid: {speed_rad_s: [-160.8103, -216.3772]}\n\
                    \x20 - grid: {speed_rad_s: [-191.6372]}\n\
                    \x20   design: {stratified: {parts_per_axis: 2, samples_per_cell: 3}}\n";

fn text(half_width: f64, max_runs: u64, end_time_s: f64) -> String {
    let fixed = "x: [0, 0], y: [0, 0], x_dot: [0, 0], y_dot: [0, 0], beta_2: [3, 3], \
                 beta_dot_2: [0, 0]";
    let precision =
        format!("precision: {{equilibrium_fraction: {half_width}, max_runs: {max_runs}}}\n");
    study_text("a", "{monte_carlo: {samples: 15}}", end_time_s, &format!("{REST}{precision}"))
        .replace("initial_conditions: {", &format!("initial_conditions: {{box: {{{fixed}}}, "))
}

/// Returns an outcome at rest if the first ball starts in a part of the ring that depends on the
/// speed.
fn by_place(case: &Case) -> Outcome {
    let speed = case.model.ball_balancer().expect("a balancer").speed_rad_s;
    let fraction = (-speed - 160.0) / 100.0;
    let rests = case.start.0[2] < fraction * std::f64::consts::TAU;
    let rest = Evidence::RestCertified(Rest::default());
    Outcome::of(if rests { rest } else { Evidence::EndTime })
}

fn sampled(study: &Study, simulate: impl Fn(&Case) -> Outcome + Sync) -> Kept {
    let mut kept = Kept::default();
    let totals = run_in_memory(study, &mut kept, &AtomicBool::new(false), simulate)
        .expect("nothing can fail in memory");
    assert!(!totals.interrupted());
    assert_eq!(totals.counts.total(), kept.runs.len() as u64);
    kept
}

/// The runs of each point are those that the rules request for their labels and amplitudes, with consecutive numbers from the
/// point's first. The amplitude is uniform from 0 to 1 µm: about 100 runs give its median to 0.1 µm, and the fraction needs
/// others.
#[test]
fn points_stop_where_the_rules_stop() {
    let simulated = |case: &Case| {
        let amplitude_m = Some(1e-6 * case.start.0[2] / std::f64::consts::TAU);
        Outcome { amplitude_m, ..by_place(case) }
    };
    let mut totals = Vec::new();
    for (keys, max_runs) in [
        ("equilibrium_fraction: 0.2", 10_000),
        ("amplitude_p50_m: 1.0e-7", 10_000),
        ("equilibrium_fraction: 0.2, amplitude_p50: 0.1 µm", 10_000),
        ("equilibrium_fraction: 0.05", 10_000),
        ("equilibrium_fraction: 0.02", 1000),
        ("equilibrium_fraction: 0.02", 10),
    ] {
        let text = text(0.2, max_runs, AT_ONCE).replace("equilibrium_fraction: 0.2", keys);
        let study = parse(text);
        let limits = HalfWidths::from(study.precision().expect("a precision"));
        let kept = sampled(&study, simulated);
        assert_eq!(kept.points.len(), 3);
        for row in &kept.points {
            let point = study.point(row.point_id);
            let ends: Vec<_> =
                kept.runs.iter().filter(|run| run.planned.point_id == row.point_id).collect();
            let runs = ends.len() as u64;
            let ids = ends.iter().map(|run| run.planned.run_id);
            assert!(ids.eq(point.first_run..point.first_run + runs));
            let so_far = |runs: u64| {
                let mut so_far = PointAccumulator::new(point.cells);
                ends[..runs as usize].iter().for_each(|run| so_far.add(run.observed()));
                so_far
            };
            let (replicate, most) = (point.sampling.replicate, point.sampling.most);
            let mut expected = point.sampling.first;
            while let Some(more) = limits.more(replicate, most, expected, &so_far(expected)) {
                expected += more;
            }
            assert_eq!((runs, row.summary.counts.total()), (expected, expected), "{keys}");
            let narrow = limits.reached(&row.summary);
            assert!(narrow || runs == most && (most + replicate > max_runs), "{runs} of {most}");
        }
        totals.push(kept.runs.len());
    }
    println!("runs: {totals:?}");
    assert!(totals[0] < totals[1] && totals[2] >= totals[1], "{totals:?}");
    assert!(totals.iter().all(|total| *total > 3 * 12));
}

/// More runs and a narrower interval append runs to the existing ones, at every point.
#[test]
fn former_runs_are_kept() {
    let runs = |half_width, max_runs| {
        let kept = sampled(&parse(text(half_width, max_runs, AT_ONCE)), by_place);
        let mut points: BTreeMap<u64, Vec<_>> = BTreeMap::new();
        for record in kept.runs {
            let mut planned = record.planned;
            let (point, _) = (planned.point_id, std::mem::take(&mut planned.run_id));
            points.entry(point).or_default().push((planned, record.outcome));
        }
        points
    };
    let old = runs(0.06, 150);
    for (half_width, max_runs) in [(0.06, 400), (0.04, 150), (0.03, 3000)] {
        let new = runs(half_width, max_runs);
        let grown = old.iter().filter(|(point, old)| {
            let new = &new[point];
            assert_eq!(new[..old.len()], old[..]);
            new.len() > old.len()
        });
        let grown = grown.count();
        assert!(grown > 0 || max_runs == 150, "the study is too small");
    }
}

/// After an interruption in the second round of the second point, the finished runs are stored, the
/// first point is complete, and no point starts again.
#[test]
fn an_interruption_keeps_what_is_finished() {
    let study = parse(text(0.06, 150, AT_ONCE));
    let whole = sampled(&study, by_place);
    let first = whole.points[0].summary.counts.total();
    let (stop, done) = (AtomicBool::new(false), AtomicUsize::new(0));
    let mut kept = Kept::default();
    let totals = run_in_memory(&study, &mut kept, &stop, |case| {
        if done.fetch_add(1, Ordering::Relaxed) as u64 == first + 20 {
            stop.store(true, Ordering::Relaxed);
        }
        by_place(case)
    })
    .unwrap();
    assert!(totals.interrupted());
    assert_eq!(totals.counts.total(), kept.runs.len() as u64);
    assert_eq!((kept.points.len(), &kept.points[0]), (2, &whole.points[0]));
    let finished = kept.runs.len() as u64;
    assert!((first + 18..first + 25).contains(&finished), "{finished}");
    for record in &kept.runs {
        assert!(whole.runs.contains(record));
    }

    // Stopped with the last run of a round, before the next round.
    let stop = AtomicBool::new(false);
    let done = AtomicUsize::new(0);
    let mut kept = Kept::default();
    let totals = run_in_memory(&study, &mut kept, &stop, |case| {
        if done.fetch_add(1, Ordering::Relaxed) == 14 {
            stop.store(true, Ordering::Relaxed);
        }
        by_place(case)
    })
    .unwrap();
    assert_eq!(kept.runs.len(), 15);
    assert!(totals.interrupted());
}

/// Finished tables are complete, even though there could have been more runs.
#[test]
fn the_tables_and_the_terminal_say_what_was_reached() {
    let scratch = Scratch::with(text(0.1, 50, AT_ONCE));
    // No run rests so early: 15 runs give a half width of 0.102, 12 runs one of 0.121.
    let ended = scratch.ended("run a.yaml --out out", 0);
    assert_has(
        &ended.err,
        &["the half width of the 95 % interval is at most 0.1 at 3 of 3 points\n"],
    );
    assert_eq!(counts(&scratch.table("out", "points"), "runs"), [30, 30, 16]);
    let manifest = scratch.manifest("out");
    let planned = ["runs_planned", "runs_finished", "complete"].map(|key| manifest[key].clone());
    assert_eq!(planned, [Value::from(138), Value::from(76), Value::from(true)]);
    let again = scratch.stickslip("run a.yaml --out out");
    assert_eq!(again.code, Some(0));
    assert_has(&again.err, &["out already holds all 76 runs of this study: nothing to do"]);

    // A run that was not needed cannot be replayed; the message names the runs of its point.
    let said = [
        "run 40, which was not computed: point 0 reached the `precision` of the study after 30 runs",
        "allowed: run numbers from 0 to 29 at point 0",
    ];
    scratch.refused("replay out 40", &said);

    // A failed run could have been an equilibrium or not: the interval stays wide.
    let negative = "uncertain: {ball_mass_1_kg: {normal: {mean: 1.4e-4, std_dev: 1.4e-4}}}\n";
    scratch.write("b.yaml", text(0.09, 50, AT_ONCE) + negative);
    let ended = scratch.ended("run b.yaml --out failed --json", 3);
    assert_has(
        &ended.err,
        &[
            "the half width of the 95 % interval is at most 0.09 at 0 of 3 points, not at 3 (max_runs 50)\n",
        ],
    );
    let points = scratch.table("failed", "points");
    assert_eq!(counts(&points, "runs"), [45, 45, 48]);
    let reached = |points: &RecordBatch| -> Vec<Option<bool>> {
        column(points, "precision_reached").as_boolean().iter().collect()
    };
    assert_eq!(reached(&points), [Some(false); 3]);
    assert_eq!(reached(&scratch.table("out", "points")), [Some(true); 3]);
    let report = ended.json();
    assert_eq!(report["points_not_precise"], 3);
    assert_eq!(report["points"][2]["precision_reached"], false);

    // Without a required precision there is no statement about it.
    scratch.write("c.yaml", study_text("a", "{monte_carlo: {samples: 15}}", AT_ONCE, REST));
    let ended = scratch.stickslip("run c.yaml --out plain");
    assert!(!ended.err.contains("known to"), "{}", ended.err);
    assert_eq!(reached(&scratch.table("plain", "points")), [None; 3]);
}

#[test]
fn check_and_expand_say_how_many_there_may_be() {
    let scratch = Scratch::with(text(0.1, 50, AT_ONCE));
    let check = scratch.well("check a.yaml");
    assert_has(
        &check,
        &[
            "runs          42 to 138 (until the half width of the 95 % interval is at most 0.1), each to",
        ],
    );
    let report = scratch.json("check a.yaml --json");
    assert_eq!((&report["runs"], &report["least_runs"]), (&138.into(), &42.into()));
    scratch.well("expand a.yaml --out all.parquet");
    let all = scratch.table(".", "all");
    assert_eq!(counts(&all, "run_id"), (0..138).collect::<Vec<u64>>());
    // Shards have whole points.
    let mut points: Vec<u64> = Vec::new();
    for part in ["1", "2"] {
        scratch.well(&format!("expand a.yaml --out part{part}.parquet --shard {part}/2"));
        let part = scratch.table(".", &format!("part{part}"));
        let mut ids = counts(&part, "point_id");
        assert!(ids.len() >= 45);
        ids.dedup();
        points.extend(ids);
    }
    points.sort_unstable();
    assert_eq!(points, [0, 1, 2]);
    // The runs are those cases.
    scratch.well("run a.yaml --out out --quiet");
    let runs = scratch.table("out", "runs");
    let others: Vec<String> =
        names(&runs).into_iter().filter(|name| all.column_by_name(name).is_none()).collect();
    let others: Vec<&str> = others.iter().map(String::as_str).chain(["error"]).collect();
    for (index, run) in counts(&runs, "run_id").into_iter().enumerate() {
        assert_eq!(row(&all, run as usize, &["error"]), row(&runs, index, &others));
    }
    assert!(words(&runs, "label").iter().all(|label| label.as_deref() == Some("undecided")));
}
