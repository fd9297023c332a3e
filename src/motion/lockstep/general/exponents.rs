//! Steps that do not jump over what an exponential function hides.
//!
//! A pulse `exp(-((t - t_0) / w)²)`, or a force that is switched on by `tanh((t - t_0) / w)`, is far below the rounding of the other
//! terms before it begins, and so are the coefficients of its series. The length of a step, which the last coefficients determine, then
//! contains nothing of it. The argument `u` of the exponential function shows it: where `|u|` is above [`FLAT`], `exp u` or `1 / exp u`
//! is below rounding. From there, a step changes `u` at most by its distance from this bound, or by [`LEAST_CHANGE`]. Where `|u|` is
//! below the bound, the coefficients show what happens.

use fearless_simd::prelude::*;

use super::workspace::SeriesCoefficients;
use crate::motion::lockstep::vector::{Fused, Vector};
use crate::motion::lockstep::{Lanes, TERMS};

/// Beyond it, an exponential function or one over it is below the rounding of numbers near 1: `exp(-40) = 4e-18`.
const FLAT: f64 = 40.0;
/// A step may always change an argument by this much.
const LEAST_CHANGE: f64 = 4.0;
/// The number of times that a step may be halved.
const MOST_HALVES: usize = 100;

/// Returns a step of at most this length that does not bring an argument with these coefficients from the range in which its
/// exponential function is flat far out of it.
#[inline(always)]
pub(super) fn resolved<S: Vector>(
    argument: SeriesCoefficients<'_, S>,
    mut length: Lanes<S>,
) -> Lanes<S> {
    let simd = length.simd;
    let number = |value: f64| Lanes::splat(simd, value);
    let beyond = argument[0].abs() - number(FLAT);
    let is_flat = beyond.simd_gt(number(0.0));
    if is_flat.to_bitmask() == 0 {
        return length;
    }
    let allowed = is_flat.select(beyond.max(number(LEAST_CHANGE)), number(f64::INFINITY));
    for _ in 0..MOST_HALVES {
        let mut change = number(0.0);
        for k in (1..TERMS).rev() {
            change = change.fused(length, argument[k].abs());
        }
        let too_far = (change * length).simd_gt(allowed);
        if too_far.to_bitmask() == 0 {
            break;
        }
        length = too_far.select(number(0.5) * length, length);
    }
    length
}
