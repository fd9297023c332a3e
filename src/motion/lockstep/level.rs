//! Which vector instructions are used: found when the program runs.

use fearless_simd::Level;

/// The vector instructions that runs in lockstep are computed with. Results do not depend on it.
#[derive(Clone, Copy, Debug)]
pub struct VectorLevel(pub(crate) Level);

impl VectorLevel {
    /// The best that this processor has.
    pub fn best() -> Self {
        VectorLevel(Level::new())
    }

    /// All that this processor has, the best first; for comparing them.
    pub fn all() -> Vec<Self> {
        let best = Level::new();
        let mut levels = vec![VectorLevel(best)];
        #[cfg(target_arch = "x86_64")]
        if let (Level::Avx512(_), Some(avx2)) = (best, best.as_avx2()) {
            levels.push(VectorLevel(Level::Avx2(avx2)));
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

    /// Whether runs can be computed in lockstep.
    pub fn is_sufficient(self) -> bool {
        self.name() != "none"
    }
}

/// Evaluates an expression with the token of a level as `$simd`; another one where the level is not
/// sufficient.
macro_rules! at_level {
    ($level:expr, $simd:ident => $op:expr, else $other:expr) => {
        match $level.0 {
            #[cfg(target_arch = "x86_64")]
            fearless_simd::Level::Avx512($simd) => $op,
            #[cfg(target_arch = "x86_64")]
            fearless_simd::Level::Avx2($simd) => $op,
            #[cfg(target_arch = "aarch64")]
            fearless_simd::Level::Neon($simd) => $op,
            _ => $other,
        }
    };
}
pub(crate) use at_level;
