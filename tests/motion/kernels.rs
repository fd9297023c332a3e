//! The kernel that is written for the balancer against the general one, step by step.

use stickslip::model::{Balancer, FrictionLaw, Machine, Method};
use stickslip::motion::{Motion, Phase, Settings, Tolerance};

use super::samples::Sampler;
use crate::support::{angular_distance, for_each_kernel};

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
