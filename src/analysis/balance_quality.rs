//! The balance quality that is left with the balls at rest, as the grade G of ISO 21940-11.
//!
//! ISO 21940-11:2016 grades a rotor by the product of its specific imbalance and its speed, in
//! mm/s. The specific imbalance is the residual imbalance divided by the mass of the rotor. The
//! model knows only the whole vibrating mass, so that this grade is smaller than that of the rotor
//! alone by the ratio of the two masses.

use nalgebra::Complex;

use crate::model::Machine;

/// Returns the size of [`residual_imbalance_vector`], kg m.
pub fn residual_imbalance(machine: &Machine, beta: &[f64]) -> f64 {
    residual_imbalance_vector(machine, beta).norm()
}

/// Returns the residual imbalance with the balls at the angles `beta` from the imbalance, kg m:
/// `m_I e + Σ m_i (ε + L exp(iβ_i))`, with the runout `ε` of the ring; its real part points towards the imbalance.
pub fn residual_imbalance_vector(machine: &Machine, beta: &[f64]) -> Complex<f64> {
    let imbalance = Complex::from(machine.imbalance_mass_kg * machine.imbalance_radius_m);
    let balls = machine.balls.iter().zip(beta);
    let balls = balls
        .map(|(ball, &angle)| Complex::from_polar(ball.mass_kg * machine.ring_radius_m, angle));
    let total: f64 = machine.balls.iter().map(|ball| ball.mass_kg).sum();
    let runout = Complex::from_polar(total * machine.ring_runout_m, machine.ring_runout_angle_rad);
    imbalance + runout + balls.sum::<Complex<f64>>()
}

/// Returns the balance quality grade with the balls at the angles `beta` from the imbalance, mm/s:
/// `G = U |ω| / M`, with the whole vibrating mass `M`, which includes the imbalance and the balls.
pub fn balance_quality_grade(machine: &Machine, beta: &[f64]) -> f64 {
    let specific_imbalance_m = residual_imbalance(machine, beta) / machine.total_mass_kg();
    1e3 * specific_imbalance_m * machine.speed_rad_s.abs()
}
