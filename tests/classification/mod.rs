//! Endings of runs: against an independent integration, the thesis's numbers, and each other.

mod attraction;
mod blocks;
mod bouncing_ball;
mod certificate;
pub mod convergence;
mod dry_and_viscous;
mod effort_pinned;
mod endings;
mod extend;
mod forced;
mod friction_laws;
mod limit_cycle;
mod lockstep;
mod lyapunov;
mod means;
mod model_version;
mod multipliers;
mod recorder;
mod recorder_touches;
pub mod reference;
mod reference_in_contact;
mod reference_run_up;
mod runout;
mod settled;
pub mod simulate_all;
mod stages;
mod step_limit;
