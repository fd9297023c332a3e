//! Error and cost of runs by method, tolerance and kernel, as lines of CSV: `cargo bench --bench work-precision -- RUNS`
//! with the number of runs per speed.
//!
//! The reference is the exact motion (`event`) by the general kernel at 1e-11. The error of a run is the
//! largest distance along the ring between the rest positions of a ball in the two computations, if
//! both come to rest. Different labels are counted over all runs. Time is the CPU time of this
//! thread.

use std::f64::consts::TAU;
use std::path::Path;
use std::time::Instant;

use stickslip::classification::{
    Label, Outcome, Runs, simulate_by_recorded_equations_in_lockstep, simulate_in_lockstep,
};
use stickslip::model::{Case, Method, Simulation, Tolerance};
use stickslip::motion::SimdLevel;
use stickslip::study::Study;

/// Measurements of a time; the result is their median.
const REPETITIONS: usize = 3;

/// A way to compute runs.
type Compute = fn(&[Case]) -> Vec<Outcome>;

fn main() {
    // The argument is the number of runs per speed. Without it the program does nothing, so that
    // `cargo bench` does not take minutes here; cargo adds `--bench`.
    let Some(runs) = std::env::args().skip(1).find_map(|argument| argument.parse::<u32>().ok())
    else {
        println!("work and precision: cargo bench --bench work-precision -- RUNS");
        return;
    };
    println!(
        "speed_rad_s,method,tolerance,kernel,runs,at_rest,median_rad,p99_rad,labels_differ,us_per_run"
    );
    for speed_rad_s in [-160.8103, -216.3772] {
        let cases = cases(speed_rad_s, runs);
        let with = |method, relative_tolerance: f64| -> Vec<Case> {
            let settings = |case: &Case| Simulation {
                method,
                tolerance: Tolerance {
                    relative: relative_tolerance,
                    absolute: relative_tolerance / 100.0,
                },
                ..case.simulation
            };
            cases.iter().map(|case| Case { simulation: settings(case), ..case.clone() }).collect()
        };
        let reference = general(&with(Method::Event, 1e-11));
        for (method, name) in [(Method::Switch, "switch"), (Method::Event, "event")] {
            for tolerance in [1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9] {
                let cases = with(method, tolerance);
                let kernels: [(&str, Compute); 2] = [("tuned", tuned), ("general", general)];
                for (kernel, compute) in kernels {
                    let (mut outcomes, mut spent) = (Vec::new(), Vec::new());
                    for _ in 0..REPETITIONS {
                        let began = core_time_s();
                        outcomes = compute(&cases);
                        spent.push(core_time_s() - began);
                    }
                    spent.sort_by(f64::total_cmp);
                    let us_per_run = 1e6 * spent[REPETITIONS / 2] / f64::from(runs);
                    let pairs = || outcomes.iter().zip(&reference);
                    let mut errors: Vec<f64> = pairs().filter_map(|(a, b)| error(a, b)).collect();
                    errors.sort_by(f64::total_cmp);
                    let quantile = |fraction: f64| {
                        let last = errors.len().saturating_sub(1);
                        errors
                            .get((fraction * last as f64).round() as usize)
                            .copied()
                            .unwrap_or(f64::NAN)
                    };
                    let differ = pairs().filter(|(a, b)| a.label() != b.label()).count();
                    println!(
                        "{speed_rad_s},{name},{tolerance:e},{kernel},{runs},{},{:.3e},{:.3e},{differ},{us_per_run:.1}",
                        errors.len(),
                        quantile(0.5),
                        quantile(0.99)
                    );
                }
            }
        }
    }
}

fn cases(speed_rad_s: f64, runs: u32) -> Vec<Case> {
    let text = format!(
        "schema: 1\nname: work-precision\nseed: 17\n\
         model: {{kind: ball_balancer, parameters: {{speed_rad_s: {speed_rad_s}}}}}\n\
         initial_conditions: {{design: {{latin_hypercube: {{samples: {runs}}}}}}}\n"
    );
    let study = Study::parse(Path::new("work-precision.yaml"), text)
        .unwrap_or_else(|error| panic!("{error}"));
    (0..study.run_count()).map(|run| study.planned_run(run).case.expect("valid")).collect()
}

fn tuned(cases: &[Case]) -> Vec<Outcome> {
    outcomes(simulate_in_lockstep, cases)
}

fn general(cases: &[Case]) -> Vec<Outcome> {
    outcomes(simulate_by_recorded_equations_in_lockstep, cases)
}

struct Listed<'a> {
    cases: std::iter::Enumerate<std::slice::Iter<'a, Case>>,
    outcomes: Vec<Option<Outcome>>,
}

impl Runs for Listed<'_> {
    fn next(&mut self) -> Option<(u64, Case)> {
        self.cases.next().map(|(number, case)| (number as u64, case.clone()))
    }

    fn ended(&mut self, number: u64, outcome: Outcome) {
        self.outcomes[number as usize] = Some(outcome);
    }
}

fn outcomes(in_lockstep: fn(SimdLevel, &mut dyn Runs), cases: &[Case]) -> Vec<Outcome> {
    let mut runs = Listed { cases: cases.iter().enumerate(), outcomes: vec![None; cases.len()] };
    in_lockstep(SimdLevel::best(), &mut runs);
    runs.outcomes.into_iter().map(|outcome| outcome.expect("every run has ended")).collect()
}

/// Returns the distance between the rest positions in two outcomes, rad; `None` if one of them is
/// not at rest.
fn error(a: &Outcome, b: &Outcome) -> Option<f64> {
    if a.label() != Label::Equilibrium || b.label() != Label::Equilibrium {
        return None;
    }
    let apart = |(a, b): (&f64, &f64)| {
        let turned = (a - b).rem_euclid(TAU);
        turned.min(TAU - turned)
    };
    let pairs = a.position.iter().flatten().zip(b.position.iter().flatten());
    Some(pairs.map(apart).fold(0.0, f64::max))
}

/// Returns the CPU time of this thread, s; elapsed time if the system does not provide it.
fn core_time_s() -> f64 {
    thread_local!(static BEGAN: Instant = Instant::now());
    let nanoseconds = std::fs::read_to_string("/proc/thread-self/schedstat")
        .ok()
        .and_then(|text| text.split_whitespace().next()?.parse::<f64>().ok());
    match nanoseconds {
        Some(nanoseconds) => 1e-9 * nanoseconds,
        None => BEGAN.with(|began| began.elapsed().as_secs_f64()),
    }
}
