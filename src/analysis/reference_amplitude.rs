//! Vibration amplitude of the table without balls, the reference for the amplitude of a run.

use nalgebra::Complex;

use crate::model::Machine;

/// Returns the amplitude of the table, m, with all balls removed from the ring: the steady
/// vibration of the mass `M = M_T + m_I` on its suspension, forced by the imbalance alone, `m_I e
/// ω² / |k - M ω² + i b ω|` (thesis section 5.2, "if no balls were present").
///
/// The balls' mass is removed as well, so that the natural frequency is that of the empty machine.
/// `None` at the resonance of an undamped suspension, where the amplitude is unbounded.
pub fn reference_amplitude(machine: &Machine) -> Option<f64> {
    let speed = machine.speed_rad_s;
    let mass = machine.table_mass_kg + machine.imbalance_mass_kg;
    let force = machine.imbalance_mass_kg * machine.imbalance_radius_m * speed * speed;
    let stiffness = machine.stiffness_n_m - mass * speed * speed;
    let resistance = Complex::new(stiffness, machine.damping_n_s_m * speed).norm();
    Some(force / resistance).filter(|amplitude| amplitude.is_finite())
}

/// Returns the amplitude of a run, m, divided by that of the run's own machine without balls: with the parameters that
/// are drawn for the run. `None` if that machine does not vibrate, or if its amplitude is unbounded.
pub fn relative_amplitude(machine: &Machine, amplitude_m: f64) -> Option<f64> {
    let without_balls_m = reference_amplitude(machine).filter(|amplitude| *amplitude > 0.0)?;
    Some(amplitude_m / without_balls_m)
}
