//! Lanes that may rest for good: all balls stick, and the table is so near its rest point that none can break loose.

use fearless_simd::prelude::*;

use crate::model::{Balancer, RestPoint, State};
use crate::motion::lockstep::Lanes;
use crate::motion::lockstep::vector::Vector;
use crate::motion::{Phase, all_stick, any_closed};

/// The rest point of each lane.
pub(super) struct RestAhead<S: Vector> {
    position: [Lanes<S>; 2],
    /// The square of the distance from rest below which no ball can break loose; negative if there is no such distance.
    radius_squared: Lanes<S>,
}

impl<S: Vector> RestAhead<S> {
    /// No lane may rest.
    pub(super) fn none(simd: S) -> Self {
        RestAhead {
            position: [Lanes::splat(simd, 0.0); 2],
            radius_squared: Lanes::splat(simd, -1.0),
        }
    }

    /// Forgets a lane.
    pub(super) fn clear(&mut self, lane: usize) {
        self.radius_squared[lane] = -1.0;
    }

    /// Sets the rest point of a lane in which all balls stick.
    pub(super) fn set<const N: usize>(
        &mut self,
        lane: usize,
        balancer: &Balancer<N>,
        (phases, state): (&[Phase], &[f64]),
    ) {
        let Some(state) = State::<N>::of_components(state).filter(|_| all_stick(phases)) else {
            return;
        };
        let rest = balancer.rest_point(&state.beta);
        self.position[0][lane] = rest.position[0];
        self.position[1][lane] = rest.position[1];
        // Forces between balls that touch can hold them where friction alone cannot.
        let touches = any_closed(phases);
        self.radius_squared[lane] =
            if touches { f64::INFINITY } else { rest_radius_squared(balancer, &rest) };
    }

    /// Returns the lanes that may rest for good, as a bit mask, from the speed of the disc and the components of the table.
    #[inline(always)]
    pub(super) fn is_near(&self, speed: Lanes<S>, table: &[Lanes<S>; 4]) -> u64 {
        let u_x = table[0] - self.position[0];
        let u_y = table[1] - self.position[1];
        let v_x = table[2] - speed * u_y;
        let v_y = table[3] + speed * u_x;
        let distance = u_x * u_x + u_y * u_y + (v_x * v_x + v_y * v_y);
        distance.simd_le(self.radius_squared).to_bitmask()
    }
}

/// Returns the square of the distance from rest below which no ball can break loose, apart from the
/// residual speeds of sticking balls in the switch model; negative if there is no such distance.
fn rest_radius_squared<const N: usize>(balancer: &Balancer<N>, rest: &RestPoint<N>) -> f64 {
    let mut least = f64::INFINITY;
    for (i, ball) in balancer.balls.iter().enumerate() {
        let limit = ball.friction.limit;
        least = least.min((limit * rest.normal[i] - rest.friction[i].abs()) / (1.0 + limit));
    }
    if least < 0.0 || least.is_nan() {
        return -1.0;
    }
    // Slightly larger, so that rounding leaves the decision to the certificate itself.
    let radius = least / balancer.acceleration_bound(1.0) * (1.0 + 1e-9);
    radius * radius
}
