//! Distances of angles.

use std::f64::consts::TAU;

/// Returns the distance of two angles on the circle, rad, from 0 to π.
pub fn angular_distance(one: f64, other: f64) -> f64 {
    let turned = (one - other).rem_euclid(TAU);
    turned.min(TAU - turned)
}
