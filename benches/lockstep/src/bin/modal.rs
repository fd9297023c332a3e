#![forbid(unsafe_code)]
//! W1 in the turning frame and in modal coordinates: time, counts, labels and errors.
//! modal SAMPLES SEED ROUNDS "coordinates,tolerance,safety,longest,longest while sticking,stricter early" ...
//! Reference labels and angles (event, 1e-10) are kept in a file named by the first two.
use fearless_simd::{Level, Simd, f64x8, prelude::*};
use lockstep_prototype::driver::{Done, Ending, Task, Totals, knob, simulate};
use lockstep_prototype::equations::{Ball, Phase, Vector};
use lockstep_prototype::inertial;
use lockstep_prototype::modal::{self, Modes};
use lockstep_prototype::step::{self, Tolerance, Tried};
use std::path::Path;
use stickslip::ending::{certified, certified_by_closed_form};
use stickslip::model::{Balancer, Case, Method, Model};
use stickslip::motion::{Motion, Settings};
use stickslip::study::Study;

fn cpu_ns() -> f64 {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap();
    text.split(' ').next().unwrap().parse().unwrap()
}

fn cases(samples: usize, seed: u64) -> Vec<Case> {
    let speed = std::env::var("SPEED").unwrap_or("-216.3772".to_owned());
    let text = format!(
        "
schema: 1
name: w1
seed: {seed}
model: {{kind: ball_balancer, parameters: {{speed_rad_s: {speed}, friction_coefficient: 2.75e-3}}}}
initial_conditions: {{design: {{stratified: {{parts_per_axis: 2, samples_per_cell: {samples}}}}}}}
simulation: {{end_time_s: 16.5, tolerance: {{relative: 1.0e-6, absolute: 1.0e-8}}}}
"
    );
    let study = Study::parse(Path::new("w1.yaml"), text).unwrap();
    (0..study.run_count())
        .map(|i| {
            let mut case = study.planned_run(i).case.unwrap();
            case.simulation.method = Method::Event;
            case
        })
        .collect()
}

fn task(case: &Case) -> Task {
    let Model::BallBalancer(machine) = &case.model else { panic!() };
    Task {
        balancer: Balancer::new(machine).unwrap(),
        start: case.start.of_balls().unwrap(),
        end_time: case.simulation.end_time_s * machine.natural_frequency_rad_s(),
    }
}

/// Whether it comes to rest, and where.
fn bare(case: &Case, relative: f64) -> (bool, [f64; 2]) {
    let mut case = case.clone();
    case.simulation.relative_tolerance = relative;
    case.simulation.absolute_tolerance = 0.01 * relative;
    let t = task(&case);
    let settings = Settings::new(&case.simulation, 100_000_000);
    let mut motion = Motion::new(&t.balancer, settings, t.start).unwrap();
    let mut rest = None;
    while motion.time() < t.end_time {
        if motion.all_stick() {
            let rest = rest.get_or_insert_with(|| t.balancer.rest_point(&motion.state().beta));
            if certified(&t.balancer, rest, motion.state()) {
                return (true, motion.state().beta);
            }
        }
        if motion.advance(t.end_time).unwrap() {
            rest = None;
        }
    }
    let point = t.balancer.rest_point(&motion.state().beta);
    let r = motion.all_stick() && certified_by_closed_form(&t.balancer, &point, motion.state());
    (r, motion.state().beta)
}

fn lock(which: usize, tasks: &[Task], settings: Settings) -> (Vec<Option<Done>>, Totals) {
    let level = Level::new();
    match which {
        0 => simulate::<1, 0>(level, tasks, settings),
        1 => simulate::<1, 1>(level, tasks, settings),
        2 => simulate::<1, 2>(level, tasks, settings),
        _ => simulate::<1, 3>(level, tasks, settings),
    }
}

fn errors(name: &str, ends: &[(bool, [f64; 2])], exact: &[(bool, [f64; 2])]) -> String {
    let flips = ends.iter().zip(exact).filter(|(a, b)| a.0 != b.0).count();
    let turn = |x: f64| (x - (x / std::f64::consts::TAU).round() * std::f64::consts::TAU).abs();
    let mut e: Vec<f64> = ends
        .iter()
        .zip(exact)
        .filter(|(a, b)| a.0 && b.0)
        .map(|(a, b)| turn(a.1[0] - b.1[0]).max(turn(a.1[1] - b.1[1])))
        .collect();
    e.sort_by(f64::total_cmp);
    let at = |q: f64| e[(q * (e.len() - 1) as f64) as usize];
    format!(
        "{name} flips {flips} of {} error median {:.1e} 90 % {:.1e} 99 % {:.1e}",
        ends.len(),
        at(0.5),
        at(0.9),
        at(0.99)
    )
}

/// ns per run and step of 8 lanes, steps from one real state over and over.
#[inline(always)]
fn steps_chain<S: Simd, const COORDINATES: usize>(
    simd: S,
    balancer: &Balancer<2>,
    n: usize,
) -> f64 {
    let c = |v: f64| f64x8::splat(simd, v);
    let o = balancer.speed;
    let ball = |i: usize, d: f64| {
        let ball = &balancer.balls[i];
        Ball {
            mass: c(ball.mass),
            mobility: c(ball.mobility),
            mobile_mass: c(ball.mass * ball.mobility),
            friction: c(ball.friction.coefficient * d),
            rolling_linear: c(-ball.rolling_linear),
            rolling_quadratic: c(-ball.rolling_quadratic),
        }
    };
    let phase = Phase {
        omega: c(o),
        two_omega: c(2.0 * o),
        omega_squared: c(o * o),
        drag: c(2.0 * balancer.damping_ratio),
        drag_omega: c(2.0 * balancer.damping_ratio * o),
        imbalance: c(balancer.imbalance * o * o),
        balls: [ball(0, 1.0), ball(1, -1.0)],
    };
    let mut modes = Modes::blank(simd);
    for lane in 0..8 {
        modes.set(lane, o, balancer.damping_ratio, balancer.imbalance);
    }
    let start: Vector<S> = [c(0.01), c(-0.02), c(0.01), c(-0.02), c(0.7), c(3.0), c(0.3), c(-0.4)];
    let (k, contacts) = phase.full(&start);
    let mut y = start;
    let mut dy = k;
    let mut tried = Tried {
        end: start,
        derivative: k,
        contacts,
        error_squared: c(0.0),
        inner: [[c(0.0); 4]; 3],
    };
    let mut stages = [start; 12];
    let h = c(0.3);
    let tolerance = Tolerance { relative: 1e-6, absolute: 1e-8 };
    for _ in 0..n {
        match COORDINATES {
            0 => step::attempt(tolerance, &phase, &y, &dy, h, &mut stages, &mut tried),
            1 => modal::attempt::<S, false>(
                tolerance,
                &phase,
                &modes,
                &y,
                &dy,
                h,
                &mut stages,
                &mut tried,
            ),
            2 => modal::attempt::<S, true>(
                tolerance,
                &phase,
                &modes,
                &y,
                &dy,
                h,
                &mut stages,
                &mut tried,
            ),
            _ => inertial::attempt(tolerance, &phase, &y, &dy, h, &mut stages, &mut tried),
        }
        let good = tried.error_squared.simd_le(c(1.0));
        for i in 0..8 {
            y[i] = good.select(tried.end[i], y[i]);
            dy[i] = good.select(tried.derivative[i], dy[i]);
        }
    }
    let mut sum = 0.0;
    for v in y {
        sum += v[0];
    }
    sum
}

fn micro(balancer: &Balancer<2>) {
    let level = Level::new();
    let n = 100_000;
    let mut times: [Vec<f64>; 4] = Default::default();
    for _ in 0..7 {
        macro_rules! one {
            ($($k:literal)*) => {$(
                let t = cpu_ns();
                std::hint::black_box(lockstep_prototype::at_level!(
                    level, simd => steps_chain::<_, $k>(simd, balancer, n)
                ));
                times[$k].push((cpu_ns() - t) / (8 * n) as f64);
            )*};
        }
        one!(0 1 2 3);
    }
    for (name, mut t) in ["turning frame", "S", "F", "at rest"].iter().zip(times) {
        t.sort_by(f64::total_cmp);
        println!("step in {name}: median {:.1} least {:.1} ns per run", t[3], t[0]);
    }
}

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    let samples: usize = arguments[1].parse().unwrap();
    let seed: u64 = arguments[2].parse().unwrap();
    let rounds: usize = arguments[3].parse().unwrap();
    let cases = cases(samples, seed);
    let tasks: Vec<Task> = cases.iter().map(task).collect();
    let n = cases.len() as f64;
    if arguments.len() == 4 {
        // Bits do not depend on width.
        lockstep_prototype::driver::set_knobs(0.7, 4.0, 1.0, 1.0);
        let settings = Settings::new(&cases[0].simulation, 100_000_000);
        let level = Level::new();
        let few = &tasks[..tasks.len().min(100)];
        macro_rules! alike {
            ($($k:literal)*) => {$(
                let a = simulate::<1, $k>(level, few, settings).0;
                let wide = simulate::<2, $k>(level, few, settings).0;
                let narrow = level.as_avx2().map(|l| simulate::<2, $k>(Level::Avx2(l), few, settings).0);
                println!(
                    "coordinates {}: 8 and 16 lanes alike {}, AVX2 alike {:?}",
                    $k, a == wide, narrow.map(|n| n == a)
                );
            )*};
        }
        alike!(0 1 2 3);
        micro(&tasks[0].balancer);
        return;
    }
    let store = format!(
        "{}/exact-{samples}-{seed}-{}.txt",
        std::env::temp_dir().display(),
        std::env::var("SPEED").unwrap_or("-216.3772".to_owned())
    );
    type Ends = Vec<(bool, [f64; 2])>;
    let both: Vec<Ends> = match std::fs::read_to_string(&store) {
        Ok(text) => {
            let mut out = vec![Vec::new(), Vec::new()];
            for line in text.lines() {
                let v: Vec<f64> = line.split(' ').map(|x| x.parse().unwrap()).collect();
                out[0].push((v[0] > 0.5, [v[1], v[2]]));
                out[1].push((v[3] > 0.5, [v[4], v[5]]));
            }
            out
        }
        Err(_) => {
            let out: Vec<Ends> = [1e-10, 1e-6]
                .iter()
                .map(|tolerance| cases.iter().map(|c| bare(c, *tolerance)).collect())
                .collect();
            let text: String = out[0]
                .iter()
                .zip(&out[1])
                .map(|(a, b)| {
                    format!(
                        "{} {} {} {} {} {}\n",
                        a.0 as u8, a.1[0], a.1[1], b.0 as u8, b.1[0], b.1[1]
                    )
                })
                .collect();
            std::fs::write(&store, text).unwrap();
            out
        }
    };
    println!("{}", errors("scalar event 1e-6:", &both[1], &both[0]));
    let settings_of = |tolerance: f64| {
        let mut s = cases[0].simulation.clone();
        s.relative_tolerance = tolerance;
        s.absolute_tolerance = tolerance * knob("ABSOLUTE", 0.03);
        Settings::new(&s, 100_000_000)
    };
    // Numbers of events with short steps and a strict tolerance.
    lockstep_prototype::driver::set_knobs(0.9, 0.5, 0.25, 1.0);
    let events: Vec<u32> =
        lock(0, &tasks, settings_of(1e-10)).0.iter().map(|d| d.map_or(0, |d| d.events)).collect();
    println!("events per run {:.3}", events.iter().sum::<u32>() as f64 / n);
    let left = Done {
        ending: Ending::GivenUp,
        time: 0.0,
        state: [0.0; 8],
        steps: 0.0,
        rejected: 0,
        trials: 0,
        events: 0,
        looks: 0,
        all_stick_steps: 0,
    };
    let mut times: Vec<Vec<f64>> = vec![Vec::new(); arguments.len() - 4];
    for round in 0..rounds.max(1) {
        for (k, text) in arguments[4..].iter().enumerate() {
            let v: Vec<f64> = text.split(',').map(|x| x.parse().unwrap()).collect();
            // Single-threaded, and no other thread reads the environment.
            let settings = settings_of(v[1]);
            lockstep_prototype::driver::set_knobs(v[2], v[3], v[4], v.get(5).map_or(1.0, |x| *x));
            let t = cpu_ns();
            let (done, totals) = lock(v[0] as usize, &tasks, settings);
            // The clock is coarse.
            let repeats = if rounds > 1 { 2000 / cases.len() } else { 0 };
            for _ in 0..repeats {
                lock(v[0] as usize, &tasks, settings);
            }
            times[k].push((cpu_ns() - t) / (n * (1 + repeats) as f64) / 1e3);
            if round > 0 {
                continue;
            }
            let done: Vec<Done> = done.iter().map(|d| d.unwrap_or(left)).collect();
            let mean = |f: &dyn Fn(&Done) -> f64| done.iter().map(f).sum::<f64>() / n;
            // What is given up is left to the scalar code.
            let ends: Ends = done
                .iter()
                .zip(&both[1])
                .map(|(d, scalar)| match d.ending {
                    Ending::GivenUp => *scalar,
                    ending => (ending == Ending::Rest, [d.state[4], d.state[5]]),
                })
                .collect();
            let other = done.iter().zip(&events).filter(|(d, e)| d.events != **e).count();
            let near = done
                .iter()
                .zip(&events)
                .zip(ends.iter().zip(&both[0]))
                .filter(|((d, e), (a, b))| {
                    d.events != **e && a.0 && b.0 && (a.1[0] - b.1[0]).abs() < 1e-2
                })
                .count();
            println!(
                "    runs with other numbers of events {other}, ending at the same place {near}"
            );
            println!(
                "{text}: steps {:.0} rejected {:.1} trials {:.1} events {:.3} looks {:.1} rhs {:.0} time {:.0} given up {} occupancy {:.3} bare {:.0}",
                mean(&|d| d.steps),
                mean(&|d| d.rejected as f64),
                mean(&|d| d.trials as f64),
                mean(&|d| d.events as f64),
                mean(&|d| d.looks as f64),
                mean(&|d| d.steps) * if v[0] == 2.0 { 13.0 } else { 12.0 },
                mean(&|d| d.time),
                done.iter().filter(|d| d.ending == Ending::GivenUp).count(),
                totals.lane_steps as f64 / (8.0 * totals.vector_steps as f64),
                times[k][0],
            );
            println!("    {}", errors("", &ends, &both[0]));
        }
    }
    for (k, text) in arguments[4..].iter().enumerate() {
        times[k].sort_by(f64::total_cmp);
        println!(
            "{text}: median {:.1} least {:.1} us per run",
            times[k][times[k].len() / 2],
            times[k][0]
        );
    }
}
