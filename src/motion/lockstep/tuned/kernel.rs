//! The kernel of the balancer: the equations of all lanes, and their series in a step.

use std::sync::Arc;

use fearless_simd::{mask64x8, prelude::*};

use super::balancer_forces::{BalancerForces, called, turned};
use super::equations::{Equations, while_apart};
use super::event_functions::{ConditionCoefficients, LanesToExamine};
use super::gap_forces::GapForceEquations;
use super::recurrence::RECIPROCALS;
use super::rest_ahead::RestAhead;
use super::series::{BalancerSeries, HigherPowers};
use super::terms::BalancerLaneStates;
use super::{event_location, perturbation};
use crate::model::{Balancer, Components, State, System};
use crate::motion::condition::Condition;
use crate::motion::joint_decision::{ForceModel, RecordedForces};
use crate::motion::lockstep::kernel::{Kernel, STILL, StepEnd};
use crate::motion::lockstep::lane::Lane;
use crate::motion::lockstep::step_length::{longest_step, reciprocal};
use crate::motion::lockstep::vector::{Fused, Powers, Vector};
use crate::motion::lockstep::{LANES, Lanes, ORDER};
use crate::motion::{Evaluator, Phase, any_closed};

/// The balancer's equations in all lanes.
pub(in crate::motion::lockstep) struct TunedKernel<S: Vector, const N: usize> {
    pub(super) equations: Equations<S, N>,
    watched: [ConditionCoefficients<S>; N],
    rest: RestAhead<S>,
    balancers: [Option<Balancer<N>>; LANES],
    /// The phases of the balls that the equations have.
    phases: [[Option<Phase>; N]; LANES],
    gaps: GapForceEquations<S, N>,
    /// The recorded equations of systems with gaps, for the decisions that need them.
    evaluators: [Option<Evaluator>; LANES],
    /// The latest of them, for the next one.
    latest: Option<Evaluator>,
}

/// Work space of a step, with the results of the latest step.
pub(in crate::motion::lockstep) struct BalancerWorkspace<S: Vector, const N: usize> {
    pub(super) series: BalancerSeries<S, N>,
    pub(super) perturbed: BalancerSeries<S, N>,
    lanes_to_examine: LanesToExamine<S, N>,
}

impl<S: Vector, const N: usize> TunedKernel<S, N> {
    /// Empty lanes.
    pub(in crate::motion::lockstep) fn new(simd: S) -> Self {
        TunedKernel {
            equations: Equations::blank(simd),
            watched: [ConditionCoefficients::nothing(simd); N],
            rest: RestAhead::none(simd),
            balancers: [None; LANES],
            phases: [[None; N]; LANES],
            gaps: GapForceEquations::none(simd),
            evaluators: std::array::from_fn(|_| None),
            latest: None,
        }
    }

    /// Returns whether a system is a balancer with this number of balls whose friction is independent of speed or
    /// proportional to it. Of balls that may touch, all can stick or none can.
    pub(in crate::motion::lockstep) fn computes(system: &Arc<dyn System>) -> bool {
        let balancer = while_apart::<N>(system);
        balancer.is_some_and(|balancer| {
            let sticking = balancer.balls.iter().filter(|ball| ball.friction.can_stick()).count();
            balancer.balls.iter().all(|ball| ball.friction.is_linear())
                && (system.touching().is_none() || sticking == 0 || sticking == N)
        })
    }
}

impl<S: Vector, const N: usize> Kernel<S> for TunedKernel<S, N> {
    type LaneStates = BalancerLaneStates<S, N>;
    type Workspace = BalancerWorkspace<S, N>;

    const IS_TUNED: bool = true;

    fn fits(&self, system: &Arc<dyn System>) -> bool {
        Self::computes(system)
    }

    #[inline(always)]
    fn contacts(&self) -> usize {
        N
    }

    #[inline(always)]
    fn is_angular(&self, _contact: usize) -> bool {
        true
    }

    fn lane_states(&self, simd: S) -> Self::LaneStates {
        BalancerLaneStates::zero(simd)
    }

    fn workspace(&self, simd: S) -> Self::Workspace {
        BalancerWorkspace {
            series: BalancerSeries::zero(simd),
            perturbed: BalancerSeries::zero(simd),
            lanes_to_examine: LanesToExamine::none(simd),
        }
    }

    fn set_system(&mut self, lane: usize, run: &Lane) {
        let Some(balancer) = while_apart(&run.system) else { return };
        let balancer: Balancer<N> = *balancer;
        self.equations.set_machine(lane, &balancer);
        for (watched, ball) in self.watched.iter_mut().zip(&balancer.balls) {
            watched.limit[lane] = ball.friction.limit;
        }
        self.balancers[lane] = Some(balancer);
        self.phases[lane] = [None; N];
        self.gaps.clear(lane);
        if run.system.touching().is_some() {
            let new = || Evaluator::new(Arc::clone(&run.system));
            let evaluator = self.latest.as_ref().map_or_else(new, |latest| latest.of(&run.system));
            self.latest = Some(evaluator.clone());
            self.evaluators[lane] = Some(evaluator);
        } else {
            self.evaluators[lane] = None;
        }
    }

    fn set_phases(&mut self, _room: &mut Self::Workspace, lane: usize, run: &Lane, _state: &[f64]) {
        let Some(balancer) = &self.balancers[lane] else { return };
        let margins = (&run.margins, 0.5 * run.width);
        for (place, phase) in run.phases[..N].iter().enumerate() {
            // Few balls change their phase at once.
            if self.phases[lane][place].replace(*phase) == Some(*phase) {
                continue;
            }
            self.equations.set_phase(lane, balancer, (place, *phase));
            self.watched[place].set(lane, *phase, margins);
        }
        if let Some(touching) = run.system.touching() {
            self.gaps.set(lane, run, touching.gaps(), &self.equations);
        }
    }

    fn set_rest(&mut self, lane: usize, run: &Lane, state: &[f64]) {
        self.rest.clear(lane);
        if let Some(balancer) = &self.balancers[lane] {
            self.rest.set(lane, balancer, (&run.phases, state));
        }
    }

    fn clear(&mut self, lane: usize) {
        self.rest.clear(lane);
        self.balancers[lane] = None;
        self.gaps.clear(lane);
        self.evaluators[lane] = None;
    }

    fn lane(&self, states: &Self::LaneStates, lane: usize) -> Components {
        states.lane(lane).components()
    }

    fn lane_component(&self, states: &Self::LaneStates, lane: usize, component: usize) -> f64 {
        match component {
            0..4 => states.table[component][lane],
            _ if component < 4 + N => states.angle[component - 4][lane],
            _ => states.speed[component - 4 - N][lane],
        }
    }

    fn set_lane(&self, states: &mut Self::LaneStates, lane: usize, components: &[f64]) {
        let all = states.table.iter_mut().chain(&mut states.angle).chain(&mut states.speed);
        all.zip(components).for_each(|(of_all, value)| of_all[lane] = *value);
    }

    #[inline(always)]
    fn select(&self, into: &mut Self::LaneStates, from: &Self::LaneStates, mask: mask64x8<S>) {
        for i in 0..4 {
            into.table[i] = mask.select(from.table[i], into.table[i]);
        }
        for i in 0..N {
            into.angle[i] = mask.select(from.angle[i], into.angle[i]);
            into.speed[i] = mask.select(from.speed[i], into.speed[i]);
        }
    }

    #[inline(always)]
    fn finite(&self, states: &Self::LaneStates, start: Lanes<S>) -> Lanes<S> {
        let zero = Lanes::splat(start.simd, 0.0);
        let mut nought = start;
        for value in states.table.iter().chain(&states.angle).chain(&states.speed) {
            nought = value.fused(zero, nought);
        }
        nought
    }

    #[inline(always)]
    fn square(&self, states: &Self::LaneStates) -> Lanes<S> {
        let mut size = Lanes::splat(states.table[0].simd, 0.0);
        for value in states.table {
            size = value.fused(value, size);
        }
        for i in 0..N {
            size = states.angle[i].fused(states.angle[i], size);
            size = states.speed[i].fused(states.speed[i], size);
        }
        size
    }

    #[inline(always)]
    fn position(&self, states: &Self::LaneStates, contact: usize) -> Lanes<S> {
        states.angle[contact]
    }

    #[inline(always)]
    fn set_position(&self, states: &mut Self::LaneStates, contact: usize, position: Lanes<S>) {
        states.angle[contact] = position;
    }

    #[inline(always)]
    fn speed(&self, states: &Self::LaneStates, contact: usize) -> Lanes<S> {
        states.speed[contact]
    }

    #[inline(always)]
    fn expand(&self, workspace: &mut Self::Workspace, start: &Self::LaneStates, _perturbed: bool) {
        workspace.series.expand(&self.equations, &self.gaps, start);
    }

    #[inline(always)]
    fn within_tolerance(
        &self,
        workspace: &Self::Workspace,
        [relative, absolute]: [Lanes<S>; 2],
        before: Lanes<S>,
    ) -> Lanes<S> {
        let simd = before.simd;
        let terms = &workspace.series.terms;
        let highest = Lanes::splat(simd, (ORDER + 1) as f64);
        let second = Lanes::splat(simd, ORDER as f64);
        let mut last = Lanes::splat(simd, 0.0);
        let mut last_but_one = last;
        // The larger of the table's two velocities counts.
        let table = |k: usize| terms[k].table[0].abs().max(terms[k].table[1].abs());
        for i in 0..=N {
            let (size, ultimate, penultimate) = if i == N {
                (table(1), highest * table(ORDER + 1), second * table(ORDER))
            } else {
                let speed = |k: usize| terms[k].balls[i].speed.abs();
                (speed(0), speed(ORDER), speed(ORDER - 1))
            };
            let scale = reciprocal(relative.fused(size, absolute));
            last = last.max(ultimate * scale);
            last_but_one = last_but_one.max(penultimate * scale);
        }
        longest_step([last, last_but_one], before)
    }

    #[inline(always)]
    fn screen_conditions(&self, workspace: &mut Self::Workspace, length: Lanes<S>) -> u64 {
        let BalancerWorkspace { series, lanes_to_examine, .. } = workspace;
        let watched = (&self.watched, &self.gaps);
        lanes_to_examine.screen_conditions(series, &self.equations, watched, length);
        lanes_to_examine.any()
    }

    fn first_event(
        &self,
        workspace: &Self::Workspace,
        run: &Lane,
        lane: usize,
        length: f64,
        ignored: &[Condition],
    ) -> StepEnd {
        let Some(balancer) = &self.balancers[lane] else { return StepEnd::Nothing };
        let BalancerWorkspace { series, lanes_to_examine, .. } = workspace;
        let of_run = (run, balancer, &self.gaps);
        event_location::first_event(series, of_run, (lane, length), lanes_to_examine, ignored)
    }

    #[inline(always)]
    fn at(
        &self,
        workspace: &Self::Workspace,
        start: &Self::LaneStates,
        time: Lanes<S>,
        into: &mut Self::LaneStates,
    ) {
        let higher = HigherPowers::none(time.simd);
        *into = workspace.series.at(&self.equations, start, time, ORDER, higher);
    }

    #[inline(always)]
    fn propagate(
        &self,
        workspace: &mut Self::Workspace,
        perturbation: &Self::LaneStates,
        length: Lanes<S>,
    ) -> Self::LaneStates {
        let BalancerWorkspace { series, perturbed, .. } = workspace;
        perturbation::propagate(series, &self.equations, perturbation, length, perturbed)
    }

    #[inline(always)]
    fn rest(&self, state: &Self::LaneStates) -> u64 {
        self.rest.is_near(self.equations.speed, &state.table)
    }

    #[inline(always)]
    fn still(&self, workspace: &Self::Workspace, sliding: u64) -> u64 {
        if sliding == 0 {
            return 0;
        }
        let [first, second, third, ..] = &workspace.series.terms;
        let simd = self.equations.speed.simd;
        let two = Lanes::splat(simd, 2.0);
        let mut most = Lanes::splat(simd, 0.0);
        for axis in 0..2 {
            most = most.max(second.table[axis].abs()).max((two * third.table[axis]).abs());
        }
        for i in 0..N {
            most = most.max(first.balls[i].speed.abs()).max(second.balls[i].speed.abs());
        }
        most.simd_le(Lanes::splat(simd, STILL)).to_bitmask() & sliding
    }

    fn component(
        &self,
        workspace: &Self::Workspace,
        lane: usize,
        component: usize,
        start: f64,
    ) -> Powers {
        workspace.series.component(lane, component, start)
    }

    fn coordinates(&self, contact: usize) -> (usize, Option<usize>) {
        (4 + contact, Some(4 + N + contact))
    }

    fn vibration(&self) -> Option<[usize; 2]> {
        Some([0, 1])
    }

    #[inline(always)]
    fn vibration_of(&self, states: &Self::LaneStates) -> [Lanes<S>; 2] {
        [states.table[0], states.table[1]]
    }

    #[inline(always)]
    fn vibration_at(
        &self,
        workspace: &Self::Workspace,
        times: [Lanes<S>; 3],
    ) -> [[Lanes<S>; 2]; 3] {
        let mut places = [[Lanes::splat(times[0].simd, 0.0); 2]; 3];
        // All three times in one loop: each sum alone would wait for its previous term.
        for term in workspace.series.terms[..=ORDER + 1].iter().rev() {
            for (place, time) in places.iter_mut().zip(times) {
                place[0] = place[0].fused(time, term.table[0]);
                place[1] = place[1].fused(time, term.table[1]);
            }
        }
        places
    }

    #[inline(always)]
    fn relative_travel(
        &self,
        workspace: &Self::Workspace,
        [behind, ahead]: [usize; 2],
        length: Lanes<S>,
    ) -> Lanes<S> {
        let mut bound = Lanes::splat(length.simd, 0.0);
        for (k, term) in workspace.series.terms[..=ORDER].iter().enumerate().rev() {
            let relative = (term.balls[behind].speed - term.balls[ahead].speed).abs();
            bound = bound.fused(length, relative * Lanes::splat(length.simd, RECIPROCALS[k + 1]));
        }
        bound * length
    }

    fn evaluator(&self, lane: usize) -> Option<&Evaluator> {
        self.evaluators[lane].as_ref()
    }

    fn with_force_model<R>(
        &self,
        lane: usize,
        run: &Lane,
        state: &[f64],
        with: impl FnOnce(&dyn ForceModel) -> R,
    ) -> R {
        if let Some(evaluator) = self.evaluator(lane).filter(|_| any_closed(&run.phases)) {
            // Not inlined a second time.
            return called(with, &RecordedForces::new(evaluator, state));
        }
        let balancer = self.balancers[lane].as_ref();
        let balancer = balancer.expect("only lanes with a run are decided");
        let state =
            State::<N>::of_components(state).expect("the components are those of the lanes");
        let turned = turned(self.equations.speed.simd, state.beta);
        let surely_one_solution = run.surely_one_solution;
        with(&BalancerForces { balancer, state, turned, surely_one_solution })
    }
}
