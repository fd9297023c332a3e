//! Data of the figures of a report.

mod animation;
/// The equilibrium set behind the rest positions.
mod equilibrium_set;
/// Rest positions of the balls.
mod preferred;
/// Cells of maps, and points in detail.
mod sweeps;
