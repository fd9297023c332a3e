//! The kernel of any recorded system: its expressions are evaluated order by order.
//!
//! Modes of contacts and parameters are inputs of the expressions, so that lanes with other parameters in other modes
//! share the operations.

mod compiled;
mod compiler;
mod conditions;
mod kernel;
mod lu_factors;
mod operations;
mod program_forces;
mod radius;
mod schedule;
mod series;
mod statics;
mod turning;
mod workspace;

pub(super) use kernel::GeneralKernel;
