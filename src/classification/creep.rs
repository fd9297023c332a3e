//! Creep: balls that drift ever slower towards the edge of the equilibrium set without reaching it.
//!
//! Near the edge friction is just too small to stop a ball and the pull on it vanishes with the
//! distance, so that its speed decays like the motion of an overdamped door and is never zero. By
//! any practical standard the ball is at rest. Seen at one instant, a ball that is about to leave
//! the set looks the same; so the motion is followed on for a while. What is asked for:
//!
//! - all balls are slow (1e-6 of the natural frequency, or slower than the band where that is
//!   wider), now and all along that while;
//! - the table is at the rest point of where the balls are, and the pull there is at most a hair
//!   above the friction limit;
//! - the balls hardly move on, and do not gather speed from the first half of the while to the
//!   second.

use crate::model::{Balancer, State};
use crate::motion::Motion;

/// How far above the friction limit, relative to it, the pull may be.
const EXCESS: f64 = 1e-3;
/// How long the motion is followed on, non-dimensional: some thirty periods of the table.
const WHILE: f64 = 200.0;
/// How far a ball may drift in that time, rad.
const DRIFT: f64 = 1e-3;
/// How much further in its second half, rad: a table that is not quite still moves the balls on in
/// small steps, uneven ones. A ball that leaves gains a hundredfold from one half to the next.
const UNSTEADY: f64 = 1e-5;

/// Whether all balls of a motion creep.
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

    /// Two balls at rest just outside the equilibrium set: most of them leave, and none of those
    /// that do may be taken for creeping.
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
