//! How runs end: against an independent integration, the thesis's numbers, and themselves.

mod certificate;
mod limit_cycle;
pub mod reference;
