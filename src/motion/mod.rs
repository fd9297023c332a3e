//! How the system moves: integration of smooth phases, stick and slip, switches between them.

mod cancellation;
mod contact;
mod dop853;
mod dop853_tableau;
mod driver;
mod event_driven;
mod first_switch;
mod guard;
mod instant;
mod interpolant;
pub(crate) mod lockstep;
mod resolve_modes;
mod root;
mod settings;
mod switch_model;
mod taylor;
mod variational;

pub(crate) use cancellation::unwind_if_cancelled;
pub use cancellation::{Cancellation, is_cancelled};
pub use contact::{Phase, contacts, derivative, forces, stick_reserve};
pub use dop853::{Step, Tolerance};
pub use driver::{Motion, SLOW};
pub use instant::Instant;
pub use interpolant::Interpolant;
pub use lockstep::SimdLevel;
pub use root::fall_through_zero;
pub use settings::{Effort, Settings, most_steps_by};
pub use switch_model::{SLACK, decide};
pub use taylor::Expansion;
pub use variational::Variational;

use serde::{Deserialize, Serialize};
use thiserror::Error;

/// The reason why a motion could not be continued.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error, Serialize, Deserialize)]
pub enum Failure {
    /// A state or force is infinite or not a number.
    #[error("the state is no longer finite")]
    NotFinite,
    /// A normal force turned negative: a ball would leave the ring, which the model has no
    /// equations for.
    #[error("the normal force on ball {ball} turned negative: it would leave the ring")]
    ContactLost {
        /// The ball, from 1.
        ball: usize,
    },
    /// The limit of steps and switches was reached, or the step length fell below the minimum.
    #[error("more steps than the limit, or a step length below the smallest possible one")]
    StepLimit,
    /// Stick and slip cannot be decided: no combination meets all conditions, or several do.
    #[error("{} all conditions", resolve_modes::combinations_meet(*.solutions))]
    NoSolution {
        /// Number of combinations with different accelerations that meet all conditions.
        solutions: usize,
    },
}
