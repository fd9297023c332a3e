//! Eight lanes with the runs in them, computed by a kernel.

use fearless_simd::prelude::*;
use smallvec::SmallVec;

use super::gap_conditions::OpenGaps;
use super::kernel::Kernel;
use super::lane::Lane;
use super::{LANES, Lanes};
use crate::motion::cluster::held_clusters;
use crate::motion::lockstep::vector::{Vector, vectorized};

/// Eight lanes, some of them empty.
pub(super) struct KernelLanes<S: Vector, K: Kernel<S>> {
    pub(super) simd: S,
    pub(super) kernel: K,
    pub(super) gaps: OpenGaps<S>,
    pub(super) workspace: Box<K::Workspace>,
    pub(super) state: K::LaneStates,
    pub(super) time: Lanes<S>,
    pub(super) until: Lanes<S>,
    pub(super) attention: Lanes<S>,
    pub(super) longest: Lanes<S>,
    pub(super) next: Lanes<S>,
    pub(super) tolerance: [Lanes<S>; 2],
    pub(super) turns: SmallVec<[Lanes<S>; 8]>,
    pub(super) slow: Lanes<S>,
    pub(super) slow_since: SmallVec<[Lanes<S>; 8]>,
    /// Number of steps taken.
    pub(super) taken: Lanes<S>,
    pub(super) most: Lanes<S>,
    /// Number of steps allowed per unit of time.
    pub(super) most_per_time: Lanes<S>,
    pub(super) perturbation: K::LaneStates,
    pub(super) lanes: [Option<Lane>; LANES],
    /// Bit masks: lanes with a run, and lanes with a contact that cannot stick.
    pub(super) alive: u64,
    pub(super) sliding: u64,
    /// Lanes for which turns and switches are reported.
    pub(super) reporting_lanes: u64,
    /// Lanes whose amplitude is watched, with the square of the amplitude above which a step is reported.
    pub(super) watched: u64,
    pub(super) watched_square: Lanes<S>,
    /// Lanes whose latest step ended with an event.
    pub(super) ended: u64,
    /// Lanes in which an event at the end of the latest step reset the state.
    pub(super) reset: u64,
    /// State, perturbation and time before the latest step.
    pub(super) before: K::LaneStates,
    pub(super) perturbation_before: K::LaneStates,
    pub(super) time_before: Lanes<S>,
    /// The step's end, with angles not yet reduced to one turn.
    pub(super) end: K::LaneStates,
    pub(super) length: Lanes<S>,
}

impl<S: Vector, K: Kernel<S>> KernelLanes<S, K> {
    /// Empty lanes.
    pub(super) fn new(simd: S, kernel: K) -> Self {
        let constant = |value: f64| Lanes::splat(simd, value);
        let zero = constant(0.0);
        let states = kernel.lane_states(simd);
        let of_contacts = SmallVec::from_elem(zero, kernel.contacts());
        KernelLanes {
            simd,
            gaps: OpenGaps::none(simd, kernel.contacts()),
            workspace: Box::new(kernel.workspace(simd)),
            state: states.clone(),
            time: zero,
            until: constant(1.0),
            attention: constant(f64::INFINITY),
            longest: zero,
            next: constant(1.0),
            tolerance: [constant(1.0); 2],
            turns: of_contacts.clone(),
            slow: zero,
            slow_since: of_contacts,
            taken: zero,
            most: constant(f64::INFINITY),
            most_per_time: zero,
            perturbation: states.clone(),
            lanes: std::array::from_fn(|_| None),
            alive: 0,
            sliding: 0,
            reporting_lanes: 0,
            watched: 0,
            watched_square: zero,
            ended: 0,
            reset: 0,
            before: states.clone(),
            perturbation_before: states.clone(),
            time_before: zero,
            end: states,
            length: zero,
            kernel,
        }
    }

    /// Starts a phase in a lane.
    pub(super) fn enter(&mut self, lane: usize, state: &[f64]) {
        let Some(run) = &mut self.lanes[lane] else { return };
        if run.has_gaps {
            let gaps = run.system.touching().map_or(&[][..], |touching| touching.gaps());
            run.held = held_clusters(gaps, &run.phases);
        }
        self.kernel.set_lane(&mut self.state, lane, state);
        self.kernel.set_phases(&mut self.workspace, lane, run, state);
        self.kernel.set_rest(lane, run, state);
        self.gaps.set(lane, run);
    }

    /// Exchanges the phases after the switches at the end of the latest step with those during the step. `to_during` states whether
    /// those during the step come into force.
    pub(super) fn exchange_phases(&mut self, to_during: bool) {
        for lane in (0..LANES).filter(|lane| self.ended & 1 << lane != 0) {
            let Some(run) = &mut self.lanes[lane] else { continue };
            std::mem::swap(&mut run.phases, &mut run.during);
            let states = if to_during { &self.before } else { &self.state };
            let state = self.kernel.lane(states, lane);
            self.kernel.set_phases(&mut self.workspace, lane, run, &state);
        }
    }
}

/// Propagates perturbations over a step of this length. Not inlined, because it is large and called twice.
#[inline(never)]
pub(super) fn propagate<S: Vector, K: Kernel<S>>(
    simd: S,
    kernel: &K,
    workspace: &mut K::Workspace,
    perturbation: &K::LaneStates,
    length: Lanes<S>,
) -> K::LaneStates {
    vectorized!(simd, kernel.propagate(workspace, perturbation, length))
}
