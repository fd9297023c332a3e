//! The kernel that is written for the balancer against the general one, step by step.

use stickslip::model::{Balancer, FrictionLaw, Machine, Method, State};
use stickslip::motion::{Motion, Phase, Settings, Tolerance};

use super::samples::Sampler;
use crate::support::{angular_distance, for_each_kernel};

/// What has been compared: smooth steps by the phases of their balls, and switches.
#[derive(Default)]
struct Seen {
    stick: usize,
    slip: usize,
    transition: usize,
    switches: usize,
}

fn largest(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

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

/// Compares steps of a motion with those of the general kernel from the same states.
fn compare<const N: usize>(seeds: std::ops::Range<u64>, method: Method, seen: &mut Seen) {
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
        let [tuned, general] = for_each_kernel(balancer);
        let mut components = state.components();
        for _ in 0..12 {
            let Ok(mut one) = Motion::new(&tuned, settings, &components) else { break };
            let mut other = Motion::new(&general, settings, &components).expect("starts");
            assert_eq!(one.phases(), other.phases(), "{seed}");
            let Ok(switches) = one.advance(0.3) else { break };
            let during = one.phases_during_step();
            let mut switched = false;
            while other.time() < one.time() && !switched {
                switched = other.advance(one.time()).expect("continues");
                assert_eq!(other.phases_during_step(), during, "{seed}");
            }
            if switches && !switched {
                // The other kernel locates it a little later.
                switched = other.advance(one.time() + 1e-9).expect("continues");
            }
            assert_eq!(switches, switched, "{seed}");
            let late = (one.time() - other.time()).abs();
            let [found, expected] = [&one, &other]
                .map(|motion| motion.within_last_step(motion.time()).expect("the step's end"));
            // The motions may have begun their latest steps in other turns.
            let apart = found.iter().zip(&expected).enumerate().map(|(component, (a, b))| {
                let angular = (4..4 + N).contains(&component);
                if angular { angular_distance(*a, *b) } else { (a - b).abs() }
            });
            let apart = apart.fold(0.0, f64::max);
            if switches {
                seen.switches += 1;
                assert!(late < 1e-10, "{seed}: {late:e}");
                assert!(apart < 1e-12 + 10.0 * late, "{seed}: {apart:e} {late:e}");
                assert_eq!(one.phases(), other.phases(), "{seed}");
            } else {
                for phase in during {
                    match phase {
                        Phase::Stick => seen.stick += 1,
                        Phase::Slip(_) => seen.slip += 1,
                        Phase::Transition(_) => seen.transition += 1,
                        Phase::Free | Phase::Apart | Phase::Open | Phase::Closed => {}
                    }
                }
                assert!(apart < 1e-13, "{seed}: {apart:e} after {}, {during:?}", one.time());
            }
            components = one.state();
        }
    }
}

/// In smooth steps the states agree to rounding, in all phases; switches agree to the width within which they are
/// located.
#[test]
fn kernels_agree_in_every_step() {
    for method in [Method::Switch, Method::Event] {
        let mut seen = Seen::default();
        compare::<1>(0..150, method, &mut seen);
        compare::<2>(150..300, method, &mut seen);
        compare::<4>(300..400, method, &mut seen);
        let Seen { stick, slip, transition, switches } = seen;
        println!(
            "{method:?}: {stick} stick, {slip} slip, {transition} in transition, {switches} switches"
        );
        assert!(stick > 1000 && slip > 1000 && switches > 100, "{stick} {slip} {switches}");
        assert!(method == Method::Event || transition > 30, "{transition}");
    }
}

/// A displacement is the same for both kernels after every step, with and without switches.
#[test]
fn kernels_carry_the_same_displacements() {
    let tolerance = Tolerance { relative: 1e-13, absolute: 1e-15 };
    let (mut compared, mut switches) = (0, 0);
    for method in [Method::Switch, Method::Event] {
        let settings = Settings { method, band: 1e-3, tolerance, effort_limit: 200_000 };
        for seed in 0..100 {
            let mut sampler = Sampler::new(seed);
            let balancer = Balancer::<2>::new(&machine(&mut sampler, 2)).expect("two balls");
            let start: State<2> = sampler.state(&balancer);
            // More than the lanes of one group.
            let directions: Vec<_> =
                (0..9).map(|_| (0..8).map(|_| sampler.between(-1.0, 1.0)).collect()).collect();
            let motions = for_each_kernel(balancer).map(|system| {
                let start = start.components();
                Motion::with_directions(&system, settings, &start, &directions)
            });
            let [Ok(mut one), Ok(mut other)] = motions else { continue };
            for part in 1..=10 {
                let until = 0.2 * f64::from(part);
                let all = [&mut one, &mut other].map(|motion| {
                    while motion.time() < until {
                        motion.advance(until).ok()?;
                    }
                    Some(motion.perturbations())
                });
                let [Some(found), Some(expected)] = all else { break };
                if one.grazed() || other.grazed() {
                    break;
                }
                assert_eq!((found.len(), expected.len()), (9, 9));
                let size =
                    expected.iter().flatten().fold(1.0_f64, |most, value| most.max(value.abs()));
                let apart = found.iter().zip(&expected).map(|(a, b)| largest(a, b));
                let apart = apart.fold(0.0, f64::max);
                assert!(apart < 1e-9 * size, "{method:?} {seed}: {apart:e} of {size:e} at {until}");
                compared += 1;
            }
            switches += one.effort().switches;
        }
    }
    println!("{compared} compared, {switches} switches");
    assert!(compared > 1000 && switches > 100, "{compared} {switches}");
}
