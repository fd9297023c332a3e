//! The vector instruction set, detected at run time.

use fearless_simd::Level;

/// The vector instructions of the lockstep engine. Results do not depend on them.
#[derive(Clone, Copy, Debug)]
pub struct SimdLevel(Level);

impl SimdLevel {
    /// Returns the best level of this processor.
    pub fn best() -> Self {
        SimdLevel(Level::new())
    }

    /// Returns all levels of this processor, the best first, for comparison.
    pub fn all() -> Vec<Self> {
        let best = Self::best();
        let mut levels = vec![best];
        #[cfg(target_arch = "x86_64")]
        if let (Some(_), Some(avx2)) = (best.avx512(), best.avx2()) {
            levels.push(SimdLevel(Level::Avx2(avx2)));
        }
        levels
    }

    /// Returns the name: `avx512`, `avx2`, `neon`; `none` if the processor lacks a vectorised fused
    /// multiply-add, which lockstep requires. Runs are then computed one at a time.
    pub fn name(self) -> &'static str {
        match self.0 {
            #[cfg(target_arch = "x86_64")]
            Level::Avx512(_) => "avx512",
            #[cfg(target_arch = "x86_64")]
            Level::Avx2(_) => "avx2",
            #[cfg(target_arch = "aarch64")]
            Level::Neon(_) => "neon",
            _ => "none",
        }
    }

    /// Returns the instructions with vectors of eight numbers, if available.
    #[cfg(target_arch = "x86_64")]
    pub(crate) fn avx512(self) -> Option<fearless_simd::Avx512> {
        match self.0 {
            Level::Avx512(simd) => Some(simd),
            _ => None,
        }
    }

    /// Returns the instructions with vectors of four numbers, if available.
    #[cfg(target_arch = "x86_64")]
    pub(crate) fn avx2(self) -> Option<fearless_simd::Avx2> {
        self.0.as_avx2()
    }

    /// Returns the instructions with vectors of two numbers, if available.
    #[cfg(target_arch = "aarch64")]
    pub(crate) fn neon(self) -> Option<fearless_simd::Neon> {
        self.0.as_neon()
    }
}
