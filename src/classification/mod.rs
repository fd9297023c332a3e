//! How a run ends: from a case to a label, with the evidence for it.
//!
//! Every ending is claimed on evidence and named with it:
//!
//! | label | evidence | what has been shown |
//! |---|---|---|
//! | `equilibrium` | `rest_contracting` | all contacts stick, and bounds of the equations show that the motion approaches its rest point |
//! | `equilibrium` | `rest_certified` | all balls stick and, by the closed form, can never break loose |
//! | `equilibrium` | `creep` | all balls are slow and drift, ever slower, at the edge of the equilibrium set |
//! | `equilibrium` | `periodic_rest` | throughout a period of the forcing, all contacts stick, or some stick and the others stay open, and the motion of the other components repeats |
//! | `equilibrium` | `settled` | not all contacts stick: an equilibrium is near, stable by its eigenvalues, and friction holds the contacts that stick |
//! | `limit_cycle` | `closed_orbit` | the orbit closes modulo 2π, its multipliers lie inside the unit circle, resting balls keep a margin |
//! | `periodic` | `repeats` | the motion repeats within its accuracy and does not approach another one; without damping, its neighbours repeat as well |
//! | `creep` | `periodic_creep` | in each of the latest periods of the forcing, contacts slip by the same small amount and stop or turn back |
//! | `quasi_periodic` | `torus` | the returns to a section come back ever nearer, as on a torus with two frequencies |
//! | `irregular` | `lyapunov` | neighbouring motions separate exponentially; the confidence interval of the exponent, from enough blocks, is positive |
//! | `undecided` | `unstable_orbit` | the orbit closes, but a multiplier lies outside the unit circle |
//! | `undecided` | `end_time` | none of the above until the end time |
//! | `failed` | the failure's kind | the motion could not be continued |
//!
//! A run with no such ending at its end time may be continued to a later one (`horizons`).
//!
//! Read first `stuck_motion` and `derived_rest`, which prove that contacts never break loose, then `system_view`, the system
//! as the other files see it, and `lane_step`, the latest step of a run. `window` and `output_watch` measure a run,
//! and `cycle`, `stages` and `outcome` are its results.
//!
//! The next files give the evidence: `rest_in_touch`, `settled` and `creep` for rest; `section`, `period`, `return_map`,
//! `closed_orbit`, `torus`, `passages`, `periodic_creep` and `orbit` for motions that repeat; `lyapunov` for irregular motions.
//! `horizons` has the end times of a run, and measures the last part before them.
//!
//! `ending` names how a run ends. `lane_run` examines the run after each step, and `run_outcome` makes the outcome. `gap_sample` and `run_recorder` record the motion, and `step_limit`
//! bounds the effort. Read `in_lockstep`, which simulates many runs, and `simulate` last.

mod closed_orbit;
mod creep;
mod cycle;
mod derived_rest;
mod ending;
mod gap_sample;
mod held_bodies;
mod horizons;
mod in_lockstep;
mod lane_run;
mod lane_step;
mod lyapunov;
mod orbit;
mod outcome;
mod output_watch;
mod passages;
mod period;
mod periodic_creep;
mod rest_in_touch;
mod return_map;
mod run_outcome;
mod run_recorder;
mod section;
mod settled;
mod simulate;
mod stages;
mod step_limit;
mod stuck_motion;
mod system_view;
mod torus;
mod window;

/// Version of the computed outcomes, incremented with every change that alters an outcome; cached
/// results of other versions are not reused. A test pins the outcomes of each version.
pub const MODEL_VERSION: u32 = 31;

pub use closed_orbit::Orbit;
pub use cycle::{Cycle, CyclePhase, TouchingPair};
pub use gap_sample::{GapSample, Touch};
pub use in_lockstep::{Runs, simulate_by_recorded_equations_in_lockstep, simulate_in_lockstep};
pub use outcome::{ClosedOrbit, Evidence, Label, LyapunovExponent, Outcome, Rest, TouchingOutcome};
pub use output_watch::{OutputOutcome, OutputRange};
pub use run_recorder::{ContactSample, Instants, MotionSample, RecordedRun, RunRecorder, Switch};
pub use simulate::{simulate, simulate_by_recorded_equations, simulate_recorded};
pub use stages::{PeakAmplitude, StageOutcome};
pub use step_limit::{
    has_tuned_kernel, most_steps_of_a_run, most_steps_of_any_run, seconds_per_step,
};
