//! Tests of the series of eight different machines side by side, over their longest steps, against the equations of motion,
//! integrated by another method.

use std::sync::Arc;

use fearless_simd::SimdBase;

use super::equations::contact_along;
use super::kernel::{BalancerWorkspace, TunedKernel};
use super::perturbation::propagate;
use crate::model::{Balancer, Dual, FrictionLaw, Machine, Method, Number, State, System};
use crate::motion::lockstep::SavedRun;
use crate::motion::lockstep::kernel::Kernel;
use crate::motion::lockstep::kernel_lanes::KernelLanes;
use crate::motion::lockstep::lane_group::LaneGroup;
use crate::motion::lockstep::simd_level::tested_vectors;
use crate::motion::lockstep::vector::Vector;
use crate::motion::lockstep::{LANES, Lanes};
use crate::motion::{Phase, Settings, Tolerance};

/// Number of intervals in the tableau of extrapolation: Gragg's method has an expansion in even powers, so that eight
/// of them give order 16.
const INTERVALS: [u32; 8] = [2, 4, 6, 8, 10, 12, 14, 16];

/// Returns a balancer's state and a perturbation after a time: Gragg's extrapolated midpoint rule on the hand-written
/// equations in dual numbers (E. Hairer, S. P. Nørsett, G. Wanner, *Solving Ordinary Differential Equations I*, 2nd
/// ed., Springer 1993, section II.9).
fn integrated<const N: usize>(
    balancer: &Balancer<N>,
    phases: &[Phase],
    start: &State<N, Dual>,
    (time, parts): (f64, u32),
) -> State<N, Dual> {
    let dual = balancer.lifted::<Dual>();
    let rate = |state: &State<N, Dual>| {
        let contacts = std::array::from_fn(|ball| {
            let friction = &balancer.balls[ball].friction;
            contact_along(phases[ball], friction, state.beta_dot[ball])
        });
        dual.derivative(state, &contacts, &dual.forces(state, &contacts))
    };
    let length = time / f64::from(parts);
    (0..parts).fold(*start, |state, _| extrapolated(rate, &state, length))
}

fn extrapolated<const N: usize>(
    rate: impl Fn(&State<N, Dual>) -> State<N, Dual>,
    start: &State<N, Dual>,
    length: f64,
) -> State<N, Dual> {
    let ahead = |from: &State<N, Dual>, by: f64, rate: &State<N, Dual>| {
        let mut state = *from;
        state.add_scaled(Dual::constant(by), rate);
        state
    };
    // Changes from the start state, which have smaller rounding errors than states.
    let first = rate(start);
    let at = |change: &State<N, Dual>| rate(&ahead(start, 1.0, change));
    let mut row: Vec<State<N, Dual>> = Vec::new();
    for (index, &intervals) in INTERVALS.iter().enumerate() {
        let step = length / f64::from(intervals);
        let (mut before, mut now) = (State::zero(), ahead(&State::zero(), step, &first));
        for _ in 1..intervals {
            (before, now) = (now, ahead(&before, 2.0 * step, &at(&now)));
        }
        let mut next = vec![now];
        for (column, coarser) in row.iter().enumerate() {
            let ratio = f64::from(intervals) / f64::from(INTERVALS[index - 1 - column]);
            let mut better = next[column];
            let mut change = better;
            change.add_scaled(Dual::constant(-1.0), coarser);
            better.add_scaled(Dual::constant(1.0 / (ratio * ratio - 1.0)), &change);
            next.push(better);
        }
        row = next;
    }
    ahead(start, 1.0, &row[INTERVALS.len() - 1])
}

fn machine(lane: usize, balls: usize) -> Machine {
    let mut machine = Machine::default();
    machine.balls.resize(balls, machine.balls[0]);
    machine.speed_rad_s = -150.0 - 20.0 * lane as f64;
    for (index, ball) in machine.balls.iter_mut().enumerate() {
        ball.mass_kg *= 1.0 + 0.3 * index as f64;
        ball.friction_coefficient *= 1.0 + lane as f64;
    }
    if lane == 6 {
        (machine.ring_runout_m, machine.ring_runout_angle_rad) = (3e-5, 2.0);
    }
    if lane == 5 {
        machine.friction = FrictionLaw::viscous(3e-3);
    } else if lane == 2 {
        machine.friction = FrictionLaw::coulomb_viscous(3e-3);
    }
    machine
}

fn state<const N: usize>(lane: usize, stuck: impl Fn(usize) -> f64) -> State<N> {
    let value = |k: usize| libm::sin((7 * lane + 3 * k) as f64);
    State {
        position: [0.02 * value(0), 0.03 * value(1)],
        velocity: [0.04 * value(2), 0.05 * value(3)],
        beta: std::array::from_fn(|ball| 3.0 + 3.0 * value(4 + ball)),
        // Every other ball rests, or has a residual speed.
        beta_dot: std::array::from_fn(|ball| {
            if (ball + lane).is_multiple_of(3) { stuck(ball) } else { 0.4 + 0.3 * value(9 + ball) }
        }),
    }
}

fn largest<const N: usize>(state: &State<N>) -> f64 {
    let State { position, velocity, beta, beta_dot } = state;
    let all = position.iter().chain(velocity).chain(beta).chain(beta_dot);
    all.fold(0.0, |most: f64, value| most.max(value.abs()))
}

/// Perturbations over the longest steps of a coarse tolerance agree with the equations. The table moves
/// slowly, as after some time, and is perturbed in proportion to the balls.
fn over_longest_steps<const N: usize>(simd: impl Vector) {
    let settings = Settings {
        method: Method::Event,
        band: 0.0,
        tolerance: Tolerance { relative: 1e-6, absolute: 1e-8 },
        effort_limit: 1000,
    };
    let mut group = KernelLanes::new(simd, TunedKernel::<_, N>::new(simd));
    let balancers: Vec<Balancer<N>> =
        (0..LANES).map(|lane| Balancer::new(&machine(lane, N)).expect("N balls")).collect();
    let mut longest = Lanes::splat(simd, 0.0);
    for (lane, balancer) in balancers.iter().enumerate() {
        let mut start = state::<N>(lane, |_| 0.0);
        let rest = balancer.rest_point(&start.beta);
        let [x, y] = rest.position;
        (start.position, start.velocity) = ([x, y], [balancer.speed * y, -balancer.speed * x]);
        let system: Arc<dyn System> = Arc::new(*balancer);
        let saved = SavedRun::start(&system, settings, &start.components()).expect("starts");
        group.put(lane, &saved, 100.0);
        let mut perturbed: State<N> = state(lane + 100, |_| 0.3);
        for axis in 0..2 {
            perturbed.position[axis] *= 1e-2;
            perturbed.velocity[axis] *= 1e-2;
        }
        perturbed.beta = perturbed.beta.map(|angle| angle / 6.0);
        group.perturb(lane, &perturbed.components());
        longest[lane] = group.longest(lane);
    }
    let KernelLanes { kernel, workspace, state, perturbation, tolerance, next, .. } = &mut group;
    kernel.expand(workspace, state, false);
    let lengths = kernel.within_tolerance(workspace, *tolerance, *next).min(longest);
    let BalancerWorkspace { series, perturbed, .. } = &mut **workspace;
    let moved = propagate(series, &kernel.equations, perturbation, lengths, perturbed);
    for (lane, balancer) in balancers.iter().enumerate() {
        let start = group.state.lane(lane).along(&group.perturbation.lane(lane));
        let along = integrated(balancer, group.phases(lane), &start, (lengths[lane], 16));
        let mut difference = along.slope();
        difference.add_scaled(-1.0, &moved.lane(lane));
        assert!(largest(&difference) < 1e-8, "{difference:?} in lane {lane}");
    }
}

#[test]
fn longest_steps() {
    let Some(simd) = tested_vectors() else { return };
    over_longest_steps::<1>(simd);
    over_longest_steps::<2>(simd);
    over_longest_steps::<4>(simd);
}
