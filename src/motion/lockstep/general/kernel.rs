//! The kernel of any recorded system: the equations of all lanes, and their series in a step.

use std::cell::RefCell;
use std::sync::Arc;

use fearless_simd::{mask64x8, prelude::*};
use smallvec::smallvec;

use super::compiled::{Compiled, compiled};
use super::conditions;
use super::exponents;
use super::operations::{ContactCell, GapCell, SIDE_BY_SIDE, Slot};
use super::program_forces::{DecisionMemory, ProgramForces};
use super::series::{ConditionBound, Programs};
use super::workspace::{RecordedLaneStates, RecordedWorkspace, SeriesView};
use crate::model::{Components, Graph, System};
use crate::motion::all_stick;
use crate::motion::condition::Condition;
use crate::motion::evaluator::Evaluator;
use crate::motion::joint_decision::ForceModel;
use crate::motion::lockstep::gap_conditions::Pressure;
use crate::motion::lockstep::kernel::{Kernel, STILL, StepEnd};
use crate::motion::lockstep::lane::Lane;
use crate::motion::lockstep::step_length::{longest_step, reciprocal};
use crate::motion::lockstep::vector::{Fused, Powers, Vector};
use crate::motion::lockstep::{LANES, Lanes, ORDER, TERMS};

/// The equations of a recorded system in all lanes.
pub(in crate::motion::lockstep) struct GeneralKernel<S: Vector> {
    simd: S,
    graph: Arc<Graph>,
    program: Arc<Compiled>,
    /// The component that is the sliding speed of each contact, if it is one.
    speeds: Vec<Option<usize>>,
    /// The condition of each closed gap.
    pressures: Vec<Pressure<S>>,
    evaluators: [Option<Evaluator>; LANES],
    /// Bit mask of lanes in which all contacts stick.
    stuck: u64,
    /// For each lane, what its parameters determine ([`Compiled::parameters`]).
    parameters: [Vec<f64>; LANES],
    /// Bit mask of lanes whose parameters are not yet in the workspace.
    is_new: u64,
    scratch: [RefCell<DecisionMemory>; LANES],
}

impl<S: Vector> GeneralKernel<S> {
    /// Empty lanes for systems with these equations.
    pub(in crate::motion::lockstep) fn new(simd: S, system: &Arc<dyn System>) -> Self {
        let graph = Graph::of(system.as_ref());
        let program = compiled(system.as_ref(), &graph);
        let contacts = graph.contacts.len();
        GeneralKernel {
            simd,
            speeds: (0..contacts).map(|contact| graph.speed_component(contact)).collect(),
            pressures: vec![Pressure::none(simd); graph.gaps.len()],
            evaluators: std::array::from_fn(|_| None),
            stuck: 0,
            parameters: std::array::from_fn(|_| Vec::new()),
            is_new: 0,
            scratch: Default::default(),
            graph,
            program,
        }
    }

    /// Returns the value of a series a time after the start of its step.
    #[inline(always)]
    fn sum(&self, series: SeriesView<'_, S>, slot: Slot, time: Lanes<S>) -> Lanes<S> {
        let mut sum = Lanes::splat(self.simd, 0.0);
        let terms = series.of(slot);
        for k in (0..TERMS).rev() {
            sum = sum.fused(time, terms[k]);
        }
        sum
    }

    #[inline(always)]
    fn flow_at(&self, series: SeriesView<'_, S>, time: Lanes<S>, into: &mut RecordedLaneStates<S>) {
        // Loops, not closures: the fused multiply-add must be inlined. Several sums do not wait for each other.
        let components = into.components.len();
        for first in (0..components).step_by(SIDE_BY_SIDE) {
            let mut sums = [Lanes::splat(self.simd, 0.0); SIDE_BY_SIDE];
            for k in (0..TERMS).rev() {
                let terms = &series.order(k)[first..first + SIDE_BY_SIDE];
                for i in 0..SIDE_BY_SIDE {
                    sums[i] = sums[i].fused(time, terms[i]);
                }
            }
            let count = SIDE_BY_SIDE.min(components - first);
            into.components[first..first + count].copy_from_slice(&sums[..count]);
        }
        for first in (0..into.speeds.len()).step_by(SIDE_BY_SIDE) {
            let contacts = &self.program.operations.contacts[first..into.speeds.len()];
            let mut sums = [Lanes::splat(self.simd, 0.0); SIDE_BY_SIDE];
            for k in (0..TERMS).rev() {
                let terms = series.order(k);
                for (sum, contact) in sums.iter_mut().zip(contacts) {
                    *sum = sum.fused(time, terms[contact[0] as usize]);
                }
            }
            let count = SIDE_BY_SIDE.min(contacts.len());
            into.speeds[first..first + count].copy_from_slice(&sums[..count]);
        }
    }
}

impl<S: Vector> Kernel<S> for GeneralKernel<S> {
    type LaneStates = RecordedLaneStates<S>;
    type Workspace = RecordedWorkspace<S>;

    const IS_TUNED: bool = false;

    fn fits(&self, system: &Arc<dyn System>) -> bool {
        let graph = Graph::of(system.as_ref());
        Arc::ptr_eq(&graph, &self.graph) || graph == self.graph
    }

    fn contacts(&self) -> usize {
        self.speeds.len()
    }

    fn is_angular(&self, contact: usize) -> bool {
        self.graph.layout.contacts[contact].angular
    }

    fn lane_states(&self, simd: S) -> Self::LaneStates {
        let zero = Lanes::splat(simd, 0.0);
        let direct = self.speeds.iter().all(Option::is_some);
        RecordedLaneStates {
            components: smallvec![zero; self.graph.derivative.len()],
            speeds: smallvec![zero; if direct { 0 } else { self.speeds.len() }],
        }
    }

    fn workspace(&self, simd: S) -> Self::Workspace {
        let Compiled { operations, programs, .. } = &*self.program;
        let Programs { motion, perturbation, tail, .. } = programs;
        let programs = [motion, perturbation, tail].map(|runner| &runner.program);
        RecordedWorkspace::new(simd, operations, programs)
    }

    fn set_system(&mut self, lane: usize, run: &Lane) {
        let graph = Arc::clone(&self.graph);
        let evaluator = Evaluator::of_graph(Arc::clone(&run.system), graph);
        let inputs = evaluator.inputs(&run.phases);
        self.evaluators[lane] = Some(evaluator);
        let Compiled { operations, parameters, programs, .. } = &*self.program;
        let scratch = self.scratch[lane].get_mut();
        scratch.begin(&programs.fixed.program);
        let memory = &mut scratch.memory;
        for (cell, input) in &operations.inputs[1] {
            memory[*cell as usize] = inputs[*input as usize];
        }
        programs.fixed.run(self.simd, memory);
        self.parameters[lane] = parameters.iter().map(|cell| memory[*cell as usize]).collect();
        self.is_new |= 1 << lane;
    }

    fn set_phases(
        &mut self,
        workspace: &mut Self::Workspace,
        lane: usize,
        run: &Lane,
        state: &[f64],
    ) {
        let Compiled { operations, parameters, .. } = &*self.program;
        if self.is_new & 1 << lane != 0 {
            self.is_new &= !(1 << lane);
            for (cell, value) in parameters.iter().zip(&self.parameters[lane]) {
                workspace.set_constant(*cell, lane, *value);
            }
        }
        let scratch = self.scratch[lane].get_mut();
        scratch.set_inputs(operations, run.system.as_ref(), &run.phases);
        for (cell, _) in &operations.inputs[0] {
            workspace.set_constant(*cell, lane, scratch.memory[*cell as usize]);
        }
        for (cell, component) in &operations.discrete {
            workspace.set_constant(*cell, lane, state[*component as usize]);
        }
        let margins = (&run.margins, 0.5 * run.width);
        for contact in 0..self.speeds.len() {
            let numbers = conditions::of_contact(run.phases[contact], run.limits[contact], margins);
            let first = operations.of_contact(contact, ContactCell::Sign);
            for (cell, number) in (first..).zip(numbers) {
                workspace.set(cell, lane, number);
            }
        }
        let Some(touching) = run.system.touching() else { return };
        let gaps = touching.gaps().iter().zip(&run.phases[self.speeds.len()..]);
        for (place, (pressure, (gap, phase))) in self.pressures.iter_mut().zip(gaps).enumerate() {
            pressure.set(lane, run, (gap, *phase));
            workspace.set(operations.of_gap(place, GapCell::Weight), lane, pressure.weight[lane]);
            workspace.set(operations.of_gap(place, GapCell::Offset), lane, pressure.offset[lane]);
        }
    }

    fn set_rest(&mut self, lane: usize, run: &Lane, _state: &[f64]) {
        let bit = 1 << lane;
        // A system without contacts moves until its motion has decayed.
        let sticks = self.contacts() > 0 && all_stick(&run.phases);
        self.stuck = self.stuck & !bit | if sticks { bit } else { 0 };
    }

    fn clear(&mut self, lane: usize) {
        self.evaluators[lane] = None;
        for pressure in &mut self.pressures {
            pressure.clear(lane);
        }
        self.stuck &= !(1 << lane);
    }

    fn lane(&self, states: &Self::LaneStates, lane: usize) -> Components {
        let mut components = Components::from_elem(0.0, states.components.len());
        for (component, of_all) in components.iter_mut().zip(&states.components) {
            *component = of_all[lane];
        }
        components
    }

    fn lane_component(&self, states: &Self::LaneStates, lane: usize, component: usize) -> f64 {
        states.components[component][lane]
    }

    fn set_lane(&self, states: &mut Self::LaneStates, lane: usize, components: &[f64]) {
        for (of_all, value) in states.components.iter_mut().zip(components) {
            of_all[lane] = *value;
        }
        let evaluated = self.evaluators[lane].as_ref().filter(|_| !states.speeds.is_empty());
        if let Some(speeds) = evaluated.map(|evaluator| evaluator.speeds(components)) {
            for (of_all, speed) in states.speeds.iter_mut().zip(speeds) {
                of_all[lane] = speed;
            }
        }
    }

    #[inline(always)]
    fn select(&self, into: &mut Self::LaneStates, from: &Self::LaneStates, mask: mask64x8<S>) {
        let all = into.components.iter_mut().chain(&mut into.speeds);
        for (into, from) in all.zip(from.components.iter().chain(&from.speeds)) {
            *into = mask.select(*from, *into);
        }
    }

    #[inline(always)]
    fn finite(&self, states: &Self::LaneStates, start: Lanes<S>) -> Lanes<S> {
        let zero = Lanes::splat(self.simd, 0.0);
        let mut nought = start;
        for value in &states.components {
            nought = value.fused(zero, nought);
        }
        nought
    }

    #[inline(always)]
    fn square(&self, states: &Self::LaneStates) -> Lanes<S> {
        let mut sum = Lanes::splat(self.simd, 0.0);
        for value in &states.components {
            sum = value.fused(*value, sum);
        }
        sum
    }

    #[inline(always)]
    fn position(&self, states: &Self::LaneStates, contact: usize) -> Lanes<S> {
        states.components[self.graph.layout.contacts[contact].position]
    }

    #[inline(always)]
    fn set_position(&self, states: &mut Self::LaneStates, contact: usize, position: Lanes<S>) {
        states.components[self.graph.layout.contacts[contact].position] = position;
    }

    #[inline(always)]
    fn speed(&self, states: &Self::LaneStates, contact: usize) -> Lanes<S> {
        match self.speeds[contact] {
            Some(component) => states.components[component],
            None => states.speeds[contact],
        }
    }

    #[inline(always)]
    fn expand(&self, workspace: &mut Self::Workspace, start: &Self::LaneStates, perturbed: bool) {
        let Programs { modes, motion, perturbed_motion, .. } = &self.program.programs;
        workspace.start(&start.components, false);
        if std::mem::take(&mut workspace.is_changed) {
            modes.run(self.simd, &mut workspace.memory);
        }
        let motion = if perturbed { perturbed_motion } else { motion };
        motion.run(self.simd, &mut workspace.memory);
    }

    #[inline(always)]
    fn within_tolerance(
        &self,
        workspace: &Self::Workspace,
        [relative, absolute]: [Lanes<S>; 2],
        before: Lanes<S>,
    ) -> Lanes<S> {
        let zero = Lanes::splat(self.simd, 0.0);
        let (mut last, mut last_but_one) = (zero, zero);
        for group in &self.program.tolerated {
            let [mut size, mut ultimate, mut penultimate] = [zero; 3];
            for &slot in group {
                let terms = workspace.series().of(slot);
                size = size.max(terms[0].abs());
                ultimate = ultimate.max(terms[ORDER].abs());
                penultimate = penultimate.max(terms[ORDER - 1].abs());
            }
            let scale = reciprocal(relative.fused(size, absolute));
            last = last.max(ultimate * scale);
            last_but_one = last_but_one.max(penultimate * scale);
        }
        longest_step([last, last_but_one], before)
    }

    #[inline(always)]
    fn resolved(&self, workspace: &Self::Workspace, length: Lanes<S>) -> Lanes<S> {
        let mut resolved = length;
        for &exponent in &self.program.exponents {
            resolved = exponents::resolved(workspace.series().of(exponent), resolved);
        }
        resolved
    }

    #[inline(always)]
    fn screen_conditions(&self, workspace: &mut Self::Workspace, length: Lanes<S>) -> u64 {
        let Programs { screen: (program, screen), normals, exact_screen, .. } =
            &self.program.programs;
        workspace.memory[self.program.operations.length() as usize] = length;
        if screen.needs_normals {
            normals.run(self.simd, &mut workspace.memory);
        }
        program.run(self.simd, &mut workspace.memory);
        workspace.is_exact = false;
        let any = workspace.screened(screen);
        let Some((program, exact)) = exact_screen else { return any };
        if any != 0 && workspace.below_zero(screen.forces.iter().copied()) != 0 {
            // Lanes in doubt are examined with the series of the normal forces.
            normals.run(self.simd, &mut workspace.memory);
            let closed = screen.contacts.iter().map(|cells| cells[ConditionBound::Closed as usize]);
            if workspace.below_zero(closed) != 0 {
                program.run(self.simd, &mut workspace.memory);
                workspace.is_exact = true;
                return workspace.screened(exact);
            }
        }
        any
    }

    fn first_event(
        &self,
        workspace: &Self::Workspace,
        run: &Lane,
        lane: usize,
        length: f64,
        ignored: &[Condition],
    ) -> StepEnd {
        let in_lane = (run, lane, length);
        let pressures = &self.pressures;
        conditions::first_event(self.simd, workspace, &self.program, in_lane, pressures, ignored)
    }

    #[inline(always)]
    fn at(
        &self,
        workspace: &Self::Workspace,
        _start: &Self::LaneStates,
        time: Lanes<S>,
        into: &mut Self::LaneStates,
    ) {
        self.flow_at(workspace.series(), time, into);
    }

    #[inline(always)]
    fn propagate(
        &self,
        workspace: &mut Self::Workspace,
        perturbation: &Self::LaneStates,
        length: Lanes<S>,
    ) -> Self::LaneStates {
        workspace.start(&perturbation.components, true);
        workspace.memory[self.program.operations.length() as usize] = length;
        self.program.programs.perturbation.run(self.simd, &mut workspace.memory);
        self.program.programs.tail.run(self.simd, &mut workspace.memory);
        let mut moved = perturbation.clone();
        self.flow_at(workspace.changes(), length, &mut moved);
        moved
    }

    fn rest(&self, _state: &Self::LaneStates) -> u64 {
        self.stuck
    }

    #[inline(always)]
    fn still(&self, workspace: &Self::Workspace, _sliding: u64) -> u64 {
        let mut most = Lanes::splat(self.simd, 0.0);
        for &rate in &self.program.operations.settling {
            most = most.max(workspace.series().of(rate)[0].abs());
        }
        // Bodies that roll on and on come to a steady motion in which all contacts stick.
        let counts = if self.graph.has_translations() { u64::MAX } else { !self.stuck };
        most.simd_le(Lanes::splat(self.simd, STILL)).to_bitmask() & counts
    }

    fn component(
        &self,
        workspace: &Self::Workspace,
        lane: usize,
        component: usize,
        _start: f64,
    ) -> Powers {
        let mut powers = [0.0; TERMS];
        let terms = workspace.series().of(component as Slot);
        for (k, power) in powers.iter_mut().enumerate() {
            *power = terms[k][lane];
        }
        powers
    }

    fn coordinates(&self, contact: usize) -> (usize, Option<usize>) {
        (self.graph.layout.contacts[contact].position, self.speeds[contact])
    }

    fn shifted(&self, contact: usize) -> Option<usize> {
        self.graph.shifted_component(contact)
    }

    fn vibration(&self) -> Option<[usize; 2]> {
        self.graph.layout.vibration
    }

    #[inline(always)]
    fn vibration_of(&self, states: &Self::LaneStates) -> [Lanes<S>; 2] {
        let zero = [Lanes::splat(self.simd, 0.0); 2];
        self.graph.layout.vibration.map_or(zero, |places| places.map(|i| states.components[i]))
    }

    #[inline(always)]
    fn vibration_at(
        &self,
        workspace: &Self::Workspace,
        times: [Lanes<S>; 3],
    ) -> [[Lanes<S>; 2]; 3] {
        let zero = [Lanes::splat(self.simd, 0.0); 2];
        times.map(|time| {
            let places = self.graph.layout.vibration;
            places.map_or(zero, |all| all.map(|i| self.sum(workspace.series(), i as Slot, time)))
        })
    }

    #[inline(always)]
    fn relative_travel(
        &self,
        workspace: &Self::Workspace,
        pair: [usize; 2],
        length: Lanes<S>,
    ) -> Lanes<S> {
        let [behind, ahead] = pair.map(|contact| {
            let position = self.graph.layout.contacts[contact].position;
            workspace.series().of(position as Slot)
        });
        let mut bound = Lanes::splat(length.simd, 0.0);
        for k in (1..TERMS).rev() {
            bound = bound.fused(length, (behind[k] - ahead[k]).abs());
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
        let evaluator = self.evaluator(lane).expect("only lanes with a run are decided");
        let scratch = &mut *self.scratch[lane].borrow_mut();
        with(&ProgramForces::new((self.simd, &self.program), (run, evaluator), state, scratch))
    }
}
