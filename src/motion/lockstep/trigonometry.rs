//! Sine and cosine of the angles in all lanes.
//!
//! Reduction to [-π/4, π/4] by two parts of π/2 (Cody and Waite; exact to 2^-107 |x| with fused
//! multiply-add), then the polynomials of FDLIBM (`k_sin.c`, `k_cos.c`). For |x| up to 1e5; error
//! below 1.5 units in the last place. Every operation is correctly rounded and independent for each
//! lane, so that the result does not depend on the machine or on other lanes.

use crate::motion::lockstep::vector::{Fused, Vector};
use fearless_simd::{f64x8, prelude::*};

const TWO_OVER_PI: f64 = std::f64::consts::FRAC_2_PI;
const HALF_PI_HIGH: f64 = std::f64::consts::FRAC_PI_2;
/// Remainder of π/2 after its double.
const HALF_PI_LOW: f64 = 6.123_233_995_736_766e-17;
/// Adding and subtracting this rounds to an integer, and leaves it in the lowest bits.
const ROUNDER: f64 = 6_755_399_441_055_744.0; // 1.5 · 2^52

const SINE: [f64; 6] = [
    -1.666_666_666_666_663_2e-1,
    8.333_333_333_322_49e-3,
    -1.984_126_982_985_795e-4,
    2.755_731_370_707_006_8e-6,
    -2.505_076_025_340_686_3e-8,
    1.589_690_995_211_55e-10,
];
const COSINE: [f64; 6] = [
    4.166_666_666_666_66e-2,
    -1.388_888_888_887_411e-3,
    2.480_158_728_947_673e-5,
    -2.755_731_435_139_066_3e-7,
    2.087_572_321_298_175e-9,
    -1.135_964_755_778_819_5e-11,
];

/// Sine and cosine of each lane.
#[inline(always)]
pub(super) fn sin_cos<S: Vector>(angle: f64x8<S>) -> (f64x8<S>, f64x8<S>) {
    let simd = angle.simd;
    macro_rules! c {
        ($value:expr) => {
            f64x8::splat(simd, $value)
        };
    }
    let shifted = angle.fused(c!(TWO_OVER_PI), c!(ROUNDER));
    let quarter = shifted - c!(ROUNDER);
    let r = quarter.fused(c!(-HALF_PI_HIGH), angle);
    let r = quarter.fused(c!(-HALF_PI_LOW), r);
    let z = r * r;
    // Two polynomials in z, by Estrin's scheme: short chains.
    let z2 = z * z;
    let z4 = z2 * z2;
    let s01 = z.fused(c!(SINE[1]), c!(SINE[0]));
    let s23 = z.fused(c!(SINE[3]), c!(SINE[2]));
    let s45 = z.fused(c!(SINE[5]), c!(SINE[4]));
    let s = z4.fused(s45, z2.fused(s23, s01));
    let sine = (r * z).fused(s, r);
    let c01 = z.fused(c!(COSINE[1]), c!(COSINE[0]));
    let c23 = z.fused(c!(COSINE[3]), c!(COSINE[2]));
    let c45 = z.fused(c!(COSINE[5]), c!(COSINE[4]));
    let k = z4.fused(c45, z2.fused(c23, c01));
    let cosine = z2.fused(k, z.fused(c!(-0.5), c!(1.0)));
    // Quarter turns: odd ones exchange the two, bit 1 turns signs.
    let bits: fearless_simd::u64x8<S> = shifted.bitcast();
    let one = fearless_simd::u64x8::splat(simd, 1);
    let odd = (bits & one).simd_eq(one);
    let (sine, cosine) = (odd.select(cosine, sine), odd.select(sine, cosine));
    let sign_of_sine = (bits >> 1) << 63;
    let sign_of_cosine = ((bits + one) >> 1) << 63;
    (flip(sine, sign_of_sine), flip(cosine, sign_of_cosine))
}

/// Changes the sign where the highest bit of `sign` is set.
#[inline(always)]
fn flip<S: Vector>(value: f64x8<S>, sign: fearless_simd::u64x8<S>) -> f64x8<S> {
    let bits: fearless_simd::u64x8<S> = value.bitcast();
    (bits ^ sign).bitcast()
}

#[cfg(test)]
mod tests {
    use super::sin_cos;
    use crate::motion::lockstep::simd_level::with_each_level;
    use crate::motion::lockstep::vector::{Vector, vectorized};
    use crate::motion::lockstep::{LANES, Lanes};
    use fearless_simd::prelude::*;

    /// Results agree with the library's within two units in the last place, up to the angles of a
    /// long run.
    #[test]
    fn sines_and_cosines() {
        with_each_level!(simd => agree_with_the_library(simd));
    }

    fn agree_with_the_library(simd: impl Vector) {
        let mut worst: f64 = 0.0;
        for k in 0..20_000 {
            let angle = |lane: usize| {
                let share = f64::from(k) * 0.754_877_666_246_693 + lane as f64 * 0.137;
                (share.fract() - 0.5) * f64::powi(10.0, 1 + k % 5)
            };
            let mut angles = Lanes::splat(simd, 0.0);
            (0..LANES).for_each(|lane| angles[lane] = angle(lane));
            let (sines, cosines) = vectorized!(simd, sin_cos(angles));
            for lane in 0..LANES {
                let (sine, cosine) = libm::sincos(angle(lane));
                for (found, expected) in [(sines[lane], sine), (cosines[lane], cosine)] {
                    worst = worst.max((found - expected).abs() / expected.abs().max(1e-3));
                }
            }
        }
        assert!(worst < 2.0 * f64::EPSILON, "{worst}");
    }
}
