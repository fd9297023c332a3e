#![forbid(unsafe_code)]
//! W1 end to end: lockstep against stickslip as it is.
use fearless_simd::Level;
use lockstep_prototype::driver::{Done, Ending, Task, simulate};
use std::path::Path;
use stickslip::ending::{Label, certified, certified_by_closed_form};
use stickslip::model::{Balancer, Case, Method, Model};
use stickslip::motion::{Motion, Settings};
use stickslip::study::Study;

fn cpu_ns() -> f64 {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap();
    text.split(' ').next().unwrap().parse().unwrap()
}

fn cases(samples: usize) -> Vec<Case> {
    let text = format!("
schema: 1
name: w1
seed: 2003
model: {{kind: ball_balancer, parameters: {{speed_rad_s: -216.3772, friction_coefficient: 2.75e-3}}}}
initial_conditions: {{design: {{stratified: {{parts_per_axis: 2, samples_per_cell: {samples}}}}}}}
simulation: {{end_time_s: 16.5, tolerance: {{relative: 1.0e-6, absolute: 1.0e-8}}}}
");
    let study = Study::parse(Path::new("w1.yaml"), text).unwrap();
    let mut cases: Vec<Case> =
        (0..study.run_count()).map(|i| study.planned_run(i).case.unwrap()).collect();
    for case in &mut cases {
        case.simulation.method = Method::Event;
    }
    cases
}

fn task(case: &Case) -> Task {
    let Model::BallBalancer(machine) = &case.model else { panic!() };
    Task {
        balancer: Balancer::new(machine).unwrap(),
        start: case.start.of_balls().unwrap(),
        end_time: case.simulation.end_time_s * machine.natural_frequency_rad_s(),
    }
}

/// stickslip's own motion with the certificate only.
fn bare(case: &Case) -> (bool, stickslip::motion::Effort) {
    let t = task(case);
    let settings = Settings::new(&case.simulation, 100_000_000);
    let mut motion = Motion::new(&t.balancer, settings, t.start).unwrap();
    let mut rest = None;
    while motion.time() < t.end_time {
        if motion.all_stick() {
            let rest = rest.get_or_insert_with(|| t.balancer.rest_point(&motion.state().beta));
            if certified(&t.balancer, rest, motion.state()) {
                return (true, motion.effort());
            }
        }
        if motion.advance(t.end_time).unwrap() {
            rest = None;
        }
    }
    let r = motion.all_stick()
        && certified_by_closed_form(
            &t.balancer,
            &t.balancer.rest_point(&motion.state().beta),
            motion.state(),
        );
    (r, motion.effort())
}

fn main() {
    let samples: usize = std::env::args().nth(1).map_or(1, |a| a.parse().unwrap());
    let rounds: usize = std::env::args().nth(2).map_or(5, |a| a.parse().unwrap());
    let cases = cases(samples);
    let tasks: Vec<Task> = cases.iter().map(task).collect();
    let settings = Settings::new(&cases[0].simulation, 100_000_000);
    let n = cases.len() as f64;
    let level = Level::new();
    if std::env::args().nth(3).is_some() {
        for _ in 0..20 {
            simulate::<1, 0>(level, &tasks, settings);
        }
        return;
    }
    // bits do not depend on width
    let (a, totals) = simulate::<1, 0>(level, &tasks, settings);
    let (b, totals2) = simulate::<2, 0>(level, &tasks, settings);
    println!("M=1 and M=2 alike: {}", a == b);
    if let Some(l) = level.as_avx2() {
        let (c, _) = simulate::<2, 0>(Level::Avx2(l), &tasks, settings);
        println!("AVX-512 and AVX2 alike: {}", a == c);
    }
    let done: Vec<Done> = a.iter().map(|d| d.unwrap()).collect();
    let mean = |f: &dyn Fn(&Done) -> f64| done.iter().map(f).sum::<f64>() / n;
    println!(
        "lockstep per run: steps tried {:.0} rejected {:.1} trials {:.1} events {:.1} looks {:.1} time {:.0}",
        mean(&|d| d.steps),
        mean(&|d| d.rejected as f64),
        mean(&|d| d.trials as f64),
        mean(&|d| d.events as f64),
        mean(&|d| d.looks as f64),
        mean(&|d| d.time)
    );
    println!(
        "occupancy M=1 {:.3} M=2 {:.3}",
        totals.lane_steps as f64 / (8.0 * totals.vector_steps as f64),
        totals2.lane_steps as f64 / (8.0 * totals2.vector_steps as f64)
    );
    println!(
        "given up: {}  rest: {}",
        done.iter().filter(|d| d.ending == Ending::GivenUp).count(),
        done.iter().filter(|d| d.ending == Ending::Rest).count()
    );

    let mut lock: Vec<(String, Vec<f64>)> = Vec::new();
    let mut put = |name: &str, v: f64| match lock.iter_mut().find(|x| x.0 == name) {
        Some(x) => x.1.push(v),
        None => lock.push((name.to_owned(), vec![v])),
    };
    let mut labels = Vec::new();
    let mut bare_labels = Vec::new();
    for round in 0..rounds {
        let t = cpu_ns();
        bare_labels = cases.iter().map(bare).collect();
        let scalar = cpu_ns() - t;
        put("bare scalar", scalar / n / 1e3);
        if round == 0 {
            let t = cpu_ns();
            labels = cases
                .iter()
                .map(|c| {
                    let o = stickslip::ending::simulate(c);
                    (o.label(), o.evidence, o.effort)
                })
                .collect::<Vec<_>>();
            put("simulate", (cpu_ns() - t) / n / 1e3);
        }
        let mut one = |name: &str, f: &dyn Fn()| {
            let t = cpu_ns();
            f();
            let v = cpu_ns() - t;
            put(name, v / n / 1e3);
            put(&format!("{name} ratio to bare"), scalar / v);
        };
        one("lock M=1", &|| {
            simulate::<1, 0>(level, &tasks, settings);
        });
        one("lock M=2", &|| {
            simulate::<2, 0>(level, &tasks, settings);
        });
        if let Some(l) = level.as_avx2() {
            one("lock avx2 M=2", &|| {
                simulate::<2, 0>(Level::Avx2(l), &tasks, settings);
            });
        }
    }
    for (name, mut v) in lock {
        v.sort_by(f64::total_cmp);
        println!(
            "{name:32} median {:9.2} least {:9.2} (us per run, or ratio)",
            v[v.len() / 2],
            v[0]
        );
    }
    let steps = |e: &stickslip::motion::Effort| (e.steps + e.rejected_steps) as f64;
    println!(
        "scalar event 1e-6 per run: steps {:.0} rejected {:.1} switches {:.1}",
        bare_labels.iter().map(|(_, e)| e.steps as f64).sum::<f64>() / n,
        bare_labels.iter().map(|(_, e)| e.rejected_steps as f64).sum::<f64>() / n,
        bare_labels.iter().map(|(_, e)| e.switches as f64).sum::<f64>() / n
    );
    let _ = steps;
    let mut kinds: Vec<(&str, usize)> = Vec::new();
    for (_, e, _) in &labels {
        match kinds.iter_mut().find(|k| k.0 == e.name()) {
            Some(k) => k.1 += 1,
            None => kinds.push((e.name(), 1)),
        }
    }
    println!("simulate's evidence: {kinds:?}");
    // against the exact motion
    let exact: Vec<bool> = cases
        .iter()
        .map(|c| {
            let mut c = c.clone();
            c.simulation.relative_tolerance = 1e-10;
            c.simulation.absolute_tolerance = 1e-12;
            bare(&c).0
        })
        .collect();
    let count = |it: Vec<bool>| it.into_iter().filter(|x| *x).count();
    println!(
        "rest by: exact {} scalar {} simulate {} lockstep {}",
        count(exact.clone()),
        count(bare_labels.iter().map(|x| x.0).collect()),
        count(labels.iter().map(|l| l.0 == Label::Equilibrium).collect()),
        count(done.iter().map(|d| d.ending == Ending::Rest).collect())
    );
    let wrong = |other: Vec<bool>| other.iter().zip(&exact).filter(|(a, b)| a != b).count();
    println!(
        "labels unlike exact: scalar 1e-6 {} simulate {} lockstep {}",
        wrong(bare_labels.iter().map(|x| x.0).collect()),
        wrong(labels.iter().map(|l| l.0 == Label::Equilibrium).collect()),
        wrong(done.iter().map(|d| d.ending == Ending::Rest).collect())
    );
}
