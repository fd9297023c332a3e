//! Lockstep: several runs of the balancer side by side in the lanes of SIMD vectors.
#![forbid(unsafe_code)]
/// Runs an expression at one of the levels that this prototype compiles.
#[macro_export]
macro_rules! at_level {
    ($level:expr, $simd:ident => $op:expr) => {
        match $level {
            fearless_simd::Level::Avx512($simd) => fearless_simd::Simd::vectorize(
                $simd,
                #[inline(always)]
                || $op,
            ),
            fearless_simd::Level::Avx2($simd) => fearless_simd::Simd::vectorize(
                $simd,
                #[inline(always)]
                || $op,
            ),
            _ => unimplemented!(),
        }
    };
}

pub mod array;
pub mod driver;
pub mod equations;
pub mod inertial;
pub mod locate;
pub mod modal;
pub mod sincos;
pub mod step;
pub mod tableau;
