//! What a kernel computes for the equations of its systems in all lanes.

use std::sync::Arc;

use fearless_simd::mask64x8;

use super::Lanes;
use super::lane::Lane;
use super::root_isolation::{Bounds, ConditionFate, Polynomial};
use super::vector::Powers;
use crate::model::{Components, System};
use crate::motion::Evaluator;
use crate::motion::condition::Condition;
use crate::motion::joint_decision::ForceModel;
use crate::motion::lockstep::vector::{Vector, vectorized};

/// Bound on every component of the rate of change if everything is slow.
pub(super) const STILL: f64 = 1e-6;

/// Ratio of the longest step to a system's own limit: 5 over the highest frequency, that of the balancer's table in the
/// turning frame, `1 + |ω|`. The tolerance would allow longer steps, because errors become visible in the next step, but
/// perturbations are not subject to the tolerance, and the terms of their series are accurate up to this length.
pub(super) const LONGEST: f64 = 5.0 / std::f64::consts::FRAC_PI_2;

/// The equations of motion of one kind of system, expanded into power series in all lanes.
pub(super) trait Kernel<S: Vector>: Sized {
    /// The components of a state of each lane.
    type LaneStates: Clone;
    /// The series of a step, of the motion and of a perturbation.
    type Workspace;
    /// Whether it is written for systems of one type.
    const IS_TUNED: bool;

    /// Returns whether it computes a system.
    fn fits(&self, system: &Arc<dyn System>) -> bool;
    /// Returns the number of contacts.
    fn contacts(&self) -> usize;
    /// Returns whether the position of a contact is an angle.
    fn is_angular(&self, contact: usize) -> bool;
    /// Returns the components of a state, zero in all lanes.
    fn lane_states(&self, simd: S) -> Self::LaneStates;
    /// Returns the work space of a step.
    fn workspace(&self, simd: S) -> Self::Workspace;

    /// Sets the parameters of a lane, without those that depend on phases.
    fn set_system(&mut self, lane: usize, run: &Lane);
    /// Sets the parameters of a lane that depend on its phases and on what only events change.
    fn set_phases(
        &mut self,
        workspace: &mut Self::Workspace,
        lane: usize,
        run: &Lane,
        state: &[f64],
    );
    /// Prepares the detection of rest from a state in which a lane begins a phase.
    fn set_rest(&mut self, lane: usize, run: &Lane, state: &[f64]);
    /// Forgets a lane.
    fn clear(&mut self, lane: usize);

    /// Returns the components of one lane.
    fn lane(&self, states: &Self::LaneStates, lane: usize) -> Components;
    /// Returns a component of one lane.
    fn lane_component(&self, states: &Self::LaneStates, lane: usize, component: usize) -> f64;
    /// Sets the components of one lane.
    fn set_lane(&self, states: &mut Self::LaneStates, lane: usize, components: &[f64]);
    /// Replaces the components in the lanes of a mask.
    fn select(&self, into: &mut Self::LaneStates, from: &Self::LaneStates, mask: mask64x8<S>);
    /// Returns zero in the lanes in which all components are finite.
    fn finite(&self, states: &Self::LaneStates, start: Lanes<S>) -> Lanes<S>;
    /// Returns the sum of the squares of all components.
    fn square(&self, states: &Self::LaneStates) -> Lanes<S>;
    /// Returns the position of a contact.
    fn position(&self, states: &Self::LaneStates, contact: usize) -> Lanes<S>;
    /// Replaces the position of a contact.
    fn set_position(&self, states: &mut Self::LaneStates, contact: usize, position: Lanes<S>);
    /// Returns the sliding speed of a contact.
    fn speed(&self, states: &Self::LaneStates, contact: usize) -> Lanes<S>;

    /// Expands the motion from a state. If `perturbed`, perturbations of this motion can be propagated afterwards.
    fn expand(&self, workspace: &mut Self::Workspace, start: &Self::LaneStates, perturbed: bool);
    /// Returns the longest step within the tolerance; `before` is that of the previous step.
    fn within_tolerance(
        &self,
        workspace: &Self::Workspace,
        tolerance: [Lanes<S>; 2],
        before: Lanes<S>,
    ) -> Lanes<S>;
    /// Returns a step of at most this length in which nothing grows from far below the rounding of the series.
    #[inline(always)]
    fn resolved(&self, _workspace: &Self::Workspace, length: Lanes<S>) -> Lanes<S> {
        length
    }
    /// Returns the lanes in which a condition may fail in a step of this length.
    fn screen_conditions(&self, workspace: &mut Self::Workspace, length: Lanes<S>) -> u64;
    /// Returns the end of a step of one lane; a condition that `ignored` names is not examined.
    fn first_event(
        &self,
        workspace: &Self::Workspace,
        run: &Lane,
        lane: usize,
        length: f64,
        ignored: &[Condition],
    ) -> StepEnd;
    /// Writes the state a time later to `into`.
    fn at(
        &self,
        workspace: &Self::Workspace,
        start: &Self::LaneStates,
        time: Lanes<S>,
        into: &mut Self::LaneStates,
    );
    /// Propagates perturbations over a step of this length.
    fn propagate(
        &self,
        workspace: &mut Self::Workspace,
        perturbation: &Self::LaneStates,
        length: Lanes<S>,
    ) -> Self::LaneStates;
    /// Returns the lanes that may rest for good.
    fn rest(&self, state: &Self::LaneStates) -> u64;
    /// Returns the lanes in which everything is slow at the start of the step; `sliding` are those with a contact that cannot
    /// stick.
    fn still(&self, workspace: &Self::Workspace, sliding: u64) -> u64;

    /// Returns the coefficients of a component in one lane, from order zero, as the series of the state in time. Missing
    /// coefficients are 0.
    fn component(
        &self,
        workspace: &Self::Workspace,
        lane: usize,
        component: usize,
        start: f64,
    ) -> Powers;
    /// Returns the components that are the position of a contact and, if it is one, its sliding speed.
    fn coordinates(&self, contact: usize) -> (usize, Option<usize>);
    /// Returns the component that determines the sliding speed of a contact, as [`crate::model::Graph::shifted_component`] does.
    fn shifted(&self, _contact: usize) -> Option<usize> {
        None
    }
    /// Returns the components whose displacement is measured.
    fn vibration(&self) -> Option<[usize; 2]>;
    /// Returns the measured displacement of a state; zero without one.
    fn vibration_of(&self, states: &Self::LaneStates) -> [Lanes<S>; 2];
    /// Returns the measured displacement at three times after the start of the step; zero without one.
    fn vibration_at(&self, workspace: &Self::Workspace, times: [Lanes<S>; 3])
    -> [[Lanes<S>; 2]; 3];

    /// Returns a bound on how much the distance of two contacts changes in a step of this length.
    fn relative_travel(
        &self,
        workspace: &Self::Workspace,
        pair: [usize; 2],
        length: Lanes<S>,
    ) -> Lanes<S>;

    /// Returns the equations of the system in a lane, for events that reset its state.
    fn evaluator(&self, lane: usize) -> Option<&Evaluator>;
    /// Calls `with` with the system in one state, for deciding its modes.
    fn with_force_model<R>(
        &self,
        lane: usize,
        run: &Lane,
        state: &[f64],
        with: impl FnOnce(&dyn ForceModel) -> R,
    ) -> R;
}

/// The end of a step of a lane.
pub(super) enum StepEnd {
    /// Nothing.
    Nothing,
    /// A condition fails at this part of the step.
    At(f64, Condition),
    /// A condition fails from the start.
    AtOnce(Condition),
}

impl StepEnd {
    /// Replaces this end by the failure of another condition if that is earlier. The bounds of the condition are
    /// computed if they are not known. Not inlined, because it is large and called for several conditions.
    #[inline(never)]
    pub(super) fn or<S: Vector>(
        &mut self,
        simd: S,
        condition: &Polynomial,
        bounds: Option<&Bounds>,
        failed: Condition,
    ) {
        vectorized!(simd, self.or_in_vectors(condition, bounds, failed));
    }

    /// Does the work of [`StepEnd::or`]. Must be inlined where the processor's fused multiply-add is available.
    #[inline(always)]
    pub(super) fn or_in_vectors(
        &mut self,
        condition: &Polynomial,
        bounds: Option<&Bounds>,
        failed: Condition,
    ) {
        // A match, not a closure: it must be inlined.
        let bounds = match bounds {
            Some(bounds) => *bounds,
            None => condition.outline(),
        };
        match (condition.first_fall(&bounds), &self) {
            (ConditionFate::Holds, _) | (_, StepEnd::AtOnce(_)) => {}
            (ConditionFate::FailsAtOnce, _) => *self = StepEnd::AtOnce(failed),
            (ConditionFate::Fails(at), _) => {
                self.earlier(if failed.resets() { condition.refined(at) } else { at }, failed);
            }
        }
    }

    /// Replaces this end by the failure of a condition at a part of the step if that is earlier.
    pub(super) fn earlier(&mut self, part: f64, failed: Condition) {
        match self {
            StepEnd::AtOnce(_) => {}
            StepEnd::At(earlier, _) if *earlier <= part => {}
            _ => *self = StepEnd::At(part, failed),
        }
    }
}
