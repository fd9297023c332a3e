//! What can be said about a study without simulation: closed forms of its machine, and warnings about values that are
//! probably slips.
//!
//! A study that resolves is valid: every run of it can be planned. It can still describe a machine that cannot be
//! built or that cannot balance. This module finds such machines; it computes no run.
//!
//! Read `ball_fit` and `steady` first, then `closed_form` and `own_facts`: what is known of a ball balancer and of another
//! system. `points` selects the points of a large sweep, and `designs` the designs of a search. Warnings build on these:
//! `slips` and `values` concern one machine, `conditions` and `obstacle` the study, and `warnings` collects all of them.

mod ball_fit;
mod closed_form;
mod conditions;
mod designs;
mod obstacle;
mod own_facts;
mod points;
mod slips;
mod steady;
mod values;
mod warning;
mod warnings;

pub use ball_fit::{BallPositions, density_kg_m3, occupied_angle};
pub use closed_form::{BalancerFacts, RestFacts};
pub use conditions::is_held_everywhere;
pub use designs::ExaminedDesign;
pub use obstacle::Obstacle;
pub use own_facts::OwnFacts;
pub use points::points_to_examine;
pub use steady::{SteadySliding, SteadyStates};
pub use warning::Warning;
pub use warnings::warnings;
