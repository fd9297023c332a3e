//! What can be said about a study without simulation: closed forms of its machine, and warnings about values that are
//! probably mistakes.
//!
//! A study that resolves is valid: every run of it can be planned. It can still describe a machine that cannot be built
//! or that cannot balance. This module finds such machines; it computes no run.
//!
//! Read `ball_fit`, `steady_state` and `steady` first. `held_set` is the equilibrium set of any system.
//! `facts` then collects the facts about a ball balancer or about any other system.
//! `designs` selects the points of a large sweep and the designs of a search. Warnings build on these: `unit_mistakes`
//! and `values` examine one machine, and `conditions` examines the study. `warnings` collects all of them.

mod ball_fit;
mod conditions;
mod designs;
mod facts;
mod held_set;
mod steady;
mod steady_state;
mod unit_mistakes;
mod values;
mod warning;
mod warnings;

pub use ball_fit::{BallPositions, density_kg_m3, occupied_angle};
pub use conditions::{Obstacle, is_held_everywhere};
pub use designs::{ExaminedDesign, points_to_examine};
pub use facts::{BalancerFacts, OwnFacts, RestFacts};
pub use held_set::HeldSet;
pub use steady::{HeldPosition, SteadySearch, SteadyStates};
pub use steady_state::SteadyValues;
pub use warning::Warning;
pub use warnings::warnings;
