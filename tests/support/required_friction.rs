//! The friction that a position of rest requires.

use stickslip::model::Balancer;

/// Returns the smallest friction coefficient, equal for all balls, with which the balls can rest at `beta`; infinite if a
/// normal force would have to pull.
pub fn required_friction<const N: usize>(balancer: &Balancer<N>, beta: &[f64; N]) -> f64 {
    let rest = balancer.rest_point(beta);
    let ratio = |i: usize| match rest.normal[i] > 0.0 {
        true => rest.friction[i].abs() / rest.normal[i],
        false => f64::INFINITY,
    };
    (0..N).map(ratio).fold(0.0, f64::max)
}

/// Returns the friction margin at rest: 1 if no ball needs friction, 0 on the edge of the equilibrium set, negative outside.
pub fn rest_margin<const N: usize>(balancer: &Balancer<N>, beta: &[f64; N]) -> f64 {
    1.0 - balancer.friction_use(&balancer.rest_point(beta), 0.0)
}
