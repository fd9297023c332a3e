//! Whether balls overlap: without contact two balls can rest nearer to each other than their diameters allow.

use crate::model::{Machine, TOUCHING, wrap_to_pi};

/// Returns whether two of the balls at the angles `beta` overlap: whether the angle between them is
/// smaller than the one at which they touch.
pub fn overlaps(machine: &Machine, beta: &[f64]) -> bool {
    let overlap = |first: usize, second: usize| {
        let touching = machine.contact_angle_rad(&machine.balls[first], &machine.balls[second]);
        wrap_to_pi(beta[first] - beta[second]).abs() < touching - TOUCHING
    };
    let count = machine.balls.len().min(beta.len());
    (0..count).any(|ball| (0..ball).any(|other| overlap(ball, other)))
}
