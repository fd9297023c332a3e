//! The kernel of any recorded system: its expressions are evaluated order by order.
//!
//! Modes of contacts and parameters are inputs of the expressions, so that lanes with other parameters in other modes
//! share the operations.

mod compiled;
mod compiler;
mod conditions;
mod deciding;
mod elimination;
mod flow;
mod kernel;
mod operations;
mod radius;
mod room;
mod schedule;
mod series;
mod statics;
mod turning;

pub(super) use kernel::GeneralKernel;
