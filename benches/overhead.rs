//! Cost of a run in addition to its motion: planning, statistics, tables.
//!
//! `cargo bench --bench overhead`, or `-- NAME` for some of it. Medians are in `benches/README.md`.

use std::hint::black_box;
use std::path::Path;
use std::sync::atomic::AtomicBool;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use stickslip::analysis::{EquilibriumSet, PointAccumulator, PointDetail, Resolution};
use stickslip::classification::{Evidence, Outcome, simulate};
use stickslip::engine::{EngineOptions, Progress, Sink, compute, run_study_with};
use stickslip::model::{Case, Machine};
use stickslip::study::Study;
use stickslip::table::{
    PointRow, ResponseSamples, RunRecord, TableWriter, WriteError, run_columns,
};

/// Returns a study of the thesis's machine, with this design and further lines.
fn study(design: &str, more: &str) -> Study {
    let text = format!(
        "schema: 1\nname: overhead\nseed: 1\nmodel: {{kind: ball_balancer}}\n\
         initial_conditions: {{design: {design}}}\nsimulation: {{tolerance: {{relative: 1.0e-6, \
         absolute: 1.0e-8}}}}\n{more}"
    );
    Study::parse(Path::new("overhead.yaml"), text).unwrap_or_else(|error| panic!("{error}"))
}

const UNCERTAIN: &str = "uncertain: {imbalance_mass_kg: {normal: {mean: 5.6e-5, std_dev: 5.0e-6}}, \
                         ball_mass_1_kg: {uniform: {min: 1.38e-4, max: 1.42e-4}}}\n";
const SWEEP: &str = "sweep: [{grid: {speed_rad_s: [-160, -170, -180, -190, -200, -210, -220, -230], \
                     friction_coefficient: [1.0e-3, 1.5e-3, 2.0e-3, 2.5e-3]}}]\n";
const STRATIFIED: &str = "{stratified: {parts_per_axis: 2, samples_per_cell: 1}}";

/// Real outcomes, slightly different for each start state, without the cost of the motion.
struct Stored(Vec<Outcome>);

impl Stored {
    fn of(study: &Study) -> Self {
        let runs = study.run_count();
        let outcome = |index: u64| {
            let planned = study.planned_run(index * 7919 % runs);
            simulate(&planned.case.expect("a valid machine"))
        };
        Stored((0..256).map(outcome).collect())
    }

    fn outcome(&self, case: &Case) -> Outcome {
        let mix = |bits: u64, value: &f64| {
            (bits.rotate_left(13) ^ value.to_bits()).wrapping_mul(0x9e37_79b9_7f4a_7c15)
        };
        let bits = case.start.0.iter().fold(0, mix);
        let mut outcome = self.0[(bits >> 56) as usize % self.0.len()].clone();
        let factor = 1.0 + 1e-2 * (bits << 8 >> 8) as f64 / (1_u64 << 56) as f64;
        let mut numbers = vec![&mut outcome.amplitude_m];
        if let Evidence::RestCertified(rest) = &mut outcome.evidence {
            numbers.extend([&mut rest.since_s, &mut rest.friction_margin]);
        }
        numbers.into_iter().flatten().for_each(|number| *number *= factor);
        outcome.position.iter_mut().flatten().for_each(|angle| *angle *= 1.005 / factor);
        outcome
    }
}

/// A run by its number: start states of all designs, sampled parameters, points of a sweep.
fn planning(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("planning one run");
    let cases = [
        ("stratified", STRATIFIED, ""),
        ("latin_hypercube", "{latin_hypercube: {samples: 100000}}", ""),
        ("sobol", "{sobol: {samples: 65536}}", ""),
        ("monte_carlo", "{monte_carlo: {samples: 100000}}", ""),
        ("stratified, two parameters drawn", STRATIFIED, UNCERTAIN),
        ("stratified, two parameters swept", STRATIFIED, SWEEP),
    ];
    for (name, design, more) in cases {
        let study = study(design, more);
        let mut run_id = 0;
        group.bench_function(name, |bencher| {
            bencher.iter(|| {
                run_id = (run_id + 1) % study.run_count();
                study.planned_run(black_box(run_id))
            });
        });
    }
}

struct Nowhere;

impl Sink for Nowhere {
    fn run(&mut self, _: RunRecord) -> Result<(), WriteError> {
        Ok(())
    }

    fn point(&mut self, _: PointRow, _: PointDetail) -> Result<(), WriteError> {
        Ok(())
    }
}

/// Complete studies without the motion and the tables: one point, and 32 points with the same total
/// number of runs.
fn farming(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("farming 8192 runs, outcomes at hand");
    group.sample_size(10).throughput(Throughput::Elements(8192));
    let of_one = "{stratified: {parts_per_axis: 2, samples_per_cell: 32}}";
    let cases = [
        ("one point", of_one, ""),
        ("one point, two parameters drawn", of_one, UNCERTAIN),
        ("32 points", STRATIFIED, SWEEP),
    ];
    for (name, design, more) in cases {
        let study = study(design, more);
        let stored = Stored::of(&study);
        let options = EngineOptions { threads: 1, chunk: 1024, ..EngineOptions::default() };
        let stop = AtomicBool::new(false);
        group.bench_function(name, |bencher| {
            bencher.iter(|| {
                let progress = Progress::new(study.run_count(), true);
                let outcome = |case: &Case| stored.outcome(case);
                run_study_with(&study, options, outcome, &stop, &progress, None, &mut Nowhere)
            });
        });
    }
}

/// The cost of the end of a point, with 256 runs.
fn points(criterion: &mut Criterion) {
    let study = study(STRATIFIED, "");
    let stored = Stored::of(&study);
    let mut runs = PointAccumulator::new(study.point(0).cells);
    for run_id in 0..study.run_count() {
        runs.add(compute(&study, run_id, |case| stored.outcome(case)).observed());
    }
    let point = study.point(0);
    let mut group = criterion.benchmark_group("closing a point");
    group.bench_function("its tables", |bencher| bencher.iter(|| runs.detail([16.5; 2])));
    group.bench_function("its row", |bencher| {
        let none = ResponseSamples::new(&[], None);
        bencher.iter(|| PointRow::new(&point, runs.clone().summary(), &none));
    });
}

/// `runs.parquet`.
fn writing(criterion: &mut Criterion) {
    let rows = 100_000;
    let study = study("{stratified: {parts_per_axis: 2, samples_per_cell: 16}}", "");
    let stored = Stored::of(&study);
    let runs = study.run_count();
    let records: Vec<RunRecord> =
        (0..runs).map(|run_id| compute(&study, run_id, |case| stored.outcome(case))).collect();
    let directory = tempfile::tempdir().expect("a temporary directory");
    let path = directory.path().join("runs.parquet");
    let mut group = criterion.benchmark_group("writing run rows");
    group.sample_size(10).throughput(Throughput::Elements(rows));
    group
        .bench_function("100,000", |bencher| bencher.iter(|| write(&path, &study, &records, rows)));
}

fn write(path: &Path, study: &Study, records: &[RunRecord], rows: u64) -> u64 {
    let mut table = TableWriter::create(path, run_columns(study), "").expect("a table");
    for record in records.iter().cycle().take(rows as usize) {
        table.push(record.clone()).expect("a row");
    }
    table.finish().expect("a file").iter().filter_map(|(_, file)| file.rows).sum()
}

/// An equilibrium set with its components.
fn sets(criterion: &mut Criterion) {
    let machine = Machine::default();
    criterion.bench_function("equilibrium set, 512 x 512", |bencher| {
        bencher.iter(|| EquilibriumSet::of(black_box(&machine), Resolution::Grid(512)));
    });
}

criterion_group!(overhead, planning, farming, points, writing, sets);
criterion_main!(overhead);
