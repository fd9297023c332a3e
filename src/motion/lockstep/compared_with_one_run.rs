//! Tests of the series of eight different machines side by side against the equations of one run.

use super::step::within_tolerance;
use super::tangent::carry;
use super::{Flow, Group, LANES, Lanes, Room, Saved, SimdLevel};
use crate::model::{Balancer, Dual, FrictionLaw, Machine, Method, Number, State};
use crate::motion::contact::{Phase, SmoothPhase};
use crate::motion::{Settings, Step, Tolerance};
use fearless_simd::SimdBase;

/// Length of the step.
const LENGTH: f64 = 0.5;
/// Number of steps of one run for comparison.
const PARTS: u32 = 8;

fn machine(lane: usize, balls: usize) -> Machine {
    let mut machine = Machine::default();
    machine.balls.resize(balls, machine.balls[0]);
    machine.speed_rad_s = -150.0 - 20.0 * lane as f64;
    for (index, ball) in machine.balls.iter_mut().enumerate() {
        ball.mass_kg *= 1.0 + 0.3 * index as f64;
        ball.friction_coefficient *= 1.0 + lane as f64;
    }
    if lane == 5 {
        machine.friction = FrictionLaw::viscous(3e-3);
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

/// A state in dual numbers without its slope.
fn value<const N: usize>(state: &State<N, Dual>) -> State<N> {
    State {
        position: state.position.map(|dual| dual.value),
        velocity: state.velocity.map(|dual| dual.value),
        beta: state.beta.map(|dual| dual.value),
        beta_dot: state.beta_dot.map(|dual| dual.value),
    }
}

fn largest<const N: usize>(state: &State<N>) -> f64 {
    let State { position, velocity, beta, beta_dot } = state;
    let all = position.iter().chain(velocity).chain(beta).chain(beta_dot);
    all.fold(0.0, |most: f64, value| most.max(value.abs()))
}

/// Displacements over the longest steps of a coarse tolerance agree with one run. The table moves
/// slowly, as after some time, and is displaced in proportion to the balls.
fn over_longest_steps<const N: usize>() {
    let Some(simd) = SimdLevel::best().avx2() else { return };
    let settings = Settings {
        method: Method::Event,
        band: 0.0,
        tolerance: Tolerance { relative: 1e-6, absolute: 1e-8 },
        effort_limit: 1000,
    };
    let mut group = Group::<_, N>::new(simd);
    let mut room = Room::<_, N>::new(simd);
    let balancers: Vec<Balancer<N>> =
        (0..LANES).map(|lane| Balancer::new(&machine(lane, N)).unwrap()).collect();
    let mut longest = Lanes::splat(simd, 0.0);
    for (lane, balancer) in balancers.iter().enumerate() {
        let mut start = state::<N>(lane, |_| 0.0);
        let rest = balancer.rest_point(&start.beta);
        let [x, y] = rest.position;
        (start.position, start.velocity) = ([x, y], [balancer.speed * y, -balancer.speed * x]);
        group.put(lane, &Saved::start(balancer, settings, start).unwrap(), 100.0);
        let mut displaced: State<N> = state(lane + 100, |_| 0.3);
        for axis in 0..2 {
            displaced.position[axis] *= 1e-2;
            displaced.velocity[axis] *= 1e-2;
        }
        displaced.beta = displaced.beta.map(|angle| angle / 6.0);
        group.displacement.set_lane(lane, &displaced);
        longest[lane] = group.longest(lane);
    }
    room.series.expand(&group.equations, &group.state);
    let lengths = within_tolerance(&room.series, group.tolerance, group.next).min(longest);
    let moved =
        carry(&room.series, &group.equations, &group.displacement, lengths, &mut room.displaced);
    for (lane, balancer) in balancers.iter().enumerate() {
        let saved = group.copy(lane).unwrap();
        let phase = SmoothPhase::new(balancer, &saved.lane.phases);
        let mut along: State<N, Dual> = saved.state.along(&group.displacement.lane(lane));
        for _ in 0..64 {
            let rate = |state: &State<N, Dual>| phase.along(state).1;
            let part = Dual::constant(lengths[lane] / 64.0);
            along = Step::attempt(rate, &along, &rate(&along), part).end;
        }
        let mut difference = along.slope();
        difference.add_scaled(-1.0, &moved.lane(lane));
        assert!(largest(&difference) < 1e-8, "{difference:?} in lane {lane}");
    }
}

#[test]
fn longest_steps() {
    over_longest_steps::<1>();
    over_longest_steps::<2>();
    over_longest_steps::<4>();
}

fn against_one_run<const N: usize>() {
    let Some(simd) = SimdLevel::best().avx2() else { return };
    // A wide band, so that the residual speed of a sticking ball is significant.
    let settings = Settings {
        method: Method::Switch,
        band: 1e-3,
        tolerance: Tolerance { relative: 1e-8, absolute: 1e-10 },
        effort_limit: 1000,
    };
    let mut group = Group::<_, N>::new(simd);
    let mut room = Room::<_, N>::new(simd);
    let balancers: Vec<Balancer<N>> =
        (0..LANES).map(|lane| Balancer::new(&machine(lane, N)).unwrap()).collect();
    for (lane, balancer) in balancers.iter().enumerate() {
        let start = state(lane, |ball| 1e-4 * (ball + 1) as f64);
        let saved = Saved::start(balancer, settings, start).unwrap();
        group.put(lane, &saved, 1.0);
        group.displacement.set_lane(lane, &state(lane + 100, |_| 0.3));
    }
    let length = Lanes::splat(simd, LENGTH);
    room.series.expand(&group.equations, &group.state);
    let end: Flow<_, N> = room.series.at(&group.equations, &group.state, length);
    let moved =
        carry(&room.series, &group.equations, &group.displacement, length, &mut room.displaced);
    let mut sticks = 0;
    for (lane, balancer) in balancers.iter().enumerate() {
        let saved = group.copy(lane).unwrap();
        sticks += saved.lane.phases.iter().filter(|phase| **phase == Phase::Stick).count();
        let phase = SmoothPhase::new(balancer, &saved.lane.phases);
        let mut along: State<N, Dual> = saved.state.along(&group.displacement.lane(lane));
        for _ in 0..PARTS {
            let rate = |state: &State<N, Dual>| phase.along(state).1;
            let part = Dual::constant(LENGTH / f64::from(PARTS));
            along = Step::attempt(rate, &along, &rate(&along), part).end;
        }
        let mut difference = value(&along);
        difference.add_scaled(-1.0, &end.lane(lane));
        assert!(largest(&difference) < 1e-13, "{difference:?} in lane {lane}");
        let mut difference = along.slope();
        difference.add_scaled(-1.0, &moved.lane(lane));
        assert!(largest(&difference) < 1e-11, "{difference:?} in lane {lane}");
        // The series agree with one run's dense output.
        let powers = room.series.powers(lane, &saved.state, LENGTH);
        let mut sum = State::zero();
        powers.iter().for_each(|power| sum.add_scaled(1.0, power));
        sum.add_scaled(-1.0, &end.lane(lane));
        assert!(largest(&sum) < 1e-13, "{sum:?} in lane {lane}");
    }
    assert!(sticks > 0);
}

#[test]
fn one_ball() {
    against_one_run::<1>();
}

#[test]
fn two_balls() {
    against_one_run::<2>();
}

#[test]
fn four_balls() {
    against_one_run::<4>();
}
