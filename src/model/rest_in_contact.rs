//! Closed forms for balls at rest that may touch: the forces between them help friction to hold them, or hinder it.

use super::certificate::{disturbance_bound, followed_to_rest};
use super::recorded_balancer::DrivenDisc;
use super::{
    BallsInContact, Gap, HeldContact, RestAmplitude, RestForms, RestPoint, State, held,
    least_force, strength_that_holds,
};

/// Gaps up to this width are closed: the width within which impacts are located is much smaller.
pub const TOUCHING: f64 = 1e-9;

/// Accuracy of the friction margin of balls that touch.
const MARGIN_ACCURACY: f64 = 1e-12;

impl<const N: usize> BallsInContact<N> {
    /// Returns the gaps that are closed at these angles.
    pub fn closed_gaps(&self, beta: &[f64; N]) -> Vec<Gap> {
        let closed = |gap: &&Gap| gap.width(gap.contacts.map(|ball| beta[ball])) <= TOUCHING;
        self.gaps().iter().filter(closed).copied().collect()
    }

    /// Returns the largest change of all forces with which friction still holds all balls; negative if it does not hold
    /// them. `strength` multiplies the coefficients of friction.
    fn force_reserve(&self, forces: [&[f64; N]; 2], gaps: &[Gap], strength: f64) -> f64 {
        held(&self.held_contacts(forces, strength), gaps).reserve
    }

    fn held_contacts(&self, [normal, friction]: [&[f64; N]; 2], strength: f64) -> [HeldContact; N] {
        std::array::from_fn(|ball| {
            let limit = strength * self.balancer.balls[ball].friction.limit;
            let (normal, friction) = (normal[ball], friction[ball]);
            HeldContact { normal, friction, limit, weight: 1.0 + limit }
        })
    }

    /// Returns the friction margin of balls that rest at these angles: 1 if no ball needs friction, 0 on the edge of the
    /// equilibrium set, negative outside. It is the largest fraction that the coefficients of friction may lose.
    pub fn rest_margin(&self, beta: &[f64; N]) -> f64 {
        let rest = self.balancer.rest_point(beta);
        let gaps = self.closed_gaps(beta);
        if gaps.is_empty() {
            return 1.0 - self.balancer.friction_use(&rest, 0.0);
        }
        let contacts = self.held_contacts([&rest.normal, &rest.friction], 1.0);
        1.0 - strength_that_holds(&contacts, &gaps)
    }

    fn certified(&self, rest: &RestPoint<N>, gaps: &[Gap], state: &State<N>) -> bool {
        self.force_reserve([&rest.normal, &rest.friction], gaps, 1.0)
            >= disturbance_bound(&self.balancer, rest, state)
    }
}

impl<const N: usize> RestForms for BallsInContact<N> {
    fn surely_rests(&self, state: &[f64]) -> bool {
        let Some(parts) = State::of_components(state) else { return false };
        let gaps = self.closed_gaps(&parts.beta);
        if gaps.is_empty() {
            return self.balancer.surely_rests(state);
        }
        self.certified(&self.balancer.rest_point(&parts.beta), &gaps, &parts)
    }

    fn rests(&self, state: &[f64]) -> bool {
        let Some(parts) = State::of_components(state) else { return false };
        let gaps = self.closed_gaps(&parts.beta);
        if gaps.is_empty() {
            return self.balancer.rests(state);
        }
        let rest = self.balancer.rest_point(&parts.beta);
        let force_reserve = |normal: &[f64; N], friction: &[f64; N]| {
            self.force_reserve([normal, friction], &gaps, 1.0)
        };
        force_reserve(&rest.normal, &rest.friction) > 0.0
            && followed_to_rest(
                &self.balancer,
                &rest,
                &parts,
                |state| self.certified(&rest, &gaps, state),
                |forces, unseen| force_reserve(&forces.normal, &forces.friction) >= unseen,
            )
    }

    fn at_rest(&self, state: &[f64]) -> RestAmplitude {
        let state: Option<State<N>> = State::of_components(state);
        let beta = state.map_or([0.0; N], |state| state.beta);
        let amplitude = self.balancer.rest_amplitude(&beta);
        RestAmplitude { amplitude, friction_margin: self.rest_margin(&beta) }
    }

    fn contact_force(&self, state: &[f64]) -> Option<(usize, f64)> {
        let beta = State::<N>::of_components(state)?.beta;
        let gaps = self.closed_gaps(&beta);
        let contact = gaps.first()?.contacts[0];
        let rest = self.balancer.rest_point(&beta);
        // Balls that creep towards the edge of the set need slightly more friction than there is.
        let strength = (1.0 - self.rest_margin(&beta)).max(1.0) * (1.0 + MARGIN_ACCURACY);
        let held = self.held_contacts([&rest.normal, &rest.friction], strength);
        Some((contact, least_force(&held, &gaps)? / self.balancer.balls[contact].mass))
    }

    fn nearly_rests(&self, state: &[f64], excess: f64) -> bool {
        let Some(state) = State::of_components(state) else { return false };
        let rest = self.balancer.rest_point(&state.beta);
        let distance = self.balancer.distance_from_rest(&state, &rest);
        let gaps = self.closed_gaps(&state.beta);
        self.force_reserve([&rest.normal, &rest.friction], &gaps, 1.0 + excess)
            >= self.balancer.acceleration_bound(distance)
    }
}
