//! The recorded equations of a system in one state, for several assumptions about the phases.

use std::array::from_fn;
use std::ops::{Add, Mul, Neg, Sub};
use std::sync::Arc;

use smallvec::SmallVec;

use super::evaluator::{AffectedNodes, Forces, GapForces, Solution, forces};
use super::linear_system::{SMALL_PIVOT, Solved, Unknowns};
use super::{Evaluator, Phase, Phases, SimdLevel};
use crate::model::{Elementary, Function, NodeId, Number, Solve};

/// The number of assumptions that are computed together.
pub(super) const TOGETHER: usize = 8;

impl Evaluator {
    /// Returns the equations in one state, for several assumptions about the phases.
    pub fn incremental_forces<'a>(&'a self, state: &'a [f64]) -> IncrementalForces<'a> {
        IncrementalForces {
            evaluator: self,
            state,
            inputs: Vec::new(),
            values: Vec::new(),
            together: Vec::new(),
            affected: self.affected(),
        }
    }
}

/// The recorded equations in one state. From one assumption about the phases to the next, only the nodes that depend on
/// the inputs that vary are computed.
pub struct IncrementalForces<'a> {
    evaluator: &'a Evaluator,
    state: &'a [f64],
    inputs: Vec<f64>,
    values: Vec<f64>,
    /// The values of the nodes for several assumptions; only those of affected nodes and of their operands are known.
    together: Vec<PerAssumption>,
    affected: Arc<AffectedNodes>,
}

impl IncrementalForces<'_> {
    /// Returns forces and accelerations of all contacts, and of all gaps with the openings behind them.
    pub fn forces_and_gaps(&mut self, phases: &[Phase]) -> (Forces, SmallVec<[GapForces; 8]>) {
        self.assume(phases);
        self.read(|node| self.values[node as usize])
    }

    /// Returns forces and accelerations of all contacts, gaps and openings for each of some assumptions, to rounding. The equations
    /// determine all forces.
    pub(super) fn forces_of_several(
        &mut self,
        assumed: &[Phases],
    ) -> SmallVec<[(Forces, SmallVec<[GapForces; 8]>); TOGETHER]> {
        let Some(first) = assumed.first() else { return SmallVec::new() };
        if self.values.is_empty() {
            self.assume(first);
        }
        let inputs: SmallVec<[Vec<f64>; TOGETHER]> =
            assumed.iter().map(|phases| self.evaluator.inputs(phases)).collect();
        inputs.iter().for_each(|inputs| self.find_affected(inputs));
        let graph = self.evaluator.graph();
        if self.together.is_empty() {
            self.together.resize(graph.nodes.len(), PerAssumption::constant(0.0));
            for &node in &self.affected.others {
                self.together[node as usize] = PerAssumption::constant(self.values[node as usize]);
            }
        }
        let input = |input: usize| {
            PerAssumption(from_fn(|place| inputs[place.min(inputs.len() - 1)][input]))
        };
        SimdLevel::best().run(
            #[inline(always)]
            || {
                let mut solution = Solution::new();
                for &place in &self.affected.nodes {
                    let node = &graph.nodes[place as usize];
                    let state = |component: usize| PerAssumption::constant(self.state[component]);
                    self.together[place as usize] =
                        self.evaluator.value(node, &self.together, input, state, &mut solution);
                }
            },
        );
        let value = |place: usize, node: NodeId| match self.affected.is_affected.get(node as usize)
        {
            Some(true) => self.together[node as usize].0[place],
            _ => self.values[node as usize],
        };
        (0..assumed.len()).map(|place| self.read(|node| value(place, node))).collect()
    }

    fn read(&self, at: impl Fn(NodeId) -> f64) -> (Forces, SmallVec<[GapForces; 8]>) {
        let graph = self.evaluator.graph();
        let gap = |nodes: &[NodeId; 2]| {
            let [opening_acceleration, force] = nodes.map(&at);
            GapForces { opening_acceleration, force }
        };
        let openings = graph.openings.iter().map(|opening| [opening.acceleration, opening.force]);
        let all: SmallVec<[_; 8]> = graph.gaps.iter().copied().chain(openings).collect();
        (forces(graph, &at), all.iter().map(gap).collect())
    }

    /// Computes all nodes for these phases.
    fn assume(&mut self, phases: &[Phase]) {
        let inputs = self.evaluator.inputs(phases);
        if self.values.is_empty() {
            let state = |component: usize| self.state[component];
            self.values = self.evaluator.values_with(&inputs, true, state).into_vec();
            self.inputs = inputs;
            return;
        }
        self.find_affected(&inputs);
        let mut solution = Solution::new();
        for &place in &self.affected.nodes {
            let node = &self.evaluator.graph().nodes[place as usize];
            let state = |component: usize| self.state[component];
            self.values[place as usize] = self.evaluator.value(
                node,
                &self.values,
                |input| inputs[input],
                state,
                &mut solution,
            );
        }
        self.inputs = inputs;
    }

    /// Finds the nodes that these inputs affect, unless they are known.
    fn find_affected(&mut self, inputs: &[f64]) {
        let known = |input: usize| self.affected.varying.get(input) == Some(&true);
        let varies = |input: usize| inputs[input] != self.inputs[input];
        if (0..inputs.len()).any(|input| varies(input) && !known(input)) {
            let varying = (0..inputs.len()).map(|input| varies(input) || known(input)).collect();
            self.affected = self.evaluator.affected_by(varying);
            self.together.clear();
        }
    }
}

/// A number for each of several assumptions.
#[derive(Clone, Copy, Debug)]
struct PerAssumption([f64; TOGETHER]);

impl PerAssumption {
    #[inline(always)]
    fn each(self, of: impl Fn(f64) -> f64) -> Self {
        PerAssumption(self.0.map(of))
    }

    #[inline(always)]
    fn with(self, other: Self, of: impl Fn(f64, f64) -> f64) -> Self {
        PerAssumption(from_fn(|place| of(self.0[place], other.0[place])))
    }
}

impl Add for PerAssumption {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        self.with(other, |left, right| left + right)
    }
}

impl Sub for PerAssumption {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self.with(other, |left, right| left - right)
    }
}

impl Mul for PerAssumption {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        self.with(other, |left, right| left * right)
    }
}

impl Neg for PerAssumption {
    type Output = Self;
    fn neg(self) -> Self {
        self.each(|value| -value)
    }
}

impl Number for PerAssumption {
    fn constant(value: f64) -> Self {
        PerAssumption([value; TOGETHER])
    }

    fn sin_cos(self) -> (Self, Self) {
        (self.each(|angle| Number::sin_cos(angle).0), self.each(|angle| Number::sin_cos(angle).1))
    }

    fn reciprocal(self) -> Self {
        self.each(Number::reciprocal)
    }
}

impl Elementary for PerAssumption {
    /// Returns the number of the first assumption.
    fn value(self) -> f64 {
        self.0[0]
    }

    fn is_zero(self) -> bool {
        self.0 == [0.0; TOGETHER]
    }

    fn sqrt(self) -> Self {
        self.each(Elementary::sqrt)
    }

    fn function(self, function: Function) -> Self {
        self.each(|argument| function.of(argument))
    }
}

impl Solved for PerAssumption {
    /// Eliminates as [`super::linear_system::solve_for_each`] does; each assumption exchanges the rows with its own small pivots.
    #[inline(always)]
    fn solve(system: &Solve, at: impl Fn(NodeId) -> Self, unknowns: &mut Unknowns<Self>) {
        let size = system.right.len();
        let mut matrix: Vec<PerAssumption> = system.matrix.iter().map(|node| at(*node)).collect();
        *unknowns = system.right.iter().map(|node| at(*node)).collect();
        let right = unknowns;
        let sizes = |number: PerAssumption| number.each(f64::abs);
        let largest = |row: &[PerAssumption]| {
            row.iter().fold(PerAssumption::constant(0.0), |most, entry| {
                most.with(sizes(*entry), f64::max)
            })
        };
        let mut scales: SmallVec<[PerAssumption; 16]> =
            matrix.chunks(size.max(1)).map(largest).collect();
        for column in 0..size {
            for row in column + 1..size {
                let entry = matrix[row * size + column];
                if entry.is_zero() {
                    continue;
                }
                let pivot = sizes(matrix[column * size + column]) * scales[row];
                let least = PerAssumption::constant(SMALL_PIVOT) * sizes(entry) * scales[column];
                let is_small = from_fn(|place| pivot.0[place] < least.0[place]);
                if is_small.contains(&true) {
                    let (above, below) = matrix.split_at_mut(row * size);
                    let upper = &mut above[column * size..][..size];
                    upper
                        .iter_mut()
                        .zip(below)
                        .for_each(|(above, below)| exchange(is_small, above, below));
                    let (above, below) = right.split_at_mut(row);
                    exchange(is_small, &mut above[column], &mut below[0]);
                    let (above, below) = scales.split_at_mut(row);
                    exchange(is_small, &mut above[column], &mut below[0]);
                }
            }
            let inverse = matrix[column * size + column].reciprocal();
            for row in column + 1..size {
                let entry = matrix[row * size + column];
                if entry.is_zero() {
                    continue;
                }
                let factor = entry * inverse;
                let (above, below) = matrix.split_at_mut(row * size);
                let known = &above[column * size..][column + 1..size];
                for (value, known) in below[column + 1..size].iter_mut().zip(known) {
                    if !known.is_zero() {
                        *value = *value - factor * *known;
                    }
                }
                right[row] = right[row] - factor * right[column];
            }
        }
        for row in (0..size).rev() {
            for column in row + 1..size {
                let entry = matrix[row * size + column];
                if !entry.is_zero() {
                    right[row] = right[row] - entry * right[column];
                }
            }
            right[row] = right[row] * matrix[row * size + row].reciprocal();
        }
    }
}

/// Exchanges the numbers of the assumptions that are marked.
fn exchange(marked: [bool; TOGETHER], left: &mut PerAssumption, right: &mut PerAssumption) {
    let pairs = left.0.iter_mut().zip(&mut right.0).zip(marked);
    pairs.filter(|(_, marked)| *marked).for_each(|((left, right), _)| std::mem::swap(left, right));
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::TOGETHER;
    use crate::model::{BallContact, BallsInContact, Machine};
    use crate::motion::joint_decision::is_finite;
    use crate::motion::{Direction, Evaluator, Phase, Phases};

    /// Several assumptions together have the forces of each alone, to the last bit, whatever rows each of them exchanges.
    #[test]
    fn several_assumptions_have_the_forces_of_each() {
        let mut machine = Machine::default();
        machine.balls = vec![machine.balls[0]; 4];
        let contact = BallContact { restitution: 0.4, friction_coefficient: 0.1 };
        let beta = [0.3, 0.9, 1.5, 2.1];
        let system = BallsInContact::<4>::new(&machine, &contact, &beta).expect("four balls");
        let evaluator = Evaluator::new(Arc::new(system));
        let state = [0.1, -0.2, 0.3, 0.1, 0.3, 0.9, 1.5, 2.1, 0.0, 0.0, 0.0, 0.0];
        let [forward, backward] = [Direction::Forward, Direction::Backward].map(Phase::Slip);
        let phases = |number: usize| -> Phases {
            let of_contact =
                |ball: u32| [Phase::Stick, forward, backward][number / 3_usize.pow(ball) % 3];
            let of_gap =
                |gap: u32| [Phase::Open, Phase::Closed][number / 81 / 2_usize.pow(gap) % 2];
            (0..4).map(of_contact).chain((0..4).map(of_gap)).collect()
        };
        let all: Vec<Phases> = (0..1296).map(phases).collect();
        let mut together = evaluator.incremental_forces(&state);
        let mut closed = 0;
        for some in all.chunks(TOGETHER - 1) {
            for (phases, found) in some.iter().zip(together.forces_of_several(some)) {
                let alone = evaluator.incremental_forces(&state).forces_and_gaps(phases);
                closed += alone.1.iter().filter(|gap| gap.force != 0.0).count();
                if alone.0.iter().all(is_finite) {
                    assert_eq!(found, alone, "{phases:?}");
                }
            }
        }
        assert!(closed > 500, "{closed} forces in gaps");
    }
}
