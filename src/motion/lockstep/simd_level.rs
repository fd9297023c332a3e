//! The vector instruction set, detected at run time.

use std::sync::{Arc, OnceLock};

use fearless_simd::Level;

use super::lane_group::LaneGroup;
use super::lanes_with;
use super::vector::Baseline;
use crate::model::System;

/// The vector instructions of the lockstep engine. Results do not depend on them.
#[derive(Clone, Copy, Debug)]
pub struct SimdLevel(Instructions);

#[derive(Clone, Copy, Debug)]
enum Instructions {
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
                let baseline = level.as_sse2().expect("every x86-64 processor has SSE2");
                levels.push(Instructions::Baseline(baseline));
            }
        }
        #[cfg(target_arch = "aarch64")]
        levels.extend(level.as_neon().map(Instructions::Neon));
        #[cfg(not(target_arch = "x86_64"))]
        {
            let _ = level;
            levels.push(Instructions::Baseline(Baseline::new()));
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

    /// Returns the instructions with vectors of four numbers, if available.
    #[cfg(all(test, target_arch = "x86_64"))]
    pub(super) fn avx2(self) -> Option<fearless_simd::Avx2> {
        Level::new().as_avx2()
    }

    /// Returns empty lanes for a system.
    pub(crate) fn lanes(self, system: &Arc<dyn System>) -> Box<dyn LaneGroup> {
        match self.0 {
            #[cfg(target_arch = "x86_64")]
            Instructions::Avx512(simd) => lanes_with(simd, system),
            #[cfg(target_arch = "x86_64")]
            Instructions::Avx2(simd) => lanes_with(simd, system),
            #[cfg(target_arch = "aarch64")]
            Instructions::Neon(simd) => lanes_with(simd, system),
            Instructions::Baseline(simd) => baseline_lanes(simd, system),
        }
    }
}

/// Returns empty lanes for processors without a vectorised fused multiply-add. Builds with debug assertions have no tuned
/// kernels for them, which take half of the compiler's time; their results agree with the others within the tolerances.
fn baseline_lanes(simd: Baseline, system: &Arc<dyn System>) -> Box<dyn LaneGroup> {
    #[cfg(not(debug_assertions))]
    return lanes_with(simd, system);
    #[cfg(debug_assertions)]
    super::general_lanes(simd, system)
}
