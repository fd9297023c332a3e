//! Motions in lockstep: eight runs side by side in the lanes of SIMD vectors.
//!
//! Each lane has its own parameters, time, step and phases. A kernel expands the motion in all lanes into power series. The
//! coefficients show up to which time a series is accurate, and when a contact first changes its phase. Each lane then
//! advances to the earlier of these times (`advance`): no step is rejected, no step crosses an event, and only rare work
//! (to locate an event, to decide stick and slip there, to end a run) is done lane by lane.
//!
//! Two kernels expand a motion: `general` evaluates the recorded equations of any system, and `tuned` is the recurrence
//! of the balancer with friction that is constant or linear in speed.
//!
//! A lane depends only on its own values: no operation mixes lanes, and all operations are
//! correctly rounded (`+ - * /`, square root, fused multiply-add). A run is therefore the same bit
//! for bit in any lane, beside any neighbours, and in vectors of any width.
//!
//! Read first `vector`, then the arithmetic of a step: `trigonometry`, `step_length`, `root_isolation` and
//! `lane_bounds`. `machine_code` and `run` run programs, and `simd_level` finds the instructions of the processor. `lane` is
//! the scalar part of a run. `kernel` defines what a kernel computes; `held_until` and `gap_conditions` are conditions that
//! both kernels share. Then read `tuned` and `general`. `saved_run` starts a run outside of a lane.
//!
//! `kernel_lanes` has the lanes with their runs. `events` decides the phases at the end of a step, `advance` takes the
//! step in all lanes and reports it, and `step_states` gives the motion inside the step. `lane_group` is the
//! interface of all this for callers, and `kernel_choice` makes the lanes for a system.

mod advance;
mod events;
mod gap_conditions;
mod general;
mod held_until;
mod kernel;
mod kernel_choice;
mod kernel_lanes;
mod lane;
mod lane_bounds;
mod lane_group;
#[cfg(test)]
mod leaving_the_ring;
mod machine_code;
mod root_isolation;
mod run;
mod saved_run;
mod simd_level;
mod step_length;
mod step_states;
mod trigonometry;
mod tuned;
mod vector;

pub(crate) use advance::StepReport;
pub(crate) use kernel_choice::suits_tuned_kernel;
pub(crate) use lane_group::LaneGroup;
pub(super) use root_isolation::width;
pub(crate) use saved_run::SavedRun;
pub use simd_level::SimdLevel;
pub(crate) use vector::{LANES, Lanes};
use vector::{ORDER, TERMS};
