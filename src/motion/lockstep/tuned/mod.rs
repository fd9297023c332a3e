//! The recurrence of the balancer with friction that is constant or linear in speed.
//!
//! It gives the same series as the recorded equations (`general`) several times as fast: the products are chosen so
//! that few remain, everything has a size known to the compiler, and bounds of the conditions come from few numbers.

#[cfg(test)]
mod compared_with_equations;
#[cfg(test)]
mod compared_with_general;
mod equations;
mod event_functions;
mod event_location;
mod flow;
mod gap_forces;
mod kernel;
mod mode_selection;
mod recurrence;
mod rest_ahead;
mod series;
mod step;
mod tail_terms;
mod tangent;
mod terms;
mod turning;

pub(super) use flow::angles;
pub(super) use kernel::TunedKernel;
pub(super) use mode_selection::in_state;
