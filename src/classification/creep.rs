//! Creep: balls that drift ever more slowly towards the edge of the equilibrium set without
//! reaching it.
//!
//! Near the edge friction is just too small to stop a ball, and the net force on it vanishes with
//! the distance, so that its speed decays like that of an overdamped system and never becomes zero.
//! For practical purposes the ball is at rest. At one instant, a ball that is about to leave the
//! set looks the same; the motion is therefore followed for a test period. The criteria are:
//!
//! - all balls are slow (below 1e-6 of the natural frequency, or below the band if that is wider),
//!   at the start and throughout the test period;
//! - the table is at the rest point for the balls' positions, and the tangential force there
//!   exceeds the friction limit only slightly;
//! - the balls hardly drift, and do not accelerate from the first half of the test period to the
//!   second.

use crate::model::{Balancer, State};
use crate::motion::Motion;

/// Largest excess of the tangential force over the friction limit, relative to the limit.
const EXCESS: f64 = 1e-3;
/// Length of the test period, non-dimensional: about thirty periods of the table.
const WHILE: f64 = 200.0;
/// Largest drift of a ball in the test period, rad.
const DRIFT: f64 = 1e-3;
/// Largest increase of the drift in the second half, rad: a table that is not quite at rest moves
/// the balls in small, uneven steps. A ball that leaves moves a hundred times further in the second
/// half.
const UNSTEADY: f64 = 1e-5;

/// Returns whether all balls of a motion creep.
pub fn creeps<const N: usize>(balancer: &Balancer<N>, motion: &Motion<Balancer<N>, N>) -> bool {
    if !motion.all_slow() || !pull_is_small(balancer, motion.state()) {
        return false;
    }
    let mut motion = motion.clone();
    let mut angles = [[0.0_f64; N]; 3];
    let start = motion.time();
    for (half, angles) in angles.iter_mut().enumerate() {
        let until = start + 0.5 * WHILE * half as f64;
        while motion.time() < until {
            if motion.advance(until).is_err() || !motion.all_slow() {
                return false;
            }
        }
        *angles = std::array::from_fn(|ball| motion.unwrapped_angle(ball));
    }
    let drift = |from: usize, to: usize| {
        (0..N).map(|ball| (angles[to][ball] - angles[from][ball]).abs()).fold(0.0, f64::max)
    };
    drift(0, 2) <= DRIFT && drift(1, 2) <= drift(0, 1) + UNSTEADY
}

fn pull_is_small<const N: usize>(balancer: &Balancer<N>, state: &State<N>) -> bool {
    let rest = balancer.rest_point(&state.beta);
    let disturbance = balancer.acceleration_bound(balancer.distance_from_rest(state, &rest));
    balancer.friction_use(&rest, disturbance) <= 1.0 + EXCESS
}

#[cfg(test)]
mod tests {
    use super::creeps;
    use crate::model::{Balancer, Machine, Method, State};
    use crate::motion::{Motion, Settings, Tolerance};

    /// None of the balls that leave the equilibrium set, released at rest just outside it, counts
    /// as creeping.
    #[test]
    fn balls_that_leave_do_not_creep() {
        let balancer = Balancer::<2>::new(&Machine::default()).unwrap();
        let tolerance = Tolerance { relative: 1e-8, absolute: 1e-10 };
        let bands = [1e-4, 1e-8];
        let settings = bands.map(|band| Settings {
            method: Method::Switch,
            band,
            tolerance,
            effort_limit: 1_000_000,
        });
        let mut left = 0;
        for k in 0..400_000_u32 {
            // Points of a lattice that covers the torus.
            let angle = |factor: f64| (f64::from(k) * factor).fract() * std::f64::consts::TAU;
            let beta = [angle(0.754_877_666_246_693), angle(0.569_840_290_998_053)];
            let rest = balancer.rest_point(&beta);
            let used = balancer.friction_use(&rest, 0.0);
            if used <= 1.0 || used > 1.0005 {
                continue;
            }
            let [x, y] = rest.position;
            let state = State { position: [x, y], velocity: [0.0; 2], beta, beta_dot: [0.0; 2] };
            let mut motion = Motion::new(&balancer, settings[(k % 2) as usize], state).unwrap();
            let creeping = creeps(&balancer, &motion);
            while motion.time() < 500.0 {
                motion.advance(500.0).unwrap();
            }
            let moved = (0..2).map(|ball| (motion.state().beta[ball] - beta[ball]).abs());
            if moved.fold(0.0, f64::max) > 0.01 {
                left += 1;
                assert!(!creeping, "{beta:?}");
            }
        }
        assert!(left > 10, "{left}");
    }
}
