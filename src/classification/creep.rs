//! Creep: balls that drift ever more slowly towards the edge of the equilibrium set without
//! reaching it.
//!
//! Near the edge friction is just too small to stop a ball, and the net force on it vanishes with
//! the distance, so that its speed decays like that of an overdamped system and never becomes zero.
//! A block does so against a drag of more than critical damping.
//! For practical purposes the body is at rest. At one instant, a ball that is about to leave the
//! set looks the same; the motion is therefore followed for a test period. The criteria are:
//!
//! - all balls are slow (below 1e-6 of the natural frequency, or below the band if that is wider),
//!   at the start and throughout the test period;
//! - the table is at the rest point for the balls' positions, and the tangential force there
//!   exceeds the friction limit only slightly; or the equations of sliding have a stable equilibrium nearby, at which the speeds
//!   vanish and friction is just able to hold the contacts;
//! - the balls hardly drift, and do not accelerate from the first half of the test period to the
//!   second.

use crate::model::RestForms;
use crate::motion::{Motion, PerContact};

/// Largest excess of the tangential force over the friction limit, relative to the limit.
const EXCESS: f64 = 1e-3;
/// Length of the test period, non-dimensional: about thirty periods of the table.
const WHILE: f64 = 200.0;
/// Largest drift of a contact in the test period, non-dimensional.
const DRIFT: f64 = 1e-3;
/// Largest increase of the drift in the second half: a table that is not quite at rest moves the
/// balls in small, uneven steps. A ball that leaves moves a hundred times further in the second half.
const UNSTEADY: f64 = 1e-5;

/// Returns whether the forces in a state are such that slow contacts may creep.
pub(super) fn may_creep(forms: &dyn RestForms, state: &[f64]) -> bool {
    forms.nearly_rests(state, EXCESS)
}

/// Returns whether the contacts of a motion, which are slow and may creep, do so in the test period.
pub(super) fn creeps(mut motion: Motion) -> bool {
    let start = motion.time();
    let mut positions: [PerContact; 3] = Default::default();
    for (half, positions) in positions.iter_mut().enumerate() {
        let until = start + 0.5 * WHILE * half as f64;
        while motion.time() < until {
            if motion.advance(until).is_err() || !motion.all_slow() {
                return false;
            }
        }
        *positions = motion.unwrapped();
    }
    let drift = |from: usize, to: usize| {
        let pairs = positions[from].iter().zip(&positions[to]);
        pairs.map(|(from, to)| (to - from).abs()).fold(0.0, f64::max)
    };
    drift(0, 2) <= DRIFT && drift(1, 2) <= drift(0, 1) + UNSTEADY
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::{creeps, may_creep};
    use crate::model::{Balancer, Machine, Method, System};
    use crate::motion::{Motion, Settings, Tolerance};

    /// None of the balls that leave the equilibrium set, released at rest just outside it, counts
    /// as creeping.
    #[test]
    fn balls_that_leave_do_not_creep() {
        let balancer = Balancer::<2>::new(&Machine::default()).unwrap();
        let system: Arc<dyn System> = Arc::new(balancer);
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
            let state = [x, y, 0.0, 0.0, beta[0], beta[1], 0.0, 0.0];
            let start =
                || Motion::new(&system, settings[(k % 2) as usize], &state).expect("starts");
            let mut motion = start();
            let creeping = may_creep(&balancer, &state) && creeps(start());
            while motion.time() < 500.0 {
                motion.advance(500.0).unwrap();
            }
            let end = motion.state();
            let moved = (4..6).map(|place| (end[place] - state[place]).abs());
            if moved.fold(0.0, f64::max) > 0.01 {
                left += 1;
                assert!(!creeping, "{beta:?}");
            }
        }
        assert!(left > 10, "{left}");
    }
}
