//! Motions in lockstep: eight runs side by side in the lanes of SIMD vectors.
//!
//! Each lane has its own parameters, time, step and phases. From the states in all lanes the motion
//! is expanded into power series (`series`). The series determine how far they are accurate
//! (`step`) and where a ball first changes its phase (`event_functions`, `event_location`). Each
//! lane then advances to that point: no step is rejected, no step crosses an event, and only rare
//! work (locating an event, deciding stick and slip there, endings) is done lane by lane.
//!
//! A lane depends only on its own values: no operation mixes lanes, and all operations are
//! correctly rounded (`+ - * /`, square root, fused multiply-add). A run is therefore the same bit
//! for bit in any lane, beside any neighbours, and in vectors of any width.

mod advance;
#[cfg(all(test, target_arch = "x86_64"))]
mod compared_with_one_run;
mod equations;
mod event_functions;
mod event_location;
mod group;
mod lane;
mod lane_states;
mod mode_selection;
mod recurrence;
mod root_isolation;
mod section_crossing;
mod series;
mod simd_level;
mod step;
mod tail_terms;
mod tangent;
mod terms;
mod trigonometry;

pub(crate) use advance::{Happened, advance};
pub(crate) use group::{Group, Room};
pub(crate) use lane::{Saved, Trouble};
pub use simd_level::SimdLevel;
pub(super) use terms::TERMS;

use fearless_simd::f64x8;

/// Runs side by side.
pub(crate) const LANES: usize = 8;

/// One number of each run.
pub(crate) type Lanes<S> = f64x8<S>;

/// The components of a state, or of its rate of change, of each run.
#[derive(Clone, Copy)]
pub(crate) struct Flow<S: fearless_simd::Simd, const N: usize> {
    /// x, y, ẋ, ẏ.
    pub(crate) table: [Lanes<S>; 4],
    /// Angles of the balls.
    pub(crate) angle: [Lanes<S>; N],
    /// Their speeds.
    pub(crate) speed: [Lanes<S>; N],
}

impl<S: fearless_simd::Simd, const N: usize> Flow<S, N> {
    /// Zero in all lanes.
    #[inline(always)]
    pub(crate) fn zero(simd: S) -> Self {
        use fearless_simd::SimdBase;
        let zero = Lanes::splat(simd, 0.0);
        Flow { table: [zero; 4], angle: [zero; N], speed: [zero; N] }
    }

    /// Returns one run's components.
    pub(crate) fn lane(&self, lane: usize) -> crate::model::State<N> {
        let [x, y, x_dot, y_dot] = self.table.each_ref().map(|of_all| of_all[lane]);
        crate::model::State {
            position: [x, y],
            velocity: [x_dot, y_dot],
            beta: self.angle.each_ref().map(|of_all| of_all[lane]),
            beta_dot: self.speed.each_ref().map(|of_all| of_all[lane]),
        }
    }

    /// Sets one run's components.
    pub(crate) fn set_lane(&mut self, lane: usize, state: &crate::model::State<N>) {
        for axis in 0..2 {
            self.table[axis][lane] = state.position[axis];
            self.table[2 + axis][lane] = state.velocity[axis];
        }
        for ball in 0..N {
            self.angle[ball][lane] = state.beta[ball];
            self.speed[ball][lane] = state.beta_dot[ball];
        }
    }
}
