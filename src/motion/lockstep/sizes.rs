//! The sizes of what is computed in lockstep: the lanes of vectors, and the power series in time.

use fearless_simd::f64x8;

/// Runs side by side.
pub(crate) const LANES: usize = 8;

/// One number of each run.
pub(crate) type Lanes<S> = f64x8<S>;

/// The highest power of time in the series of speeds.
pub(super) const ORDER: usize = 16;

/// Coefficients of the series of positions, whose highest power is one more.
pub(super) const TERMS: usize = ORDER + 2;

/// Coefficients of a power series in time.
pub(crate) type Powers = [f64; TERMS];
