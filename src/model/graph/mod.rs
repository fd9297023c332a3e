//! The equations of a system as a graph of expressions, recorded once per system.
//!
//! A system writes its equations with [`Expression`]s, which have the operators of numbers. The graph then gives
//! values, power series in time of any order, and both along a displacement, by code that knows no system.
//!
//! Read `node` first: the operations of a graph. A [`Recorder`] collects nodes, and an [`Expression`] adds one with
//! each operator and has derivatives. `quantities` gives a system its inputs, its components of the state and its
//! unknowns. `equations` lists what a system returns, `part` evaluates some of its results alone, and `recorded` makes the
//! [`Graph`]. `degree`, `lasting` and `find_translations` examine the graph, and `per_structure` keeps what is computed once for all
//! systems with equal equations.

mod degree;
mod equations;
mod expression;
mod find_translations;
mod lasting;
mod node;
mod part;
mod per_structure;
mod quantities;
mod recorded;
mod recorder;
mod translation;

pub use degree::Degree;
pub use equations::{
    ContactEquations, ContactLayout, Event, EventEquations, ForcingLayout, GapEquations, Opening,
    OpeningEquations, StateLayout, SystemEquations,
};
pub use expression::Expression;
pub use node::{Node, NodeId, Solve};
pub(crate) use part::GraphPart;
pub(crate) use per_structure::PerStructure;
pub use per_structure::Structure;
pub use recorded::Graph;
pub use recorder::Recorder;
pub use translation::{Translation, Translations};
