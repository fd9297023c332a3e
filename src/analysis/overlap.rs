//! Whether balls overlap. The model has no contact between balls, so that two balls can rest nearer
//! to each other than their diameters allow.

use crate::model::Machine;

/// Returns whether two of the balls at the angles `beta` overlap. The centres of all balls are on
/// the circle of radius `L`: balls of the diameters `d_a` and `d_b` overlap if the chord between
/// their centres is shorter than the sum of their radii, `2 L |sin(Δβ/2)| < (d_a + d_b) / 2`.
pub fn overlaps(machine: &Machine, beta: &[f64]) -> bool {
    let balls: Vec<(f64, f64)> =
        machine.balls.iter().map(|ball| ball.diameter_m).zip(beta.iter().copied()).collect();
    balls.iter().enumerate().any(|(place, &(diameter, angle))| {
        balls[..place].iter().any(|&(other_diameter, other_angle)| {
            let chord = 2.0 * machine.ring_radius_m * (0.5 * (angle - other_angle)).sin().abs();
            chord < 0.5 * (diameter + other_diameter)
        })
    })
}
