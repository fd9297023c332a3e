//! Tests of the tuned kernel against the general one, which evaluates recorded equations: balls that touch.

use std::sync::Arc;

use fearless_simd::SimdBase;

use super::kernel::TunedKernel;
use crate::model::{Ball, BallContact, Components, Machine, Method, Model, Start, System};
use crate::motion::condition::Condition;
use crate::motion::lockstep::general::GeneralKernel;
use crate::motion::lockstep::kernel::{Kernel, StepEnd};
use crate::motion::lockstep::kernel_lanes::KernelLanes;
use crate::motion::lockstep::lane_group::LaneGroup;
use crate::motion::lockstep::simd_level::tested_vectors;
use crate::motion::lockstep::vector::Vector;
use crate::motion::lockstep::{LANES, Lanes, SavedRun};
use crate::motion::{Phase, Settings, Tolerance, any_closed};

/// Length of the step.
const LENGTH: f64 = 0.5;

/// A number between -1 and 1.
fn value(of: usize, lane: usize) -> f64 {
    libm::sin((1 + of + 31 * lane) as f64 * 1.7)
}

/// A machine with contact between its balls.
fn machine(balls: usize) -> Machine {
    let machine = Machine::default();
    let ball = machine.balls[0];
    let balls =
        (0..balls).map(|index| Ball { mass_kg: ball.mass_kg * (1.0 + 0.1 * index as f64), ..ball });
    Machine {
        speed_rad_s: -216.3772,
        ring_runout_m: 2e-5,
        ring_runout_angle_rad: 1.0,
        balls: balls.collect(),
        contact: Some(BallContact { restitution: 0.4, friction_coefficient: 0.1 }),
        ..machine
    }
}

/// A run that begins in a lane: balls touch, touch at rest, or are apart.
fn run(machine: &Machine, method: Method, lane: usize) -> SavedRun {
    let balls = machine.balls.len();
    let mut angle = 3.0 + 2.0 * value(3, lane);
    let mut angles = vec![angle];
    for two in machine.balls.windows(2) {
        let apart = if lane % 4 == 3 { 0.3 } else { 0.0 };
        angle += machine.contact_angle_rad(&two[0], &two[1]) + apart;
        angles.push(angle);
    }
    let speed = if lane.is_multiple_of(3) { 1e-4 } else { 0.4 * value(7, lane) };
    let start = Start::of_balancer(
        [0.01 * value(0, lane), 0.01 * value(1, lane)],
        &angles,
        [0.01 * value(4, lane), 0.01 * value(5, lane)],
        &vec![speed; balls],
    );
    let model = Model::BallBalancer(machine.clone());
    let stage = model.stages(&start, 10.0).expect("stages").swap_remove(0);
    let state = model.start_state(&start).expect("a state of the machine");
    let (state, _) = stage.entered(None, &state);
    let band = if method == Method::Switch { 1e-3 } else { 0.0 };
    let tolerance = Tolerance { relative: 1e-8, absolute: 1e-10 };
    let settings = Settings { method, band, tolerance, effort_limit: 1000 };
    let system: Arc<dyn System> = stage.system;
    SavedRun::start(&system, settings, &state).expect("starts")
}

/// What a kernel computes in a step.
struct Step {
    ends: Vec<Components>,
    perturbations: Vec<Components>,
    /// The series of all components in each lane, summed up at the end of the step.
    sums: Vec<Vec<f64>>,
    lanes_to_examine: u64,
    events: Vec<StepEnd>,
}

fn step<S: Vector, K: Kernel<S>>(simd: S, kernel: K, runs: &[SavedRun]) -> Step {
    let mut group = KernelLanes::new(simd, kernel);
    for (lane, run) in runs.iter().enumerate() {
        group.put(lane, run, 100.0);
        let direction: Vec<f64> = (0..run.state.len()).map(|of| value(of, lane + 50)).collect();
        let mut direction = Components::from_vec(direction);
        // Balls that touch move together.
        let balls = group.kernel.contacts();
        for ball in 1..balls {
            direction[4 + ball] = direction[4];
            direction[4 + balls + ball] = direction[4 + balls];
        }
        group.perturb(lane, &direction);
    }
    let length = Lanes::splat(simd, LENGTH);
    let KernelLanes { kernel, workspace, state, perturbation, lanes, .. } = &mut group;
    kernel.expand(workspace, state, true);
    let lanes_to_examine = kernel.screen_conditions(workspace, length);
    let mut end = state.clone();
    kernel.at(workspace, state, length, &mut end);
    let first_event = |(lane, run): (usize, &Option<_>)| {
        let run = run.as_ref().expect("all lanes have runs");
        kernel.first_event(workspace, run, lane, LENGTH, &[])
    };
    let events = lanes.iter().enumerate().map(first_event).collect();
    let sums = (0..LANES).map(|lane| {
        let start = kernel.lane(state, lane);
        let sum = |component: usize| {
            let powers = kernel.component(workspace, lane, component, start[component]);
            powers.iter().rev().fold(0.0, |sum, power| sum * LENGTH + power)
        };
        (0..start.len()).map(sum).collect()
    });
    let sums = sums.collect();
    let moved = kernel.propagate(workspace, perturbation, length);
    Step {
        ends: (0..LANES).map(|lane| kernel.lane(&end, lane)).collect(),
        perturbations: (0..LANES).map(|lane| kernel.lane(&moved, lane)).collect(),
        sums,
        lanes_to_examine,
        events,
    }
}

/// Compares both kernels in all lanes. Returns the number of steps that end with an event, and of those that obviously do not.
fn agree<const N: usize>(simd: impl Vector, method: Method) -> (usize, usize) {
    let machine = machine(N);
    let runs: Vec<SavedRun> = (0..LANES).map(|lane| run(&machine, method, lane)).collect();
    let touches = |run: &SavedRun| any_closed(&run.lane.phases);
    let touching = runs.iter().filter(|run| touches(run));
    let slipping = |run: &&SavedRun| run.lane.phases[0] != Phase::Stick;
    assert!(touching.clone().any(|run| slipping(&run)) && touching.count() < LANES);
    let tuned = step(simd, TunedKernel::<_, N>::new(simd), &runs);
    let general = step(simd, GeneralKernel::new(simd, runs[0].system()), &runs);
    let (mut located, mut obvious) = (0, 0);
    for (lane, run) in runs.iter().enumerate() {
        let close = |tuned: &[f64], general: &[f64], most: f64| {
            assert_eq!(tuned.len(), general.len());
            for (component, (tuned, general)) in tuned.iter().zip(general).enumerate() {
                let phases = &run.lane.phases;
                assert!(
                    (tuned - general).abs() < most,
                    "{component} of {lane}: {tuned} {general} {phases:?}"
                );
            }
        };
        close(&tuned.ends[lane], &general.ends[lane], 1e-13);
        close(&tuned.sums[lane], &general.sums[lane], 1e-13);
        // The reaction of the table on balls that touch is missing in the highest powers (`perturbation`).
        close(&tuned.perturbations[lane], &general.perturbations[lane], 1e-9);
        match (&tuned.events[lane], &general.events[lane]) {
            (StepEnd::At(part, which), StepEnd::At(expected, same)) => {
                // Balls that touch stop together: rounding decides which of them is first.
                let together = |condition: &Condition| match condition {
                    Condition::Contact { which, .. } if touches(run) => Some(*which),
                    _ => None,
                };
                let agrees =
                    which == same || together(which).is_some_and(|of| together(same) == Some(of));
                assert!(
                    agrees && (part - expected).abs() < 1e-9,
                    "{part} {expected} of {lane}: {which:?} {same:?}"
                );
                located += 1;
            }
            (StepEnd::AtOnce(which), StepEnd::AtOnce(same)) => assert_eq!(which, same),
            (StepEnd::Nothing, StepEnd::Nothing) => {
                obvious += usize::from(tuned.lanes_to_examine & 1 << lane == 0);
                continue;
            }
            _ => panic!("another end of the step in {lane}"),
        }
        assert!(tuned.lanes_to_examine & 1 << lane != 0, "no doubt in {lane}");
    }
    (located, obvious)
}

#[test]
fn balls_that_touch() {
    let Some(simd) = tested_vectors() else { return };
    let counts = [
        agree::<2>(simd, Method::Event),
        agree::<2>(simd, Method::Switch),
        agree::<4>(simd, Method::Event),
    ];
    assert!(counts.iter().all(|(located, obvious)| *located > 0 && *obvious > 0), "{counts:?}");
}
