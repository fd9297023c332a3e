//! The exact motion is the limit of the switch model, and does not depend on the steps.

use std::sync::Arc;

use stickslip::model::{Balancer, Method, State, System};
use stickslip::motion::{Failure, Motion, Settings};

use super::samples::{Sampler, difference, moved, settings};
use crate::support::{for_each_kernel, go_on, started};

/// Follows a motion until a time, unless a ball leaves the ring; any other failure fails the test.
fn follow<const N: usize>(
    system: &Arc<dyn System>,
    settings: Settings,
    state: State<N>,
    pieces: u32,
) -> Option<Motion> {
    let try_it = || {
        let mut motion = Motion::new(system, settings, &state.components())?;
        for piece in 1..=pieces {
            let until = 6.0 * f64::from(piece) / f64::from(pieces);
            while motion.time() < until {
                motion.advance(until)?;
            }
        }
        Ok(motion)
    };
    match try_it() {
        Ok(motion) => Some(motion),
        Err(Failure::ContactLost { .. }) => None,
        Err(failure) => panic!("{failure}: {system:?} {state:?}"),
    }
}

/// For thousands of machines and starts there is no failure and the number of switches is small.
/// The distance to the switch model with a band of 1e-8 is the band times the growth of errors over
/// a few periods.
fn compare<const N: usize>(seeds: std::ops::Range<u64>) -> Vec<f64> {
    let mut apart = Vec::new();
    for seed in seeds {
        let mut sampler = Sampler::new(seed);
        let machine = sampler.machine(N);
        let balancer = Balancer::<N>::new(&machine).expect("as many balls");
        let state = sampler.state(&balancer);
        for system in for_each_kernel(balancer) {
            let motions = [Method::Event, Method::Switch]
                .map(|method| follow(&system, settings(method, 1e-10), state, 1));
            if let [Some(exact), Some(switch)] = motions {
                assert!(exact.effort().switches < 100, "{seed}: {:?}", exact.effort());
                apart.push(difference(&exact, &switch));
            }
        }
    }
    apart.sort_by(f64::total_cmp);
    apart
}

#[test]
fn fuzz_against_the_switch_model() {
    let apart = [
        compare::<1>(0..1500),
        compare::<2>(1500..3000),
        compare::<3>(3000..4500),
        compare::<4>(4500..6000),
    ];
    for (balls, apart) in (1..).zip(apart) {
        let (median, worst) = (apart[apart.len() / 2], apart[apart.len() - 1]);
        println!("{balls} balls, {} motions: median {median:e}, worst {worst:e}", apart.len());
        assert!(apart.len() > 2000 && median < 1e-10 && worst < 2e-6, "{balls} balls: {worst:e}");
    }
}

/// A motion does not change if it is divided into 600 pieces, so that no force can rise and fall
/// undetected inside a step. Seed 3798 is a former defect: a force swung from one friction limit to
/// the other within a step.
#[test]
fn no_event_inside_a_step_is_missed() {
    let mut worst: f64 = 0.0;
    for seed in 0..1500 {
        let mut sampler = Sampler::new(seed);
        let balancer = Balancer::<3>::new(&sampler.machine(3)).expect("three balls");
        let state = sampler.state(&balancer);
        for system in for_each_kernel(balancer) {
            let [whole, pieces] = [1, 600]
                .map(|pieces| follow(&system, settings(Method::Event, 1e-10), state, pieces));
            if let (Some(whole), Some(pieces)) = (whole, pieces) {
                worst = worst.max(difference(&whole, &pieces));
                assert!(difference(&whole, &pieces) < 1e-8, "{seed}");
            }
        }
    }
    println!("worst {worst:e}");
}

/// A swing that is strong against the friction limit takes the force beyond both limits and back
/// between two samples of a coarse step.
#[test]
fn a_force_may_cross_both_limits_in_one_step() {
    let mut missed = Vec::new();
    let (mut moves, mut worst) = (0, 0.0_f64);
    for seed in 0..2000 {
        let mut sampler = Sampler::new(seed);
        let mut machine = stickslip::model::Machine::default();
        machine.balls.iter_mut().for_each(|ball| ball.friction_coefficient = 2.75e-4);
        machine.balls[0].friction_coefficient = sampler.between(1e-3, 2e-2);
        let balancer = Balancer::<2>::new(&machine).expect("two balls");
        let mut state = sampler.state(&balancer);
        state.position = state.position.map(|position| 0.1 * position);
        state.beta_dot = [0.0; 2];
        for system in for_each_kernel(balancer) {
            let whole = moved(&system, settings(Method::Event, 1e-8), state, 3.0);
            let mut pieces = started(&system, settings(Method::Event, 1e-8), &state);
            (1..=100).for_each(|piece| _ = go_on(&mut pieces, 0.03 * f64::from(piece)));
            moves += whole.effort().switches;
            worst = worst.max(difference(&whole, &pieces));
            if difference(&whole, &pieces) > 1e-6 {
                missed.push(seed);
            }
        }
    }
    println!("worst {worst:e}");
    assert!(moves > 4000 && missed.is_empty(), "{moves} {missed:?}");
}
