//! Creep: balls that drift ever slower towards the edge of the equilibrium set without reaching it.
//!
//! Near the edge friction is just too small to stop a ball and the pull on it vanishes with the
//! distance, so that its speed decays like the motion of an overdamped door and is never zero. By
//! any practical standard the ball is at rest. What is asked for: all balls slower than the band,
//! the table at the rest point of where the balls are, and the pull there at most a hair above the
//! friction limit.

use crate::model::{Balancer, State};
use crate::motion::Phase;

/// How far above the friction limit, relative to it, the pull may be.
const EXCESS: f64 = 1e-3;

/// Whether balls in these phases creep. `false` for balls that stick and are certified: they rest.
pub fn creeps<const N: usize>(
    balancer: &Balancer<N>,
    state: &State<N>,
    phases: &[Phase; N],
    band: f64,
) -> bool {
    let slow = phases
        .iter()
        .zip(&state.beta_dot)
        .all(|(phase, speed)| phase.in_band() && speed.abs() <= band);
    let rest = balancer.rest_point(&state.beta);
    let disturbance = balancer.acceleration_bound(balancer.distance_from_rest(state, &rest));
    slow && balancer.friction_use(&rest, disturbance) <= 1.0 + EXCESS
}
