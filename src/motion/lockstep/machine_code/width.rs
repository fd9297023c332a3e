//! The widths of the vector registers for which machine code is made.

use std::sync::OnceLock;

use crate::motion::lockstep::LANES;

/// The widths of vector registers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::motion::lockstep) enum Width {
    /// AVX-512: all lanes in each of 32 registers.
    Eight,
    /// AVX2: half of the lanes in each of 16 registers; the code runs twice.
    Four,
    /// AVX2: one number in each of 16 registers, for the cells of one run.
    One,
}

impl Width {
    /// Returns the size of a cell.
    pub(super) const fn bytes(self) -> usize {
        match self {
            Width::Eight | Width::Four => 8 * LANES,
            Width::One => 8,
        }
    }

    /// Returns whether the processor has the instructions.
    pub(super) fn is_here(self) -> bool {
        #[cfg(target_arch = "x86_64")]
        return match self {
            Width::Eight => is_x86_feature_detected!("avx512f"),
            Width::Four | Width::One => {
                is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma")
            }
        };
        #[cfg(not(target_arch = "x86_64"))]
        false
    }

    /// Returns the width of code that runs beside vector instructions with code of this width. Processors before Ice Lake
    /// have AVX-512 without all of its parts: code needs the first part alone. The environment variable
    /// `STICKSLIP_INSTRUCTIONS=avx2` prevents it.
    pub(in crate::motion::lockstep) fn widest(self) -> Width {
        static HAS_EIGHT: OnceLock<bool> = OnceLock::new();
        let has_eight = HAS_EIGHT.get_or_init(|| {
            let asked = std::env::var_os("STICKSLIP_INSTRUCTIONS");
            Width::Eight.is_here() && asked.is_none_or(|value| value != "avx2")
        });
        if *has_eight { Width::Eight } else { self }
    }
}
