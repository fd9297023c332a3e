//! Motions in lockstep: eight runs side by side in the lanes of SIMD vectors.
//!
//! Each lane has its own parameters, time, step and phases. From the states in all lanes the motion
//! is expanded into power series. The series determine how far they are accurate and where a contact first changes its
//! phase. Each lane then advances to that point (`advance`): no step is rejected, no step crosses an event, and only
//! rare work (locating an event, deciding stick and slip there, endings) is done lane by lane.
//!
//! Two kernels expand a motion: `general` evaluates the recorded equations of any system, and `tuned` is the recurrence
//! of the balancer with friction that is constant or linear in speed.
//!
//! A lane depends only on its own values: no operation mixes lanes, and all operations are
//! correctly rounded (`+ - * /`, square root, fused multiply-add). A run is therefore the same bit
//! for bit in any lane, beside any neighbours, and in vectors of any width.

mod advance;
mod curve;
mod gaps;
mod general;
mod group;
mod held;
mod kernel;
mod lane;
mod lane_group;
#[cfg(test)]
mod leaving_the_ring;
mod machine_code;
mod pressure;
mod root_isolation;
mod run;
mod simd_level;
mod step_length;
mod step_states;
mod trigonometry;
mod tuned;
mod vector;

use std::sync::Arc;

use fearless_simd::f64x8;

use crate::model::System;
use crate::motion::lockstep::vector::Vector;
use group::Group;
pub(crate) use lane::Saved;
pub(crate) use lane_group::{Happened, LaneGroup};
pub(super) use root_isolation::width;
pub use simd_level::SimdLevel;

/// Runs side by side.
pub(crate) const LANES: usize = 8;

/// One number of each run.
pub(crate) type Lanes<S> = f64x8<S>;

/// The highest power of time in the series of speeds.
const ORDER: usize = 16;

/// Returns empty lanes for a system, computed with these instructions. The unit tests need two of the tuned kernels only,
/// whose compilation takes long.
fn lanes_with<S: Vector>(simd: S, system: &Arc<dyn System>) -> Box<dyn LaneGroup> {
    let changes = system.speed_terms().is_some();
    macro_rules! tuned {
        ($($balls:literal)*) => {
            $(
                if tuned::Tuned::<S, $balls>::computes(system) {
                    let kernel = tuned::Tuned::<S, $balls>::new(simd, changes);
                    return Box::new(Group::new(simd, kernel));
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
fn general_lanes<S: Vector>(simd: S, system: &Arc<dyn System>) -> Box<dyn LaneGroup> {
    Box::new(Group::new(simd, general::General::new(simd, system)))
}
