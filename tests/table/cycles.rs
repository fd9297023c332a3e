//! `cycles.parquet`: columns, the unique cycle of a block on a belt, and constructed cycles of
//! balls computed through the engine.

use std::fs;
use std::path::Path;
use std::sync::atomic::AtomicBool;

use crate::support::{Block, Ground};
use arrow::array::{AsArray, RecordBatch};
use arrow::datatypes::{Float64Type, Int32Type};
use stickslip::classification::{ClosedOrbit, Cycle, CyclePhase, Evidence, Outcome};
use stickslip::engine::{EngineOptions, Progress, Shard, run_study_with};
use stickslip::model::{Case, FrictionLaw};
use stickslip::study::Study;
use stickslip::table::{Manifest, Results};

use super::contract::{columns, listed};
use crate::cli::support::{
    AT_ONCE, Scratch, column, counts, numbers, parse, study_text, table, words,
};

const OF_EVERY_MODEL: &str = "runs c -, fraction n 1, ci_low n 1, ci_high n 1, period_s n s, \
                              period_low_s n s, period_high_s n s";

const OF_EVERY_CYCLE: &str = "largest_multiplier n 1, multipliers l 1, neutral_directions s -";

#[test]
fn columns_of_a_balancer() {
    let sweep = "sweep: [{grid: {speed_rad_s: [-160.0]}}]\n";
    let scratch = Scratch::ran(study_text("a", "{monte_carlo: {samples: 2}}", AT_ONCE, sweep));
    let ball = |i: usize| {
        format!(
            "turns_{i} i -, mean_speed_{i}_rad_s n rad/s, min_speed_{i}_rad_s n rad/s, \
             max_speed_{i}_rad_s n rad/s, rest_from_{i}_rad n rad, rest_to_{i}_rad n rad"
        )
    };
    let expected = format!(
        "point_id c -, speed_rad_s n rad/s, class t -, balls_running s -, {OF_EVERY_MODEL}, {}, {}, \
         amplitude_rms_m n m, amplitude_rms_low_m n m, amplitude_rms_high_m n m, \
         amplitude_peak_m n m, min_friction_margin n 1, {OF_EVERY_CYCLE}",
        ball(1),
        ball(2)
    );
    let cycles = scratch.table("out", "cycles");
    assert_eq!((columns(&cycles), cycles.num_rows()), (listed(&expected), 0));
}

/// There is one class at each belt speed with all runs on a limit cycle, and the period of the
/// closed form.
#[test]
fn a_block_on_a_belt_has_one_cycle() {
    let text = include_str!("../../studies/block-on-belt.yaml");
    let scratch = Scratch::ran(text);
    let cycles = scratch.table("out", "cycles");
    let expected = format!(
        "point_id c -, belt_speed_m_s n m/s, class t -, {OF_EVERY_MODEL}, \
         min_speed_belt_m_s n m/s, max_speed_belt_m_s n m/s, amplitude_m n m, \
         amplitude_low_m n m, amplitude_high_m n m, {OF_EVERY_CYCLE}"
    );
    assert_eq!(columns(&cycles), listed(&expected));
    assert_eq!(counts(&cycles, "point_id"), [0, 1, 2, 3]);
    assert_eq!(words(&cycles, "class"), vec![Some("0:SB".to_owned()); 4]);
    let points = scratch.table("out", "points");
    assert_eq!(counts(&cycles, "runs"), counts(&points, "limit_cycle_runs"));
    assert!(counts(&cycles, "runs").iter().all(|&runs| runs >= 30));
    let speeds = numbers(&cycles, "belt_speed_m_s");
    let value = |name: &str, row: usize| numbers(&cycles, name)[row].expect("known");
    for (row, speed_m_s) in speeds.into_iter().map(Option::unwrap).enumerate() {
        let friction = FrictionLaw::stribeck(0.2, 0.0);
        let block = Block { friction, ground: Ground::Belt { speed_m_s }, ..Block::on_belt() };
        let exact = block.stick_slip_cycle().expect("it sticks and slips");
        for name in ["period_s", "period_low_s", "period_high_s"] {
            assert!((value(name, row) / exact.period_s - 1.0).abs() < 1e-6, "{name}");
        }
        for name in ["amplitude_m", "amplitude_low_m", "amplitude_high_m"] {
            assert!((value(name, row) / exact.amplitude_m - 1.0).abs() < 1e-6, "{name}");
        }
        let fastest = -speed_m_s - block.natural_frequency_rad_s() * exact.amplitude_m;
        assert!((value("min_speed_belt_m_s", row) / fastest - 1.0).abs() < 1e-6);
        assert!(value("largest_multiplier", row) < 1e-6);
    }
    let runs = scratch.table("out", "runs");
    for (label, class) in words(&runs, "label").iter().zip(words(&runs, "cycle_class")) {
        assert_eq!(class.is_some(), label.as_deref() == Some("limit_cycle"));
    }
}

/// Returns a constructed cycle for each case: depending on its start, one of the balls runs or the
/// other, with individual period and resting angles; sometimes both run, and sometimes the class is
/// unknown.
fn constructed(case: &Case) -> Outcome {
    let start = &case.start.0;
    let (first, second) = (start[2], start[3]);
    let sense = case.model.ball_balancer().expect("a balancer").speed_rad_s.signum() as i32;
    let first_rests = first < 3.0;
    let runs = if sense > 0 { CyclePhase::Backward } else { CyclePhase::Forward };
    let of_balls =
        |running, other| if first_rests { vec![other, running] } else { vec![running, other] };
    let cycle = if second < 1.0 {
        None
    } else if second < 2.0 {
        Some((vec![-sense; 2], vec![vec![runs; 2]]))
    } else {
        let balls = of_balls(runs, CyclePhase::Stick);
        Some((if first_rests { vec![0, -sense] } else { vec![-sense, 0] }, vec![balls]))
    };
    let cycle = cycle.map(|(turns, configurations)| {
        Box::new(Cycle {
            position_extremes: turns
                .iter()
                .map(|&turns| (turns == 0).then_some([first; 2]))
                .collect(),
            speed_extremes: vec![[-first, first]; 2],
            peak_amplitude_m: first,
            multipliers: vec![0.1 * first, 0.01 * first],
            neutral_directions: 1,
            ..crate::analysis::cycle_classes::cycle(turns, configurations)
        })
    });
    Outcome {
        amplitude_m: Some(1e-5 * first),
        end_time_s: Some(4.0),
        position: Some(vec![first, first]),
        ..Outcome::of(Evidence::ClosedOrbit(ClosedOrbit {
            period_s: 0.1 + 1e-4 * first,
            friction_margin: Some(0.1 * second),
            cycle,
        }))
    }
}

fn written(study: &Study, folder: &Path, threads: usize, chunk: usize) -> Vec<u8> {
    let options = EngineOptions { threads, chunk, ..EngineOptions::default() };
    let mut tables = Results::create(folder, study).expect("an empty folder");
    let progress = Progress::new(study.run_count(), true);
    let totals = run_study_with(
        study,
        options,
        constructed,
        &AtomicBool::new(false),
        &progress,
        None,
        &mut tables.tables,
    )
    .unwrap();
    let begun = Manifest::begin(study, Shard::WHOLE);
    let manifest =
        tables.finish(begun.with_runs(totals.counts, &totals.failures)).expect("written tables");
    assert_eq!(manifest.files["cycles.parquet"].rows, Some(6));
    fs::read(folder.join("cycles.parquet")).unwrap()
}

fn integers(table: &RecordBatch, name: &str) -> Vec<Option<i32>> {
    column(table, name).as_primitive::<Int32Type>().iter().collect()
}

/// The bytes do not depend on the number of threads or the chunk size, and contain the constructed
/// values.
#[test]
fn constructed_cycles_of_balls_are_written() {
    let sweep = "sweep: [{grid: {speed_rad_s: [-247.3, 247.3]}}]\n";
    let study = parse(study_text("a", "{monte_carlo: {samples: 3000}}", 20.0, sweep));
    let scratch = Scratch::new();
    let first = written(&study, &scratch.path("first"), 1, 100);
    for (index, (threads, chunk)) in [(3, 7), (7, 1000)].into_iter().enumerate() {
        let again = written(&study, &scratch.path(&format!("out-{index}")), threads, chunk);
        assert!(first == again, "{threads} threads, chunks of {chunk}");
    }
    let cycles = table(&scratch.path("first").join("cycles.parquet"));
    let classes: Vec<String> = words(&cycles, "class").into_iter().flatten().collect();
    assert_eq!(classes[..3], ["-1|rest", "-1|-1", "unknown"]);
    assert_eq!(classes[3..], classes[..3]);
    assert_eq!(integers(&cycles, "turns_1")[..3], [Some(-1), Some(-1), None]);
    assert_eq!(integers(&cycles, "turns_2")[..3], [Some(0), Some(-1), None]);
    assert_eq!(counts(&cycles, "runs").iter().sum::<u64>(), 6000);

    // From the runs themselves.
    let runs: Vec<Outcome> = (0..3000)
        .map(|run| constructed(&study.planned_run(run).case.unwrap()))
        .filter(|outcome| outcome.evidence.cycle().is_some_and(|cycle| cycle.turns.contains(&0)))
        .collect();
    assert_eq!(counts(&cycles, "runs")[0], runs.len() as u64);
    let mut periods: Vec<f64> =
        runs.iter().filter_map(|outcome| outcome.evidence.period_s()).collect();
    periods.sort_by(f64::total_cmp);
    let (low, high) = (periods[0], periods[periods.len() - 1]);
    let value = |name: &str| numbers(&cycles, name)[0].unwrap();
    assert_eq!((value("period_low_s"), value("period_high_s")), (low, high));
    let median = periods[periods.len() / 2];
    assert!((value("period_s") - median).abs() < 0.01 * (high - low));
    let angle = |outcome: &Outcome| outcome.position.as_ref().expect("a position")[0];
    let widest = runs.iter().max_by(|a, b| angle(a).total_cmp(&angle(b))).expect("some runs");
    let multipliers = column(&cycles, "multipliers").as_list::<i32>().value(0);
    let multipliers = multipliers.as_primitive::<Float64Type>().values().to_vec();
    assert_eq!(multipliers, widest.evidence.cycle().expect("a cycle").multipliers);
    assert_eq!(value("largest_multiplier"), multipliers[0]);
    let margins = runs.iter().filter_map(|outcome| outcome.evidence.friction_margin());
    assert_eq!(value("min_friction_margin"), margins.fold(f64::MAX, f64::min));
    // Angles all around the circle: the arc excludes the longest gap between two of them.
    let mut angles: Vec<f64> = runs.iter().map(angle).collect();
    angles.sort_by(f64::total_cmp);
    let wrapped = angles[0] + std::f64::consts::TAU;
    let next = angles[1..].iter().copied().chain([wrapped]);
    let gap = angles.iter().zip(next).map(|(a, b)| b - a).fold(0.0, f64::max);
    let arc = (value("rest_to_2_rad") - value("rest_from_2_rad")).rem_euclid(std::f64::consts::TAU);
    assert!(arc <= std::f64::consts::TAU - gap + 0.02, "{arc} {gap}");
    assert_eq!(numbers(&cycles, "rest_from_1_rad")[0], None);
}
