//! Friction dissipates energy under every law; constant dry friction dissipates exactly force times
//! distance.

use std::sync::Arc;

use crate::support::{Block, SliderState};
use stickslip::model::{Balancer, FrictionLaw, Machine, Method, State, System};
use stickslip::motion::{Settings, Tolerance, all_stick};

use crate::support::{for_each_kernel, started, state_of};

const METHODS: [Method; 2] = [Method::Event, Method::Switch];
const BAND: f64 = 1e-8;

fn settings(method: Method) -> Settings {
    let tolerance = Tolerance { relative: 1e-11, absolute: 1e-13 };
    Settings { method, band: BAND, tolerance, effort_limit: 10_000_000 }
}

/// Follows a motion and asserts that friction force times sliding speed is never negative, except
/// inside the switch model's band, where a contact in transition has the friction of its
/// acceleration.
#[track_caller]
fn follow<const N: usize, const FREE: usize>(
    system: &Arc<dyn System>,
    method: Method,
    start: State<N, f64, FREE>,
    end: f64,
) -> f64 {
    let mut motion = started(system, settings(method), &start);
    let mut most = 0.0_f64;
    while motion.time() < end {
        motion.advance(end).expect("continues");
        let speeds = state_of::<N, FREE>(&motion).beta_dot;
        for (speed, forces) in speeds.into_iter().zip(motion.now().forces) {
            let power = forces.friction * speed;
            let least = if speed.abs() <= BAND { -system.force_scale() * BAND } else { 0.0 };
            assert!(power >= least, "{power:e} at speed {speed:e}");
            most = most.max(power);
        }
    }
    most
}

#[test]
fn friction_never_does_positive_work_on_balls() {
    for friction in [
        FrictionLaw::COULOMB,
        FrictionLaw::stribeck(6e-3, 5.0),
        FrictionLaw::stribeck(4e-3, 0.0),
        FrictionLaw::smooth(1.0),
        FrictionLaw::viscous(2e-4),
        FrictionLaw::coulomb_viscous(2e-4),
    ] {
        let machine = Machine { friction, ..Machine::default() };
        let balancer = Balancer::<2>::new(&machine).expect("two balls");
        for k in 0..6 {
            let spread = |factor: f64| (f64::from(k) * factor + 0.3).sin();
            let start = State {
                position: [0.05 * spread(1.1), 0.05 * spread(2.3)],
                velocity: [0.05 * spread(5.9), 0.05 * spread(7.3)],
                beta: [3.0 + 3.0 * spread(3.1), 3.0 + 3.0 * spread(4.7)],
                beta_dot: [spread(8.9), spread(10.7)],
            };
            for system in for_each_kernel(balancer) {
                for method in METHODS {
                    let most = follow(&system, method, start, 200.0);
                    assert!(most > 1e-6, "{friction:?}: friction that does anything: {most:e}");
                }
            }
        }
    }
}

/// With constant friction the energy loss is friction times distance: from `(0, 1.7)` in
/// non-dimensional form to rest at `x`, `½ 1.7² - ½ x² = μ s`.
#[test]
fn dry_friction_dissipates_force_times_distance() {
    for method in METHODS {
        let slider = Block::without_units(FrictionLaw::COULOMB).system();
        let start = SliderState { position: [], velocity: [], beta: [0.0], beta_dot: [1.7] };
        let mut motion = started(&slider, settings(method), &start);
        let (mut way, mut energy) = (0.0, 0.5 * 1.7 * 1.7);
        while !all_stick(motion.phases()) {
            let before = motion.state()[0];
            let turn = motion.advance(1000.0).map(|_| {
                let velocity = |direction: f64| move |s: &[f64]| direction * s[1];
                let forth = motion.falls_through_zero(velocity(1.0));
                forth.or_else(|| motion.falls_through_zero(velocity(-1.0)))
            });
            let turn = turn.expect("continues").map_or(before, |(_, state)| state[0]);
            let SliderState { beta: [x], beta_dot: [v], .. } = state_of(&motion);
            way += (turn - before).abs() + (x - turn).abs();
            let now = 0.5 * (x * x + v * v);
            assert!(now <= energy + 1e-11, "{now} {energy}");
            energy = now;
        }
        let lost = 0.5 * 1.7 * 1.7 - energy;
        assert!((lost - 0.1 * way).abs() < 1e-8, "{method:?}: {lost} {way}");
    }
}

/// With Coulomb friction and viscous drag on rigid ground, the energy loss is Coulomb friction times distance plus the
/// integral of the drag times the speed, `μ s + ∫ c v² dt`, by Simpson's rule within each step.
#[test]
fn dry_and_viscous_friction_dissipate_force_times_distance_and_speed() {
    let drag = 0.25;
    let friction = FrictionLaw::coulomb_viscous(drag);
    for method in METHODS {
        let slider = Block::without_units(friction).system();
        let start = SliderState { position: [], velocity: [], beta: [0.0], beta_dot: [1.7] };
        let mut motion = started(&slider, settings(method), &start);
        let mut work = 0.0;
        while !all_stick(motion.phases()) {
            let time = motion.time();
            motion.advance(time + 0.02).expect("continues");
            let length = motion.time() - time;
            let power = |part: f64| {
                let state = motion.within_last_step(time + part * length).expect("inside");
                let speed = state[1].abs();
                0.1 * speed + drag * speed * speed
            };
            work += length / 6.0 * (power(0.0) + 4.0 * power(0.5) + power(1.0));
        }
        let x = motion.state()[0];
        let lost = 0.5 * 1.7 * 1.7 - 0.5 * x * x;
        println!("{method:?}: {lost} {work} at {x}");
        assert!((lost - work).abs() < 1e-8, "{method:?}: {lost} {work}");
    }
}

/// Under the viscous law on rigid ground, energy decreases at every step, to zero.
#[test]
fn viscous_friction_dissipates_all_energy() {
    let friction = FrictionLaw::viscous(0.1);
    let slider = Block::without_units(friction).system();
    let start = SliderState { position: [], velocity: [], beta: [0.5], beta_dot: [-1.7] };
    follow(&slider, Method::Event, start, 400.0);
    let mut motion = started(&slider, settings(Method::Event), &start);
    let mut energy = f64::MAX;
    while motion.time() < 400.0 {
        motion.advance(400.0).expect("continues");
        let now = motion.state()[0].powi(2) + motion.state()[1].powi(2);
        assert!(now <= energy);
        energy = now;
    }
    assert!(energy < 1e-12, "{energy}");
}
