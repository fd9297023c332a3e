//! The length of a step, from the last coefficients of the series.
//!
//! The contribution of the last two coefficients of the speeds' series at the step's end stays
//! below the tolerance; because such series decrease from term to term, the truncated part is
//! even smaller.

use fearless_simd::prelude::*;

use super::{Lanes, ORDER};
use crate::motion::lockstep::vector::Vector;

/// Fraction of the tolerance that the last coefficients may contribute. With it, errors are those
/// of DOP853 at the same tolerance (`benches/README.md`).
const SAFETY: f64 = 0.1;

/// Returns the longest step, from the last two coefficients of the speeds over the errors allowed; `before` is the length
/// of the previous step.
#[inline(always)]
pub(super) fn longest_step<S: Vector>(
    [last, last_but_one]: [Lanes<S>; 2],
    before: Lanes<S>,
) -> Lanes<S> {
    const _: () = assert!(ORDER == 16, "the root is taken for this order");
    // The last but one lacks one power of time: that of the previous step is used.
    let most = last.max(last_but_one * reciprocal(before));
    inverse_sixteenth_root(most * Lanes::splat(before.simd, 1.0 / SAFETY))
}

/// Returns `1/x` of positive numbers to 13 % by integer arithmetic on the exponent; the sixteenth
/// root reduces the error to below 1 %. A division takes many times as long.
#[inline(always)]
pub(super) fn reciprocal<S: Vector>(x: Lanes<S>) -> Lanes<S> {
    /// Twice the bits of 1, minus a correction that balances the errors.
    const TWICE: u64 = 0x7fde_6238_22fc_16e6;
    let bits: fearless_simd::u64x8<S> = x.bitcast();
    (fearless_simd::u64x8::splat(x.simd, TWICE) - bits).bitcast()
}

/// Returns `x^(-1/16)` of positive numbers to 2 %: integer arithmetic on the exponent, and square
/// roots for its last quarter.
#[inline(always)]
fn inverse_sixteenth_root<S: Vector>(x: Lanes<S>) -> Lanes<S> {
    /// Five fourths of the bits of 1.
    const ONE: u64 = 0x4fec_0000_0000_0000;
    let bits: fearless_simd::u64x8<S> = x.max(Lanes::splat(x.simd, 1e-200)).bitcast();
    let fourth: Lanes<S> = (fearless_simd::u64x8::splat(x.simd, ONE) - (bits >> 2)).bitcast();
    fourth.sqrt().sqrt()
}

#[cfg(test)]
mod tests {
    use super::{inverse_sixteenth_root, reciprocal};
    use crate::motion::lockstep::simd_level::with_each_level;
    use crate::motion::lockstep::vector::{Vector, vectorized};
    use crate::motion::lockstep::{LANES, Lanes};
    use fearless_simd::prelude::*;

    #[test]
    fn reciprocals() {
        with_each_level!(simd => reciprocals_are_near(simd));
    }

    fn reciprocals_are_near(simd: impl Vector) {
        for exponent in -300..300 {
            let number = 1.7 * libm::exp10(f64::from(exponent));
            let found = vectorized!(simd, reciprocal(Lanes::splat(simd, number)))[0];
            assert!((found * number - 1.0).abs() < 0.13, "{found} of {number}");
        }
    }

    #[test]
    fn sixteenth_roots() {
        with_each_level!(simd => roots_are_near(simd));
    }

    fn roots_are_near(simd: impl Vector) {
        for exponent in -100..100 {
            let number = |lane: usize| libm::exp10(f64::from(exponent) + 0.13 * lane as f64);
            let mut numbers = Lanes::splat(simd, 0.0);
            (0..LANES).for_each(|lane| numbers[lane] = number(lane));
            let roots = vectorized!(simd, inverse_sixteenth_root(numbers));
            for lane in 0..LANES {
                let expected = libm::pow(number(lane), -1.0 / 16.0);
                let off = (roots[lane] / expected - 1.0).abs();
                assert!(off < 0.02, "{off} of {}", number(lane));
            }
        }
    }
}
