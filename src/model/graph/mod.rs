//! The equations of a system as a graph of expressions, recorded once per system.
//!
//! A system writes its equations with [`Expression`]s, which have the operators of numbers. The graph then gives
//! values, power series in time of any order, and both along a displacement, by code that knows no system.

mod degree;
mod derivative;
mod expression;
mod node;
mod per_structure;
mod recorder;

pub use degree::Degree;
pub use expression::Expression;
pub use node::{Node, NodeId, Solve};
pub(crate) use per_structure::PerStructure;
pub use recorder::{
    ContactEquations, ContactLayout, Event, EventEquations, ForcingLayout, GapEquations, Graph,
    Layout, Opening, OpeningEquations, Recorder, SystemEquations,
};
