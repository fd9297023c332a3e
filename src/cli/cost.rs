//! What a study will cost, from what runs of its kind have cost (`benches/README.md`).

use crate::ending::goes_in_lockstep;
use crate::model::{FrictionLaw, Model, Simulation};
use crate::study::Study;

/// Core seconds if no run ended before the latest end time. Audited runs are computed twice.
pub(super) fn most_core_seconds(study: &Study) -> f64 {
    let simulation = study.simulation();
    let [_, latest_end_time_s] = simulation.end_times_s();
    let units = latest_end_time_s * study.model().natural_frequency_rad_s();
    let cost = |simulation: &Simulation| seconds_per_unit(study.model(), simulation);
    let audited =
        study.audit().map_or(0.0, |audit| audit.fraction * cost(&simulation.counter_check()));
    let stiffness = (damping_rate(study.model()) / STABLE).max(1.0);
    (cost(simulation) + audited) * units * stiffness * study.run_count() as f64
}

/// Seconds on a core of 2024, with vectors of four numbers, per unit of non-dimensional time.
///
/// In lockstep a unit takes from 0.27 µs with one ball to 2.3 µs with eight at a relative tolerance of 1e-8, as
/// events become more; stricter tolerances cost by their sixteenth root, the order of the series, coarser ones save
/// little. One by one it takes 1.5 µs with two balls, and grows with the number of components and, the method being
/// of order 8, with the tolerance's eighth root.
fn seconds_per_unit(model: &Model, simulation: &Simulation) -> f64 {
    let strictness = 1e-8 / simulation.relative_tolerance;
    let balls = model.balls() as f64;
    if goes_in_lockstep(model) {
        return 0.27e-6 * balls * (1.0 + balls / 20.0) * strictness.max(1.0).powf(1.0 / 16.0);
    }
    1.5e-6 * (4.0 + 2.0 * balls) / 8.0 * strictness.powf(0.125)
}

/// A step of the integrator times the rate of damping that it can still follow: the length of the
/// stability region of a Runge-Kutta method of order 8 on the negative real axis, about.
const STABLE: f64 = 6.0;

/// The rate at which friction that grows with speed damps it, over the natural frequency: of the
/// lightest ball, or of a block.
fn damping_rate(model: &Model) -> f64 {
    let natural = model.natural_frequency_rad_s();
    let (mass_kg, ratio, acceleration) = match model {
        Model::BallBalancer(machine) => {
            let balls = &machine.balls;
            let mass = balls.iter().map(|ball| ball.mass_kg).fold(f64::INFINITY, f64::min);
            let ratio = balls.iter().map(|ball| ball.friction_coefficient).fold(0.0, f64::max);
            (mass, ratio, machine.speed_rad_s * machine.speed_rad_s)
        }
        Model::Block(block) => {
            (block.mass_kg, block.friction_coefficient, block.normal_force_n / block.mass_kg)
        }
    };
    match *model.friction() {
        FrictionLaw::Coulomb | FrictionLaw::Stribeck { .. } => 0.0,
        FrictionLaw::Smooth { smoothing_speed } => {
            ratio * acceleration * std::f64::consts::FRAC_2_PI / (smoothing_speed * natural)
        }
        FrictionLaw::Viscous { viscous_coefficient_n_s_m } => {
            viscous_coefficient_n_s_m / (mass_kg * natural)
        }
    }
}
