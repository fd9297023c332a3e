//! The linearised flow against finite differences of whole motions, through stick and slip.

use std::sync::Arc;

use stickslip::model::{Balancer, Components, FrictionLaw, Machine, Method, Model, State, System};
use stickslip::motion::{Motion, Phases, Settings, Tolerance};

use super::samples::{Sampler, unwrapped};
use crate::support::for_each_kernel;

fn fine(method: Method) -> Settings {
    Settings {
        method,
        band: 1e-3,
        tolerance: Tolerance { relative: 1e-12, absolute: 1e-13 },
        effort_limit: 1_000_000,
    }
}

/// Returns the state at `end`, with whole turns, and the phases on the way.
fn flow(motion: &mut Motion, end: f64) -> (Components, Vec<Phases>) {
    let mut phases = vec![Phases::from_slice(motion.phases())];
    while motion.time() < end {
        if let Err(failure) = motion.advance(end) {
            let system = motion.evaluator().system();
            let (time, state, phases) = (motion.time(), motion.state(), motion.phases());
            panic!("{failure} at {time}: {phases:?} {state:?} {system:?}");
        }
        if phases.last().is_some_and(|last| last[..] != *motion.phases()) {
            phases.push(Phases::from_slice(motion.phases()));
        }
    }
    (unwrapped(motion), phases)
}

fn compare(
    system: &Arc<dyn System>,
    settings: Settings,
    start: &[f64],
    end: f64,
    direction: &Components,
) -> Option<(f64, usize)> {
    // More multiples of the direction than the lanes of one group.
    let multiple = |times: u32| direction.iter().map(|by| f64::from(times) * by).collect();
    let directions: Vec<Components> = (1..=9).map(multiple).collect();
    let mut motion = Motion::with_directions(system, settings, start, &directions).expect("starts");
    let (_, phases) = flow(&mut motion, end);
    let shifted = |step: f64| {
        let from: Components =
            start.iter().zip(direction).map(|(value, by)| value + step * by).collect();
        flow(&mut Motion::new(system, settings, &from).expect("starts"), end)
    };
    // Both neighbours must have the same sequence of stick and slip for a comparison.
    let step = 1e-6;
    let (low, high) = (shifted(-step), shifted(step));
    if low.1 != phases || high.1 != phases || motion.grazed() {
        return None;
    }
    let all = motion.perturbations();
    let carried = &all[0];
    let size = carried.iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
    for (times, multiple) in (1..).map(f64::from).zip(&all) {
        let mut pairs = multiple.iter().zip(carried);
        assert!(pairs.all(|(found, once)| (found - times * once).abs() < 1e-9 * times * size));
    }
    assert_eq!(all.len(), 9);
    let difference = low
        .0
        .iter()
        .zip(&high.0)
        .zip(carried)
        .map(|((low, high), carried)| ((high - low) / (2.0 * step) - carried).abs())
        .fold(0.0, f64::max);
    Some((difference / size.max(1.0), phases.len() - 1))
}

/// For random machines, laws and starts, displacements of the linearised flow are those of
/// neighbouring motions.
#[test]
fn carried_displacements_are_those_of_neighbours() {
    let mut sampler = Sampler::new(4);
    for method in [Method::Event, Method::Switch] {
        let (mut compared, mut switches) = (0, 0);
        for _ in 0..60 {
            let mut machine = Machine {
                speed_rad_s: sampler.one_of(&[-160.8, -191.6, -216.4, -247.3, 216.4]),
                ..Machine::default()
            };
            machine.friction = sampler.one_of(&[
                FrictionLaw::COULOMB,
                FrictionLaw::COULOMB,
                FrictionLaw::stribeck(4e-3, 20.0),
                FrictionLaw::smooth(30.0),
                FrictionLaw::viscous(1e-4),
                FrictionLaw::coulomb_viscous(1e-4),
            ]);
            machine.balls[1].mass_kg *= 1.5;
            Model::from(machine.clone()).validate().expect("a valid machine");
            let balancer = Balancer::<2>::new(&machine).expect("two balls");
            let between = |sampler: &mut Sampler, half: f64| sampler.between(-half, half);
            let mut numbers =
                |half: f64| -> Vec<f64> { (0..8).map(|_| between(&mut sampler, half)).collect() };
            let (mut start, direction) = (numbers(0.05), numbers(1.0));
            start[4..6].iter_mut().for_each(|beta| *beta = 60.0 * *beta + 3.0);
            start[6..].iter_mut().for_each(|speed| *speed *= 8.0);
            let [start, mut direction] = [start, direction]
                .map(|values| State::<2>::of_components(&values).expect("eight components"));
            if method == Method::Event {
                // A resting ball has no neighbours with arbitrarily small speed.
                direction.beta_dot = [0, 1].map(|ball| {
                    if start.beta_dot[ball] == 0.0 { 0.0 } else { direction.beta_dot[ball] }
                });
            }
            let (start, direction) = (start.components(), direction.components());
            for system in for_each_kernel(balancer) {
                let found = compare(&system, fine(method), &start, 40.0, &direction);
                if let Some((error, met)) = found {
                    compared += 1;
                    switches += met;
                    assert!(error < 3e-5, "{method:?} {machine:?}: {error} after {met} switches");
                }
            }
        }
        println!("{method:?}: {compared} compared, {switches} switches met");
        assert!(compared >= 80 && switches >= 200, "{method:?}: {compared}, {switches}");
    }
}
