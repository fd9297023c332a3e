//! How the system moves: integration of smooth phases, stick and slip, switches between them.
//!
//! Read first `phase`, `settings` and `failure`, then `evaluator`, which computes rates and forces from the recorded
//! equations with `linear_system`. The next files decide between stick and slip. `joint_decision` defines what a decision
//! asks of a system, and finds the phases that meet all conditions. `event_driven` and `switch_model` are the two methods,
//! `stick_slip` chooses between them, and `condition` names the conditions of a phase.
//!
//! Then read about bodies that touch: `cluster`, the impulses of an impact (`impulse_response`, `impulses`, `impact`), and
//! `touching_system`. `touching_decision` decides their phases with `incremental_forces` and `separate_contacts`.
//! `saltation` carries a perturbation over a switch.
//!
//! `reduced_equations` has the independent equations of contacts that keep their phases, `root` finds roots, and
//! `cancellation` stops a motion from outside. `lockstep` integrates the motions of eight runs side by side. Read `single`
//! last: it computes one motion alone, in one lane of `lockstep`.

mod cancellation;
mod cluster;
mod condition;
mod evaluator;
mod event_driven;
mod failure;
mod impact;
mod impulse_response;
mod impulses;
mod incremental_forces;
mod joint_decision;
mod linear_system;
pub(crate) mod lockstep;
mod phase;
mod reduced_equations;
mod root;
mod saltation;
mod separate_contacts;
mod settings;
mod single;
mod stick_slip;
mod switch_model;
mod touching_decision;
mod touching_system;

pub(crate) use cancellation::unwind_if_cancelled;
pub use cancellation::{Cancellation, is_cancelled};
pub use evaluator::{ContactForces, Evaluator, Forces, GapForces};
pub use failure::Failure;
pub(crate) use failure::SINGULAR;
pub(crate) use impact::Hit;
pub use impulse_response::{ImpactPlace, ImpulseResponse};
pub use incremental_forces::IncrementalForces;
pub use lockstep::SimdLevel;
pub(crate) use phase::any_closed;
pub use phase::{Direction, PerContact, Phase, Phases, all_stick};
pub(crate) use reduced_equations::ReducedEquations;
pub use root::fall_through_zero;
pub use settings::{Effort, SLOW, Settings, Touches, most_steps_by};
pub use single::{Instant, Motion};
pub use stick_slip::decide;
pub use switch_model::SLACK;
pub(crate) use touching_system::{STILL, lies};

pub use crate::model::Tolerance;
