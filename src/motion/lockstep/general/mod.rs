//! The kernel of any recorded system: its expressions are evaluated order by order.
//!
//! Modes of contacts and parameters are inputs of the expressions, so that lanes with other parameters in other modes
//! share the operations.
//!
//! Read first `statics` and `operations`, the list of what is computed, then `turning` and `compiler`, which find this
//! list. `lu_factors`, `radius` and `series` make programs of it, and `compiled` keeps the programs. `workspace` has
//! the numbers that they compute in a step, `exponents` shortens a step, `conditions` locates events in it, and
//! `program_forces` decides stick and slip. `kernel` puts all of them together.

mod compiled;
mod compiler;
mod conditions;
mod exponents;
mod kernel;
mod lu_factors;
mod operations;
mod program_forces;
mod radius;
mod series;
mod statics;
mod turning;
mod workspace;

pub(super) use kernel::GeneralKernel;
