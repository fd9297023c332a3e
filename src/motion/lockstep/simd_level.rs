//! Which vector instructions are used: found when the program runs.

use fearless_simd::Level;

/// The vector instructions that runs in lockstep are computed with. Results do not depend on it.
#[derive(Clone, Copy, Debug)]
pub struct SimdLevel(Level);

impl SimdLevel {
    /// The best that this processor has.
    pub fn best() -> Self {
        SimdLevel(Level::new())
    }

    /// All that this processor has, the best first; for comparing them.
    pub fn all() -> Vec<Self> {
        let best = Self::best();
        let mut levels = vec![best];
        #[cfg(target_arch = "x86_64")]
        if let (Some(_), Some(avx2)) = (best.avx512(), best.avx2()) {
            levels.push(SimdLevel(Level::Avx2(avx2)));
        }
        levels
    }

    /// Its name: `avx512`, `avx2`, `neon`; `none` where the processor lacks what lockstep needs, a
    /// fused multiply-add in vectors. Runs are then computed one by one.
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

    /// The instructions with vectors of eight numbers, where they are at hand.
    #[cfg(target_arch = "x86_64")]
    pub(crate) fn avx512(self) -> Option<fearless_simd::Avx512> {
        match self.0 {
            Level::Avx512(simd) => Some(simd),
            _ => None,
        }
    }

    /// The instructions with vectors of four numbers, where they are at hand.
    #[cfg(target_arch = "x86_64")]
    pub(crate) fn avx2(self) -> Option<fearless_simd::Avx2> {
        self.0.as_avx2()
    }

    /// The instructions with vectors of two numbers, where they are at hand.
    #[cfg(target_arch = "aarch64")]
    pub(crate) fn neon(self) -> Option<fearless_simd::Neon> {
        self.0.as_neon()
    }
}
