//! Tests of both kernels: a ball that leaves the ring within a step is detected, and not too late.

use std::sync::Arc;

use fearless_simd::SimdBase;

use super::general::GeneralKernel;
use super::kernel::{Kernel, StepEnd};
use super::kernel_lanes::KernelLanes;
use super::lane_group::LaneGroup;
use super::simd_level::{tested_vectors, with_each_level};
use super::tuned::{TunedKernel, contact};
use super::vector::Vector;
use super::{LANES, Lanes, SavedRun};
use crate::model::{
    Balancer, Components, FrictionLaw, Machine, Method, NormalForce, State, System,
};
use crate::motion::{Phase, Settings, Tolerance};

/// Number of instants at which the normal forces are examined.
const PLACES: u32 = 400;
const LENGTH: f64 = 0.8;

/// Balls that turn about as fast as the disc, but backwards, have a normal force near zero.
fn machine() -> Machine {
    Machine { speed_rad_s: -216.3772, normal_force: NormalForce::Newton, ..Machine::default() }
}

/// The large drag slows a ball that runs backwards faster than the disc to the disc's speed within a step, even for a
/// small motion of the table.
fn dragged() -> Machine {
    let machine = machine();
    let of_critical_drag = machine.balls[0].mass_kg * machine.natural_frequency_rad_s();
    Machine { friction: FrictionLaw::viscous(of_critical_drag), ..machine }
}

/// Returns whether a normal force is negative by the hand-written equations.
fn leaves(balancer: &Balancer<2>, phases: &[Phase], state: &[f64]) -> bool {
    let state: State<2> = State::of_components(state).expect("two balls");
    let contacts = std::array::from_fn(|ball| {
        contact(phases[ball], &balancer.balls[ball].friction, state.beta_dot[ball])
    });
    balancer.forces(&state, &contacts).normal.iter().any(|normal| *normal < -1e-6)
}

fn seen_in<S: Vector, K: Kernel<S>>(
    simd: S,
    kernel: impl Fn(&Arc<dyn System>) -> K,
    machine: &Machine,
    moved: f64,
) {
    let balancer = Balancer::<2>::new(machine).expect("two balls");
    let system: Arc<dyn System> = Arc::new(balancer);
    let settings = Settings {
        method: Method::Event,
        band: 0.0,
        tolerance: Tolerance { relative: 1e-8, absolute: 1e-10 },
        effort_limit: 1000,
    };
    let (mut left, mut stayed, mut unseen) = (0, 0, 0);
    for round in 0..100 {
        let mut group = KernelLanes::new(simd, kernel(&system));
        let value = |lane: usize, k: usize| {
            libm::sin((1 + 97 * round + 13 * lane) as f64 * (1.0 + 0.37 * k as f64))
        };
        for lane in 0..LANES {
            let start = State {
                position: [moved * value(lane, 0), moved * value(lane, 1)],
                velocity: [moved * value(lane, 2), moved * value(lane, 3)],
                beta: [3.0 + 3.0 * value(lane, 4), 3.0 + 3.0 * value(lane, 5)],
                beta_dot: [
                    -balancer.speed * (1.0 + 0.6 * value(lane, 6)),
                    -balancer.speed * (1.0 + 0.6 * value(lane, 7)),
                ],
            };
            // Some have no positive normal force at the start.
            if let Ok(saved) = SavedRun::start(&system, settings, &start.components()) {
                group.put(lane, &saved, 10.0);
            }
        }
        let KernelLanes { kernel, workspace, state, lanes, .. } = &mut group;
        kernel.expand(workspace, state, false);
        let lanes_to_examine = kernel.screen_conditions(workspace, Lanes::splat(simd, LENGTH));
        for (lane, run) in lanes.iter().enumerate() {
            let Some(run) = run else { continue };
            let start = kernel.lane(state, lane);
            let powers: Vec<_> = (0..start.len())
                .map(|component| kernel.component(workspace, lane, component, start[component]))
                .collect();
            let fails =
                (1..=PLACES).map(|place| f64::from(place) / f64::from(PLACES)).find(|part| {
                    let time = part * LENGTH;
                    let sum = |powers: &[f64]| {
                        powers.iter().rev().fold(0.0, |sum, power| sum * time + power)
                    };
                    let state: Components = powers.iter().map(|powers| sum(powers)).collect();
                    leaves(&balancer, &run.phases, &state)
                });
            let doubted = lanes_to_examine & 1 << lane != 0;
            let Some(fails) = fails else {
                stayed += 1;
                unseen += usize::from(!doubted);
                continue;
            };
            left += 1;
            assert!(doubted, "{round} {lane}: at {fails}");
            match kernel.first_event(workspace, run, lane, LENGTH, &[]) {
                StepEnd::At(part, _) => assert!(part <= fails, "{part} {fails}"),
                StepEnd::AtOnce(_) | StepEnd::Nothing => panic!("{round} {lane}: at {fails}"),
            }
        }
    }
    assert!(left > 50 && stayed > 50 && unseen > 5, "{left} {stayed} {unseen}");
}

#[test]
fn balls_that_leave_the_ring_are_seen_by_the_tuned_kernel() {
    let Some(simd) = tested_vectors() else { return };
    seen_in(simd, |_| TunedKernel::<_, 2>::new(simd), &machine(), 0.3);
    seen_in(simd, |_| TunedKernel::<_, 2>::new(simd), &dragged(), 3e-3);
}

#[test]
fn balls_that_leave_the_ring_are_seen_by_the_general_kernel() {
    with_each_level!(simd => {
        seen_in(simd, |system| GeneralKernel::new(simd, system), &machine(), 0.3);
        seen_in(simd, |system| GeneralKernel::new(simd, system), &dragged(), 3e-3);
    });
}
