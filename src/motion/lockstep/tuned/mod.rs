//! The recurrence of the balancer with friction that is constant or linear in speed.
//!
//! It gives the same series as the recorded equations (`general`) several times as fast: the products are chosen so
//! that few remain, everything has a size known to the compiler, and bounds of the conditions come from few numbers.
//!
//! Read first `terms` and `equations`, then `gap_forces`, which adds forces between balls that touch. `recurrence` computes
//! one order from those below, `series` expands the motion, and `perturbation` carries perturbations. `event_functions`
//! finds the lanes in which a condition may fail, and `event_location` the condition that fails first. `balancer_forces`
//! decides stick and slip, `rest_ahead` detects rest, and `kernel` puts all of them together.

mod balancer_forces;
#[cfg(test)]
mod compared_with_equations;
#[cfg(test)]
mod compared_with_general;
mod equations;
mod event_functions;
mod event_location;
mod gap_forces;
mod kernel;
mod perturbation;
mod recurrence;
mod rest_ahead;
mod series;
mod terms;

pub(super) use balancer_forces::with_balancer_forces;
#[cfg(test)]
pub(super) use equations::contact;
pub(super) use kernel::TunedKernel;
pub(super) use terms::angles;
