//! The recurrence of the balancer with friction that is constant or linear in speed.
//!
//! It gives the same series as the recorded equations (`general`) several times as fast: the products are chosen so
//! that few remain, everything has a size known to the compiler, and bounds of the conditions come from few numbers.

mod balancer_forces;
#[cfg(test)]
mod compared_with_equations;
#[cfg(test)]
mod compared_with_general;
mod drive;
mod equations;
mod event_functions;
mod event_location;
mod gap_forces;
mod kernel;
mod lane_states;
mod recurrence;
mod rest_ahead;
mod series;
mod step;
mod tail_terms;
mod tangent;
mod terms;

pub(super) use balancer_forces::with_balancer_forces;
pub(super) use kernel::TunedKernel;
pub(super) use lane_states::angles;
