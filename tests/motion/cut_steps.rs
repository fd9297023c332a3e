//! Steps that an end time shortens, steps that it does not, and states within a step.

use std::sync::Arc;

use stickslip::model::{Method, Simulation, Start, State, System};
use stickslip::motion::{Motion, Settings};

use super::samples::two_balls;
use crate::support::{METHODS, for_each_kernel, go_on, start_of, started};

fn motion(system: &Arc<dyn System>, method: Method) -> Motion {
    let simulation = Simulation { method, ..Simulation::default() };
    let start = Start::of_balancer([0.01, 0.0], &[1.0, 4.0], [0.0, 0.02], &[0.5, -0.3]);
    let state: State<2> = start_of(&start);
    started(system, Settings::new(&simulation, u64::MAX), &state)
}

/// Returns the largest difference of two states, angles modulo 2π.
fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    let flat = |s: &[f64]| {
        let s: State<2> = State::of_components(s).expect("two balls");
        let [sines, cosines] = [s.beta.map(f64::sin), s.beta.map(f64::cos)];
        [s.position, s.velocity, sines, cosines, s.beta_dot].concat()
    };
    flat(a).iter().zip(flat(b)).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// Returns all that is known of a motion and its latest step, bit for bit.
fn all_of(motion: &Motion) -> String {
    let times = (motion.time(), motion.last_step_began());
    let middle = 0.5 * (motion.time() + motion.last_step_began());
    let contacts = (motion.unwrapped(), motion.last_switches(), motion.slow_since());
    let phases = (motion.phases(), motion.phases_during_step());
    let states = [motion.time(), middle].map(|time| motion.within_last_step(time));
    format!(
        "{times:?} {:?} {contacts:?} {phases:?} {states:?} {:?}",
        motion.state(),
        motion.effort()
    )
}

/// Steps that do not reach an end time are bit for bit those to any later end time.
#[test]
fn steps_that_reach_no_end_do_not_depend_on_it() {
    // The longest step of either kernel.
    let longest = 5.0 / std::f64::consts::FRAC_PI_2 * two_balls(-216.3772).longest_step();
    for system in for_each_kernel(two_balls(-216.3772)) {
        for method in METHODS {
            for index in 1..60 {
                let until = 0.37 * f64::from(index);
                let (mut cut, mut free) = (motion(&system, method), motion(&system, method));
                while until - cut.time() > longest {
                    assert_eq!(cut.advance(until), free.advance(f64::MAX));
                    assert_eq!(all_of(&cut), all_of(&free));
                }
                assert!(cut.time() < until);
                go_on(&mut cut, until);
                assert_eq!(cut.time(), until);
            }
        }
    }
}

/// The state at a time within the latest step is that of a motion that stops there; there is none
/// outside of the step.
#[test]
fn states_within_a_step_are_those_of_a_stopped_motion() {
    for system in for_each_kernel(two_balls(-216.3772)) {
        for method in METHODS {
            let mut steps = motion(&system, method);
            let mut taken = 0;
            while steps.time() < 20.0 {
                let before = steps.time();
                steps.advance(f64::MAX).expect("continues");
                let length = steps.time() - before;
                for part in [0.0, 0.3, 0.9, 1.0] {
                    let time = if part < 1.0 { before + part * length } else { steps.time() };
                    let found = steps.within_last_step(time).expect("within");
                    // The same steps up to the one that is stopped.
                    let mut stops = motion(&system, method);
                    (0..taken).for_each(|_| _ = stops.advance(f64::MAX));
                    assert_eq!(stops.time(), before);
                    go_on(&mut stops, time);
                    let difference = largest_difference(&found, &stops.state());
                    assert!(difference < 1e-7, "{time}: {difference}");
                }
                taken += 1;
                let outside = [before - 1e-9, steps.time() + 1e-9];
                assert_eq!(outside.map(|time| steps.within_last_step(time)), [None, None]);
            }
        }
    }
}
