//! Steps that an end time shortens, and steps that it does not.

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
