//! The vectors and power series of runs in lockstep: their sizes, vector instructions with a fused multiply-add, and the
//! widths of registers.

use std::sync::OnceLock;

use fearless_simd::{Simd, f64x8};

/// Runs side by side.
pub(crate) const LANES: usize = 8;

/// One number of each run.
pub(crate) type Lanes<S> = f64x8<S>;

/// The highest power of time in the series of speeds.
pub(super) const ORDER: usize = 16;

/// Coefficients of the series of positions, whose highest power is one more.
pub(super) const TERMS: usize = ORDER + 2;

/// Coefficients of a power series in time.
pub(crate) type Powers = [f64; TERMS];

/// The widths of vector registers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Width {
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
    pub(super) fn widest(self) -> Width {
        static HAS_EIGHT: OnceLock<bool> = OnceLock::new();
        let has_eight = HAS_EIGHT.get_or_init(|| {
            let asked = std::env::var_os("STICKSLIP_INSTRUCTIONS");
            Width::Eight.is_here() && asked.is_none_or(|value| value != "avx2")
        });
        if *has_eight { Width::Eight } else { self }
    }
}

/// A level of vector instructions whose fused multiply-add is correctly rounded.
pub(super) trait Vector: Simd {
    /// Whether the processor has 32 registers that hold all lanes.
    const HAS_MANY_REGISTERS: bool;
    /// The width of the machine code that a processor of this level runs, if there is one.
    const WIDTH: Option<Width>;

    /// Returns `a b + c`, rounded once.
    fn fused_multiply_add(a: Lanes<Self>, b: Lanes<Self>, c: Lanes<Self>) -> Lanes<Self>;
}

/// The fused multiply-add as a method.
pub(super) trait Fused {
    /// Returns `self b + c`, rounded once.
    fn fused(self, b: Self, c: Self) -> Self;
}

impl<S: Vector> Fused for Lanes<S> {
    #[inline(always)]
    fn fused(self, b: Self, c: Self) -> Self {
        S::fused_multiply_add(self, b, c)
    }
}

/// Computes with the vector instructions of a level. The compiler inlines each of them, such as the fused multiply-add.
macro_rules! vectorized {
    ($simd:expr, $work:expr) => {
        $simd.vectorize(
            #[inline(always)]
            || {
                $crate::motion::lockstep::vector::align_frame();
                $work
            },
        )
    };
}
pub(super) use vectorized;

/// Aligns the frame of the function into which the compiler inlines this one to a cache line.
///
/// A frame without an aligned variable has the alignment of its caller. Vectors that are spilled there may then lie
/// across two cache lines, and unrelated code decides whether a step takes a fifth more time.
#[inline(always)]
pub(super) fn align_frame() {
    #[repr(align(64))]
    struct CacheLine {
        _first_byte: u8,
    }
    std::hint::black_box(&std::mem::MaybeUninit::<CacheLine>::uninit());
}

macro_rules! with_instruction {
    ($($level:ty, $has_many_registers:literal, $width:expr;)*) => {
        $(
            impl Vector for $level {
                const HAS_MANY_REGISTERS: bool = $has_many_registers;
                const WIDTH: Option<Width> = $width;

                #[inline(always)]
                fn fused_multiply_add(
                    a: Lanes<Self>,
                    b: Lanes<Self>,
                    c: Lanes<Self>,
                ) -> Lanes<Self> {
                    fearless_simd::prelude::SimdFloat::mul_add_precise(a, b, c)
                }
            }
        )*
    };
}

#[cfg(target_arch = "x86_64")]
with_instruction!(
    fearless_simd::Avx2, false, Some(Width::Four);
    fearless_simd::Avx512, true, Some(Width::Eight);
);
#[cfg(target_arch = "aarch64")]
with_instruction!(fearless_simd::Neon, false, None;);

/// The instructions of every processor of its kind.
#[cfg(target_arch = "x86_64")]
pub(super) type Baseline = fearless_simd::Sse2;
/// The instructions of every processor of its kind.
#[cfg(not(target_arch = "x86_64"))]
pub(super) type Baseline = fearless_simd::Fallback;

/// Processors without the instruction compute it one number at a time, in a function of its own, because the vectors'
/// emulation of the instruction would make the program many times as large.
impl Vector for Baseline {
    const HAS_MANY_REGISTERS: bool = false;
    const WIDTH: Option<Width> = None;

    #[inline(always)]
    fn fused_multiply_add(a: Lanes<Self>, b: Lanes<Self>, c: Lanes<Self>) -> Lanes<Self> {
        let mut result = c;
        one_at_a_time(&a, &b, &mut result);
        result
    }
}

#[inline(never)]
fn one_at_a_time(a: &Lanes<Baseline>, b: &Lanes<Baseline>, c: &mut Lanes<Baseline>) {
    for lane in 0..LANES {
        c[lane] = a[lane].mul_add(b[lane], c[lane]);
    }
}
