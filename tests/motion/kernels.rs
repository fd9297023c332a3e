//! The kernel that is written for the balancer against the general one, step by step.

use std::sync::Arc;
use std::thread;

use stickslip::model::{Balancer, Components, FrictionLaw, Machine, Method, System};
use stickslip::motion::{Motion, Phase, Settings, Tolerance};

use super::samples::Sampler;
use crate::support::{
    METHODS, angular_distance, for_each_kernel, go_on, settings, spread_start, start_of,
};

/// Returns a random machine: of six machines, one has viscous drag and one has Coulomb friction and viscous drag.
fn machine(sampler: &mut Sampler, balls: usize) -> Machine {
    let mut machine = sampler.machine(balls);
    machine.friction = match sampler.between(0.0, 6.0) {
        ..1.0 => FrictionLaw::viscous(1e-4),
        ..2.0 => FrictionLaw::coulomb_viscous(1e-3),
        _ => FrictionLaw::COULOMB,
    };
    machine
}

/// Compares steps of a motion with those of the general kernel from the same states. Counts smooth steps of balls that stick,
/// slip and are in transition, and switches.
fn compare<const N: usize>(seeds: std::ops::Range<u64>, method: Method, seen: &mut [usize; 4]) {
    // A wide band, in which a ball takes some time.
    let tolerance = Tolerance { relative: 1e-13, absolute: 1e-15 };
    let settings = Settings { method, band: 1e-3, tolerance, effort_limit: 200_000 };
    for seed in seeds {
        let mut sampler = Sampler::new(seed);
        let balancer = Balancer::<N>::new(&machine(&mut sampler, N)).expect("as many balls");
        let mut state = sampler.state(&balancer);
        // Half of the balls begin in the band.
        for speed in &mut state.beta_dot {
            *speed *= sampler.one_of(&[1.0, 1e-3]);
        }
        let [tuned_system, general_system] = for_each_kernel(balancer);
        let mut components = state.components();
        for _ in 0..12 {
            let Ok(mut tuned) = Motion::new(&tuned_system, settings, &components) else { break };
            let mut general = Motion::new(&general_system, settings, &components).expect("starts");
            assert_eq!(tuned.phases(), general.phases(), "{seed}");
            let Ok(switches) = tuned.advance(0.3) else { break };
            let during = tuned.phases_during_step();
            let mut switched = false;
            while general.time() < tuned.time() && !switched {
                switched = general.advance(tuned.time()).expect("continues");
                assert_eq!(general.phases_during_step(), during, "{seed}");
            }
            if switches && !switched {
                // The other kernel locates it a little later.
                switched = general.advance(tuned.time() + 1e-9).expect("continues");
            }
            assert_eq!(switches, switched, "{seed}");
            let late = (tuned.time() - general.time()).abs();
            let [found, expected] = [&tuned, &general]
                .map(|motion| motion.within_last_step(motion.time()).expect("the step's end"));
            // The motions may have begun their latest steps in other turns.
            let apart = found.iter().zip(&expected).enumerate().map(|(component, (a, b))| {
                let angular = (4..4 + N).contains(&component);
                if angular { angular_distance(*a, *b) } else { (a - b).abs() }
            });
            let apart = apart.fold(0.0, f64::max);
            if switches {
                seen[3] += 1;
                assert!(late < 1e-10, "{seed}: {late:e}");
                assert!(apart < 1e-12 + 10.0 * late, "{seed}: {apart:e} {late:e}");
                assert_eq!(tuned.phases(), general.phases(), "{seed}");
            } else {
                for phase in during {
                    match phase {
                        Phase::Stick => seen[0] += 1,
                        Phase::Slip(_) => seen[1] += 1,
                        Phase::Transition(_) => seen[2] += 1,
                        Phase::Free | Phase::Apart | Phase::Open | Phase::Closed => {}
                    }
                }
                assert!(apart < 1e-13, "{seed}: {apart:e} after {}, {during:?}", tuned.time());
            }
            components = tuned.state();
        }
    }
}

/// In smooth steps the states agree to rounding, in all phases; switches agree to the width within which they are
/// located.
#[test]
fn kernels_agree_in_every_step() {
    for method in [Method::Switch, Method::Event] {
        let mut seen = [0; 4];
        compare::<1>(0..150, method, &mut seen);
        compare::<2>(150..300, method, &mut seen);
        compare::<4>(300..400, method, &mut seen);
        let [stick, slip, transition, switches] = seen;
        assert!(stick > 1000 && slip > 1000 && switches > 100, "{seen:?}");
        assert!(method == Method::Event || transition > 30, "{seen:?}");
    }
}

/// Lanes that another motion has used change no bit of a later motion on the same thread, whether the other motion has the
/// same kernel or not.
#[test]
fn lanes_used_before_change_no_bit() {
    let start = start_of::<2>(&spread_start(1)).components();
    let unit = |place: usize| {
        (0..start.len()).map(|other| if other == place { 1.0 } else { 0.0 }).collect::<Components>()
    };
    let directions: Vec<_> = (0..start.len()).map(unit).collect();
    let machines = [Machine::default(), Machine { speed_rad_s: -216.0, ..Machine::default() }];
    let systems = machines
        .map(|machine| for_each_kernel(Balancer::<2>::new(&machine).expect("as many balls")));
    let systems: Vec<_> = systems.into_iter().flatten().collect();
    let end = |system: &Arc<dyn System>, method: Method| {
        let settings = settings(method, 1e-6);
        let alone = Motion::new(system, settings, &start).expect("starts").state();
        let mut motion =
            Motion::with_directions(system, settings, &start, &directions).expect("starts");
        go_on(&mut motion, 20.0);
        (alone, motion.state(), motion.perturbations())
    };
    for method in METHODS {
        // A thread begins without lanes.
        let in_new_lanes = |system: &Arc<dyn System>| {
            thread::scope(|threads| threads.spawn(|| end(system, method)).join().expect("no panic"))
        };
        let expected: Vec<_> = systems.iter().map(in_new_lanes).collect();
        assert_ne!(expected[0], expected[1], "kernels differ by rounding");
        for which in [0, 1, 2, 3, 1, 0, 3, 2] {
            assert_eq!(end(&systems[which], method), expected[which], "{method:?} {which}");
        }
    }
}
