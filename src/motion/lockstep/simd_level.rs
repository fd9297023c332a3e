//! The vector instruction set, detected at run time.

use std::sync::OnceLock;

use fearless_simd::{Level, Simd};

use super::machine_code;
use super::vector::{Baseline, Vector, vectorized};

/// The vector instructions of the lockstep engine. Results do not depend on them.
#[derive(Clone, Copy, Debug)]
pub struct SimdLevel(pub(super) Instructions);

#[derive(Clone, Copy, Debug)]
pub(super) enum Instructions {
    #[cfg(target_arch = "x86_64")]
    Avx512(fearless_simd::Avx512),
    #[cfg(target_arch = "x86_64")]
    Avx2(fearless_simd::Avx2),
    #[cfg(target_arch = "aarch64")]
    Neon(fearless_simd::Neon),
    /// Those of every processor of its kind, without a vectorised fused multiply-add.
    Baseline(Baseline),
}

impl SimdLevel {
    /// Returns the best level of this processor, or that which the environment variable `STICKSLIP_INSTRUCTIONS` names:
    /// `baseline` gives the results of a processor without vector instructions, for a comparison.
    pub fn best() -> Self {
        static CHOSEN: OnceLock<SimdLevel> = OnceLock::new();
        *CHOSEN.get_or_init(|| {
            let levels = Self::all();
            let asked = std::env::var("STICKSLIP_INSTRUCTIONS").unwrap_or_default();
            levels.iter().copied().find(|level| level.name() == asked).unwrap_or(levels[0])
        })
    }

    /// Returns the levels of this processor that give the same results, the best first.
    pub fn all() -> Vec<Self> {
        let level = Level::new();
        let mut levels = Vec::new();
        #[cfg(target_arch = "x86_64")]
        {
            levels.extend(level.as_avx512().map(Instructions::Avx512));
            levels.extend(level.as_avx2().map(Instructions::Avx2));
            // Without optimisation, the baseline computes with the general kernel (`baseline_lanes`).
            if levels.is_empty() || cfg!(not(debug_assertions)) {
                levels.push(Instructions::Baseline(baseline()));
            }
        }
        #[cfg(target_arch = "aarch64")]
        levels.extend(level.as_neon().map(Instructions::Neon));
        #[cfg(not(target_arch = "x86_64"))]
        {
            let _ = level;
            levels.push(Instructions::Baseline(baseline()));
        }
        levels.into_iter().map(SimdLevel).collect()
    }

    /// Returns the name: `avx512`, `avx2`, `neon` or `baseline`.
    pub fn name(self) -> &'static str {
        match self.0 {
            #[cfg(target_arch = "x86_64")]
            Instructions::Avx512(_) => "avx512",
            #[cfg(target_arch = "x86_64")]
            Instructions::Avx2(_) => "avx2",
            #[cfg(target_arch = "aarch64")]
            Instructions::Neon(_) => "neon",
            Instructions::Baseline(_) => "baseline",
        }
    }

    /// Returns how programs run with these instructions: `avx512 machine code`, or `baseline interpreter`. Where vectors are
    /// those of AVX2 and the machine code is not, `avx2, avx512 machine code`.
    pub fn path(self) -> String {
        let width = match self.0 {
            #[cfg(target_arch = "x86_64")]
            Instructions::Avx512(_) => fearless_simd::Avx512::WIDTH,
            #[cfg(target_arch = "x86_64")]
            Instructions::Avx2(_) => fearless_simd::Avx2::WIDTH,
            #[cfg(target_arch = "aarch64")]
            Instructions::Neon(_) => None,
            Instructions::Baseline(_) => Baseline::WIDTH,
        };
        match width.filter(|_| machine_code::is_allowed()) {
            None => format!("{} interpreter", self.name()),
            Some(width) if width.widest() == width => format!("{} machine code", self.name()),
            Some(_) => format!("{}, avx512 machine code", self.name()),
        }
    }

    /// Calls a function, which the compiler inlines and compiles for these instructions.
    #[inline(always)]
    pub(crate) fn run<R>(self, work: impl FnOnce() -> R) -> R {
        match self.0 {
            #[cfg(target_arch = "x86_64")]
            Instructions::Avx512(simd) => vectorized!(simd, work()),
            #[cfg(target_arch = "x86_64")]
            Instructions::Avx2(simd) => vectorized!(simd, work()),
            #[cfg(target_arch = "aarch64")]
            Instructions::Neon(simd) => vectorized!(simd, work()),
            Instructions::Baseline(_) => work(),
        }
    }
}

/// Returns the instructions of every processor of this kind.
pub(super) fn baseline() -> Baseline {
    #[cfg(target_arch = "x86_64")]
    return Level::new().as_sse2().expect("every x86-64 processor has SSE2");
    #[cfg(not(target_arch = "x86_64"))]
    Baseline::new()
}

/// Evaluates a test with the instructions of each level of this processor.
#[cfg(test)]
macro_rules! with_each_level {
    ($simd:ident => $test:expr) => {{
        #[cfg(target_arch = "x86_64")]
        if let Some($simd) = fearless_simd::Level::new().as_avx512() {
            $test;
        }
        #[cfg(target_arch = "x86_64")]
        if let Some($simd) = fearless_simd::Level::new().as_avx2() {
            $test;
        }
        #[cfg(target_arch = "aarch64")]
        if let Some($simd) = fearless_simd::Level::new().as_neon() {
            $test;
        }
        let $simd = $crate::motion::lockstep::simd_level::baseline();
        $test;
    }};
}
#[cfg(test)]
pub(super) use with_each_level;

/// Returns the vector instructions with which the tuned kernels are tested. Without any, says that the test of this thread
/// is skipped, on standard error, which the test harness does not capture: the kernels for such processors are not part
/// of builds with debug assertions.
#[cfg(test)]
pub(super) fn tested_vectors() -> Option<impl super::vector::Vector> {
    #[cfg(target_arch = "x86_64")]
    let vectors = Level::new().as_avx2();
    #[cfg(target_arch = "aarch64")]
    let vectors = Level::new().as_neon();
    #[cfg(not(any(target_arch = "x86_64", target_arch = "aarch64")))]
    let vectors = Some(baseline());
    if vectors.is_none() {
        let thread = std::thread::current();
        let test = thread.name().unwrap_or_default();
        let line = format!("test {test} ... skipped: this processor has no AVX2\n");
        let _ = std::io::Write::write_all(&mut std::io::stderr(), line.as_bytes());
    }
    vectors
}
