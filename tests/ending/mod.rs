//! How runs end: against an independent integration, the thesis's numbers, and themselves.

mod certificate;
pub mod convergence;
mod limit_cycle;
mod reference;
