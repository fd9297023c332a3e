//! The vibration that the balls leave at a point: the amplitude of each run against that of its own
//! machine without balls, and the balance quality and overlaps of the rests.
//!
//! ISO 21940-11:2016 grades a rotor by the product of its specific imbalance and its speed, in
//! mm/s. The specific imbalance is the residual imbalance divided by the mass of the rotor. The
//! model knows only the whole vibrating mass, so that this grade is smaller than that of the rotor
//! alone by the ratio of the two masses.

use nalgebra::Complex;

use super::interval::{Z_95, wilson_with_failures};
use super::touching::overlaps;
use super::value_counts::ValueCounts;
use crate::classification::{Label, Outcome};
use crate::model::Machine;

/// Counts over the runs of a point that did not fail.
#[derive(Clone, Debug, Default)]
pub(super) struct ResidualVibrationCounts {
    /// Runs with an amplitude.
    compared: u64,
    /// Runs that vibrate more than their own machine without balls.
    worse: u64,
    without_balls_m: ValueCounts,
    relative: ValueCounts,
    rests: u64,
    overlapping: u64,
    grades: ValueCounts,
}

/// The vibration that the balls leave at a point.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ResidualVibration {
    /// Median over the runs of the amplitude of each run's own machine without balls, m.
    pub amplitude_without_balls_m: Option<f64>,
    /// Quantiles 5, 50 and 95 % of the amplitude over that of the run's own machine without balls.
    pub relative_amplitude: [Option<f64>; 3],
    /// Fraction of the runs that vibrate more than their own machine without balls, of all runs
    /// that did not fail, and the ends of its 95 % interval; `None` if no run has an amplitude.
    pub worse_than_without_balls: Option<[f64; 3]>,
    /// Quantiles 50 and 95 % of the balance quality grade over the rests, mm/s.
    pub balance_quality_grade_mm_s: [Option<f64>; 2],
    /// Fraction of the rests at which balls overlap; `None` if there are no rests.
    pub overlapping_rest_fraction: Option<f64>,
}

impl ResidualVibration {
    /// The fractions of `relative_amplitude`.
    pub const AMPLITUDE_FRACTIONS: [f64; 3] = [0.05, 0.5, 0.95];
    /// The fractions of `balance_quality_grade_mm_s`.
    pub const GRADE_FRACTIONS: [f64; 2] = [0.5, 0.95];
}

impl ResidualVibrationCounts {
    /// Adds a run of a machine that did not fail.
    pub(super) fn add(&mut self, machine: &Machine, outcome: &Outcome) {
        if let Some(amplitude) = outcome.amplitude_m {
            // No run vibrates more than an undamped machine at its resonance.
            let without_balls_m = reference_amplitude(machine);
            self.compared += 1;
            self.worse += u64::from(amplitude > without_balls_m.unwrap_or(f64::INFINITY));
            without_balls_m.into_iter().for_each(|metres| self.without_balls_m.add(metres, 0));
            let relative = relative_amplitude(machine, amplitude);
            relative.into_iter().for_each(|relative| self.relative.add(relative, 0));
        }
        if let (Label::Equilibrium, Some(beta)) = (outcome.label(), &outcome.position) {
            self.rests += 1;
            self.overlapping += u64::from(overlaps(machine, beta));
            self.grades.add(balance_quality_grade(machine, beta), 0);
        }
    }

    /// Returns the summary; `failed` is the number of failed runs, which widen the interval.
    pub(super) fn summary(&self, failed: u64) -> ResidualVibration {
        let worse = || {
            let runs = self.compared + failed;
            let (low, high) = wilson_with_failures(self.worse, failed, runs, Z_95);
            [self.worse as f64 / self.compared as f64, low, high]
        };
        let overlapping = || self.overlapping as f64 / self.rests as f64;
        ResidualVibration {
            amplitude_without_balls_m: self.without_balls_m.quantile(0.5),
            relative_amplitude: ResidualVibration::AMPLITUDE_FRACTIONS
                .map(|fraction| self.relative.quantile(fraction)),
            worse_than_without_balls: (self.compared > 0).then(worse),
            balance_quality_grade_mm_s: ResidualVibration::GRADE_FRACTIONS
                .map(|fraction| self.grades.quantile(fraction)),
            overlapping_rest_fraction: (self.rests > 0).then(overlapping),
        }
    }
}

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
