//! Systems for each kernel, and states of a balancer.

use std::sync::Arc;

use stickslip::model::{Recorded, Start, State, System};
use stickslip::motion::{Motion, Settings};

/// Returns a system for the kernel that is written for it, if there is one.
pub fn shared(system: impl System) -> Arc<dyn System> {
    Arc::new(system)
}

/// Returns a system twice: for the kernel that is written for it, and for the general kernel.
pub fn for_each_kernel(system: impl System) -> [Arc<dyn System>; 2] {
    let system = shared(system);
    [Arc::clone(&system), Arc::new(Recorded(system))]
}

/// Starts a motion of a balancer or, with `FREE` 0, of a block.
pub fn started<const N: usize, const FREE: usize>(
    system: &Arc<dyn System>,
    settings: Settings,
    state: &State<N, f64, FREE>,
) -> Motion {
    Motion::new(system, settings, &state.components()).expect("starts")
}

/// Returns the present state of a motion of a balancer or, with `FREE` 0, of a block.
pub fn state_of<const N: usize, const FREE: usize>(motion: &Motion) -> State<N, f64, FREE> {
    State::of_components(&motion.state()).expect("as many components")
}

/// Returns a start state of a balancer with `N` balls.
pub fn start_of<const N: usize>(start: &Start) -> State<N> {
    let (position, rest) = start.0.split_first_chunk().expect("a position");
    let (beta, rest) = rest.split_first_chunk().expect("as many angles");
    let (velocity, rest) = rest.split_first_chunk().expect("a velocity");
    let beta_dot = rest.try_into().expect("as many speeds");
    State { position: *position, velocity: *velocity, beta: *beta, beta_dot }
}
