//! The order of the power series in time.

/// The highest power of time in the series of speeds.
pub(super) const ORDER: usize = 16;

/// Coefficients of a power series in time.
pub(super) type Powers = [f64; POWERS];

/// The largest number of coefficients of a series.
pub(super) const POWERS: usize = ORDER + 2;
