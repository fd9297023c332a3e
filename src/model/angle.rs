//! Equivalent angles in a range of one turn.

use std::f64::consts::{PI, TAU};

/// Returns the equivalent angle in [0, 2π).
pub fn wrap_to_two_pi(angle: f64) -> f64 {
    let wrapped = angle.rem_euclid(TAU);
    if wrapped < TAU { wrapped } else { 0.0 }
}

/// Returns the equivalent angle in [-π, π]; an angle in this range is unchanged.
#[inline]
pub fn wrap_to_pi(angle: f64) -> f64 {
    if angle.abs() > PI { angle - TAU * (angle / TAU).round() } else { angle }
}
