//! How the system moves: integration of smooth phases, stick and slip, switches between them.

mod alone;
mod cancellation;
mod cluster;
mod condition;
mod evaluator;
mod event_driven;
mod failure;
mod force_model;
mod impact;
mod impulses;
mod in_one_state;
mod instant;
mod joint_decision;
mod linear_system;
pub(crate) mod lockstep;
mod modes;
mod phase;
mod residual_speeds;
mod response;
mod root;
mod saltation;
mod settings;
mod single;
mod switch_model;
mod touching;
mod touching_decision;

pub(crate) use cancellation::unwind_if_cancelled;
pub use cancellation::{Cancellation, is_cancelled};
pub use evaluator::{ContactForces, Evaluator, Forces, GapForces};
pub use failure::Failure;
pub(crate) use failure::SINGULAR;
pub(crate) use impact::Hit;
pub use in_one_state::IncrementalForces;
pub use instant::Instant;
pub use lockstep::SimdLevel;
pub use modes::decide;
pub(crate) use phase::any_closed;
pub use phase::{Direction, PerContact, Phase, Phases, all_stick};
pub use response::{ImpactPlace, ImpulseResponse};
pub use root::fall_through_zero;
pub use settings::{Effort, SLOW, Settings, Touches, most_steps_by};
pub use single::Motion;
pub use switch_model::SLACK;

pub use crate::model::Tolerance;
