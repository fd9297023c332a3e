//! The choice of the kernel that computes the runs of a system.

use std::sync::Arc;

use super::general::GeneralKernel;
use super::kernel_lanes::KernelLanes;
use super::lane_group::LaneGroup;
use super::simd_level::{Instructions, SimdLevel};
use super::tuned::TunedKernel;
use super::vector::{Baseline, Vector};
use crate::model::System;

impl SimdLevel {
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

/// Returns whether a tuned kernel computes a system, where it is compiled.
pub(crate) fn suits_tuned_kernel(system: &Arc<dyn System>) -> bool {
    macro_rules! computes {
        ($($balls:literal)*) => { $(TunedKernel::<Baseline, $balls>::computes(system))||* };
    }
    computes!(1 2 3 4 5 6 7 8)
}

/// Returns empty lanes for processors without a vectorised fused multiply-add. Builds with debug assertions have no tuned
/// kernels for them, which take half of the compiler's time; their results agree with the others within the tolerances.
fn baseline_lanes(simd: Baseline, system: &Arc<dyn System>) -> Box<dyn LaneGroup> {
    #[cfg(not(debug_assertions))]
    return lanes_with(simd, system);
    #[cfg(debug_assertions)]
    general_lanes(simd, system)
}

/// Returns empty lanes for a system, computed with these instructions. The unit tests need two of the tuned kernels only,
/// whose compilation takes long.
fn lanes_with<S: Vector>(simd: S, system: &Arc<dyn System>) -> Box<dyn LaneGroup> {
    macro_rules! tuned {
        ($($balls:literal)*) => {
            $(
                if TunedKernel::<S, $balls>::computes(system) {
                    let kernel = TunedKernel::<S, $balls>::new(simd);
                    return Box::new(KernelLanes::new(simd, kernel));
                }
            )*
        };
    }
    tuned!(1 2);
    #[cfg(not(test))]
    tuned!(3 4 5 6 7 8);
    general_lanes(simd, system)
}

/// Returns empty lanes for a system, computed with these instructions by the general kernel.
pub(super) fn general_lanes<S: Vector>(simd: S, system: &Arc<dyn System>) -> Box<dyn LaneGroup> {
    Box::new(KernelLanes::new(simd, GeneralKernel::new(simd, system)))
}
