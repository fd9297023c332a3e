//! Data of the figures of a report.

mod animation;
/// Rank correlations and amplitudes over uncertain parameters.
mod drawn;
/// The equilibrium set behind the rest positions.
mod equilibrium_set;
/// The page of a search.
mod optimum;
/// Balls with contact: where they would overlap, and rests that touch.
mod overlap;
/// Rest positions of the balls.
mod preferred;
/// Cells of maps, and points in detail.
mod sweeps;
/// Residual vibration, and vibration without balls.
mod vibration;
