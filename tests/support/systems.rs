//! Systems for each kernel, states of a balancer, and motions until a time.

use std::sync::Arc;

use stickslip::model::{FrictionLaw, Law, Method, Recorded, Start, State, System};
use stickslip::motion::{Effort, Motion, Settings, Tolerance};

/// Both methods.
pub const METHODS: [Method; 2] = [Method::Event, Method::Switch];

/// Returns a friction law with the examples of its parameters, for balls (0) or for blocks (1).
pub fn example_law(law: &'static dyn Law, unit: usize) -> FrictionLaw {
    let values = law.parameters().iter().map(|parameter| parameter.examples[unit]);
    FrictionLaw::new(law, &values.collect::<Vec<f64>>())
}

/// Returns a system for the kernel that is written for it, if there is one.
pub fn shared(system: impl System) -> Arc<dyn System> {
    Arc::new(system)
}

/// Returns a system twice: for the kernel that is written for it, and for the general kernel.
pub fn for_each_kernel(system: impl System) -> [Arc<dyn System>; 2] {
    let system = shared(system);
    [Arc::clone(&system), Arc::new(Recorded(system))]
}

/// Returns settings with an absolute tolerance of a hundredth of the relative one; the band is for the switch model.
pub fn settings(method: Method, relative: f64) -> Settings {
    let tolerance = Tolerance { relative, absolute: 1e-2 * relative };
    Settings { method, band: 1e-8, tolerance, effort_limit: 10_000_000 }
}

/// Advances until a time and returns the effort.
pub fn go_on(motion: &mut Motion, until: f64) -> Effort {
    while motion.time() < until {
        motion.advance(until).expect("continues");
    }
    motion.effort()
}

/// Starts a motion of a balancer.
pub fn started<const N: usize>(
    system: &Arc<dyn System>,
    settings: Settings,
    state: &State<N>,
) -> Motion {
    Motion::new(system, settings, &state.components()).expect("starts")
}

/// Returns the present state of a motion of a balancer.
pub fn state_of<const N: usize>(motion: &Motion) -> State<N> {
    State::of_components(&motion.state()).expect("as many components")
}

/// Returns a start state of two balls; the states of different numbers are spread over the default box.
pub fn spread_start(number: u32) -> Start {
    let spread = |factor: f64| (f64::from(number) * factor + 0.3).sin();
    Start::of_balancer(
        [0.05 * spread(1.1), 0.05 * spread(2.3)],
        &[3.0 + 3.0 * spread(3.1), 3.0 + 3.0 * spread(4.7)],
        [0.05 * spread(5.9), 0.05 * spread(7.3)],
        &[spread(8.9), spread(10.7)],
    )
}

/// Returns a start state of a balancer with `N` balls.
pub fn start_of<const N: usize>(start: &Start) -> State<N> {
    let (position, rest) = start.0.split_first_chunk().expect("a position");
    let (beta, rest) = rest.split_first_chunk().expect("as many angles");
    let (velocity, rest) = rest.split_first_chunk().expect("a velocity");
    let beta_dot = rest.try_into().expect("as many speeds");
    State { position: *position, velocity: *velocity, beta: *beta, beta_dot }
}
