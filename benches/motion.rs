//! Cost of the motion of runs, by the kernel that is written for the balancer and by the general one.
//!
//! `cargo bench --bench motion`, or `-- --quick` in a few minutes, or `-- NAME` for some of it.
//! W1 (`w1.yaml`) and W2 (`w2.yaml`) are those of `scripts/compare`; beside them 256 runs at -160.8103
//! rad/s with the default tolerance; all of these runs come to rest.

use std::hint::black_box;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use stickslip::analysis::PointDetail;
use stickslip::classification::{
    Outcome, Runs, simulate_by_recorded_equations, simulate_in_lockstep,
};
use stickslip::engine::{EngineOptions, Progress, Sink, run_study};
use stickslip::model::{Balancer, Case, Machine, State};
use stickslip::motion::{Direction, Evaluator, Phase, SimdLevel};
use stickslip::study::Study;
use stickslip::table::{PointRow, RunRecord, WriteError};

fn study(text: &str) -> Study {
    let text = format!("schema: 1\nname: motion\nseed: 1\n{text}");
    Study::parse(Path::new("motion.yaml"), text).unwrap_or_else(|error| panic!("{error}"))
}

/// Returns the runs of a study beside this file.
fn of_file(name: &str) -> Vec<Case> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("benches").join(name);
    let study = Study::load(&path).unwrap_or_else(|error| panic!("{error}"));
    (0..study.run_count()).map(|run| study.planned_run(run).case.expect("valid")).collect()
}

/// Returns runs with this number of balls and speed of the disc; the relative tolerance is a power
/// of ten.
fn cases(balls: usize, speed_rad_s: f64, tolerance: i32, samples: u32) -> Vec<Case> {
    let study = study(&format!(
        "model: {{kind: ball_balancer, parameters: {{balls: {balls}, speed_rad_s: {speed_rad_s}}}}}\n\
         initial_conditions: {{design: {{latin_hypercube: {{samples: {samples}}}}}}}\n\
         simulation: {{tolerance: {{relative: 1.0e{tolerance}, absolute: 1.0e{}}}}}\n",
        tolerance - 2
    ));
    (0..study.run_count()).map(|run| study.planned_run(run).case.expect("valid")).collect()
}

/// Cases in order; outcomes are discarded.
struct Listed<'a> {
    cases: std::iter::Enumerate<std::slice::Iter<'a, Case>>,
}

impl Runs for Listed<'_> {
    fn next(&mut self) -> Option<(u64, Case)> {
        self.cases.next().map(|(number, case)| (number as u64, case.clone()))
    }

    fn ended(&mut self, _: u64, outcome: Outcome) {
        black_box(outcome);
    }
}

fn in_lockstep(level: SimdLevel, cases: &[Case]) {
    simulate_in_lockstep(level, &mut Listed { cases: cases.iter().enumerate() });
}

/// The evaluation of the recorded equations at an instant, for two balls.
fn pieces(criterion: &mut Criterion) {
    let balancer = Balancer::<2>::new(&Machine::default()).expect("two balls");
    let evaluator = Evaluator::new(Arc::new(balancer));
    let state = State {
        position: [0.01, -0.02],
        velocity: [0.0, 0.02],
        beta: [1.0, 4.0],
        beta_dot: [0.5, -0.3],
    };
    let components = state.components();
    let phases = [Phase::Slip(Direction::Forward), Phase::Slip(Direction::Backward)];
    let mut group = criterion.benchmark_group("an instant");
    group.bench_function("rates", |bencher| {
        bencher.iter(|| evaluator.rates(&phases, black_box(&components)));
    });
    group.bench_function("forces", |bencher| {
        bencher.iter(|| evaluator.forces(&phases, black_box(&components)));
    });
}

/// Complete runs; the throughput is in runs.
fn runs(criterion: &mut Criterion) {
    let one_thread = |name: &str, cases: &[Case], criterion: &mut Criterion| {
        let mut group = criterion.benchmark_group(name);
        group.sample_size(10).throughput(Throughput::Elements(cases.len() as u64));
        for level in SimdLevel::all() {
            group.bench_function(format!("lockstep, {}", level.name()), |bencher| {
                bencher.iter(|| in_lockstep(level, cases));
            });
        }
        group.bench_function("general kernel, a lane", |bencher| {
            bencher.iter(|| {
                let simulate = |case| drop(black_box(simulate_by_recorded_equations(case)));
                cases.iter().for_each(simulate);
            });
        });
    };
    one_thread("W1", &of_file("w1.yaml"), criterion);
    one_thread("W2", &of_file("w2.yaml"), criterion);
    one_thread("below the natural frequency", &cases(2, -160.8103, -8, 256), criterion);
    for balls in [1, 2, 4, 8] {
        let name = format!("64 runs, balls: {balls}");
        one_thread(&name, &cases(balls, -216.3772, -6, 64), criterion);
    }
}

struct Nowhere;

impl Sink for Nowhere {
    fn run(&mut self, record: RunRecord) -> Result<(), WriteError> {
        black_box(record);
        Ok(())
    }

    fn point(&mut self, row: PointRow, detail: PointDetail) -> Result<(), WriteError> {
        black_box((row, detail));
        Ok(())
    }
}

/// The thesis's six points with 128 runs each, with everything except the tables.
fn thesis(criterion: &mut Criterion) {
    let study = study(
        "model: {kind: ball_balancer}\n\
         sweep:\n  - grid: {speed_rad_s: [-160.8103, -173.1803, -179.2671, -191.6372, -216.3772]}\n  \
         - zip: {speed_rad_s: [-216.3772], friction_coefficient: [2.75e-4]}\n\
         initial_conditions: {design: {latin_hypercube: {samples: 128}}}\n",
    );
    let mut group = criterion.benchmark_group("thesis study, 128 runs per point");
    group.sample_size(10).throughput(Throughput::Elements(study.run_count()));
    for threads in [1, 2] {
        let options = EngineOptions { threads, chunk: 1024, ..EngineOptions::default() };
        let stop = AtomicBool::new(false);
        group.bench_function(format!("threads: {threads}"), |bencher| {
            bencher.iter(|| {
                let progress = Progress::new(study.run_count(), true);
                run_study(&study, options, &stop, &progress, None, &mut Nowhere)
            });
        });
    }
}

criterion_group!(motion, pieces, runs, thesis);
criterion_main!(motion);
