//! Distances of angles.

use std::f64::consts::TAU;

/// Returns the distance of two angles on the circle, rad, from 0 to π.
pub fn angular_distance(a: f64, b: f64) -> f64 {
    let turned = (a - b).rem_euclid(TAU);
    turned.min(TAU - turned)
}
