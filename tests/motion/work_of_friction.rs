//! Friction dissipates energy under every law; constant dry friction dissipates exactly force times
//! distance.

use std::sync::Arc;

use crate::support::{Block, SliderState};
use stickslip::model::{Balancer, FrictionLaw, Machine, Method, State, System};
use stickslip::motion::{Settings, all_stick};

use crate::support::{self, METHODS, for_each_kernel, spread_start, start_of, started, state_of};

const BAND: f64 = 1e-8;

fn settings(method: Method) -> Settings {
    Settings { band: BAND, ..support::settings(method, 1e-11) }
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
            let start: State<2> = start_of(&spread_start(k));
            for system in for_each_kernel(balancer) {
                for method in METHODS {
                    let most = follow(&system, method, start, 200.0);
                    assert!(most > 1e-6, "{friction:?}: friction that does anything: {most:e}");
                }
            }
        }
    }
}

/// With Coulomb friction, and with viscous drag besides, on rigid ground, the energy loss is Coulomb friction times distance plus the
/// integral of the drag times the speed, `μ s + ∫ c v² dt`, by Simpson's rule within each step.
#[test]
fn dry_and_viscous_friction_dissipate_force_times_distance_and_speed() {
    let laws = [(FrictionLaw::COULOMB, 0.0), (FrictionLaw::coulomb_viscous(0.25), 0.25)];
    for (method, (friction, drag)) in METHODS.into_iter().flat_map(|one| laws.map(|law| (one, law)))
    {
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
