//! What the table does without balls, to which residual amplitudes are compared.

use crate::model::{Balancer, Machine};

/// Amplitude of the table, m, when balls of the same mass cancel each other out: what the imbalance
/// alone does (thesis section 5.2, "if no balls were present").
pub fn amplitude_without_balls(machine: &Machine) -> Option<f64> {
    let mut opposite = machine.clone();
    opposite.balls.resize(2, *machine.balls.first()?);
    let ball_mass = machine.balls.iter().map(|ball| ball.mass_kg).sum::<f64>() / 2.0;
    for ball in &mut opposite.balls {
        ball.mass_kg = ball_mass;
    }
    let balancer = Balancer::<2>::new(&opposite)?;
    Some(balancer.rest_amplitude(&[0.0, std::f64::consts::PI]) * machine.ring_radius_m)
}
