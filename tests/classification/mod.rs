//! Endings of runs: against an independent integration, the thesis's numbers, and each other.

mod attraction;
mod blocks;
mod bouncing_ball;
mod certificate;
mod contracting;
pub mod convergence;
mod creep;
mod dry_and_viscous;
mod effort_pinned;
mod endings;
mod extend;
mod forced;
mod friction_laws;
mod held_bodies;
mod limit_cycle;
mod lockstep;
mod lyapunov;
mod means;
mod model_version;
mod motor_drives;
mod multipliers;
mod near_cycles;
pub mod openings;
pub mod outputs;
pub mod recorder;
mod recorder_touches;
pub mod reference;
mod reference_in_contact;
mod reference_run_up;
mod rotor;
mod runout;
mod settled;
mod shared_loads;
pub mod simulate_all;
mod stages;
mod steady_motion;
mod step_limit;
mod sudden_forces;
mod system_units;
mod torus;
mod woodpecker;
mod written;

use stickslip::classification::Outcome;

use crate::support::METHODS;

#[track_caller]
fn near(found: Option<f64>, exact: f64, tolerance: f64) {
    let found = found.expect("known");
    assert!((found - exact).abs() <= tolerance, "{found}, exact {exact}");
}

/// Returns the final position of the first coordinate.
fn position(outcome: &Outcome) -> Option<f64> {
    outcome.position.as_ref().map(|position| position[0])
}
