//! The states of all lanes, the memory of a step's programs, and the series in it.

use std::ops::Index;

use fearless_simd::prelude::*;
use smallvec::SmallVec;

use super::operations::{Operations, Slot};
use super::series::{ConditionBound, Screen};
use crate::graph::{Cell, Program};
use crate::motion::lockstep::vector::Vector;
use crate::motion::lockstep::{LANES, Lanes};

/// Bit mask of all lanes.
const ALL_LANES: u64 = (1 << LANES) - 1;

/// The components of a state in all lanes, with the sliding speeds.
pub(in crate::motion::lockstep) struct RecordedLaneStates<S: Vector> {
    pub(super) components: SmallVec<[Lanes<S>; 12]>,
    /// Those of all contacts, unless each speed is a component.
    pub(super) speeds: SmallVec<[Lanes<S>; 2]>,
}

impl<S: Vector> Clone for RecordedLaneStates<S> {
    fn clone(&self) -> Self {
        RecordedLaneStates { components: self.components.clone(), speeds: self.speeds.clone() }
    }

    /// Copies a state of the same system.
    fn clone_from(&mut self, source: &Self) {
        self.components.copy_from_slice(&source.components);
        self.speeds.copy_from_slice(&source.speeds);
    }
}

/// Work space of a step, with the results of the latest step.
pub(in crate::motion::lockstep) struct RecordedWorkspace<S: Vector> {
    /// The cells of the programs.
    pub(super) memory: Vec<Lanes<S>>,
    /// Whether inputs have changed since the numbers that depend on modes were computed.
    pub(super) is_changed: bool,
    /// Where the changes of the cells along a perturbation begin.
    pub(super) perturbed: usize,
    /// Where the series begin, and their number.
    first: usize,
    slots: usize,
    /// The lanes in which a condition of each contact may fail, then those in which each event may happen.
    pub(super) lanes_to_examine: Vec<u64>,
    /// Whether the latest bounds of the conditions are those with the series of the normal forces.
    pub(super) is_exact: bool,
}

impl<S: Vector> RecordedWorkspace<S> {
    /// Returns the memory of the programs of a step.
    pub(super) fn new(simd: S, operations: &Operations, programs: [&Program; 3]) -> Self {
        let [motion, _, tail] = programs;
        let mut memory = vec![Lanes::splat(simd, 0.0); tail.cells];
        for (cell, number) in programs.into_iter().flat_map(|program| program.numbers.iter()) {
            memory[*cell as usize] = Lanes::splat(simd, *number);
        }
        let conditions =
            [operations.contacts.len(), operations.guards.len(), operations.gaps.len()];
        RecordedWorkspace {
            memory,
            is_changed: true,
            perturbed: motion.cells,
            first: operations.coefficient(0, 0) as usize,
            slots: operations.slots,
            lanes_to_examine: vec![0; conditions.into_iter().sum()],
            is_exact: false,
        }
    }

    /// Sets a number of one lane that is constant during a step.
    pub(super) fn set_constant(&mut self, id: Cell, lane: usize, value: f64) {
        self.memory[id as usize][lane] = value;
        self.is_changed = true;
    }

    /// Sets a number of one lane that no other number depends on.
    #[inline(always)]
    pub(super) fn set(&mut self, cell: Cell, lane: usize, value: f64) {
        self.memory[cell as usize][lane] = value;
    }

    /// Notes the lanes in which conditions may fail, and returns all of them.
    #[inline(always)]
    pub(super) fn screened(&mut self, screen: &Screen) -> u64 {
        let mut any = 0;
        for (doubt, cell) in self.lanes_to_examine.iter_mut().zip(&screen.all) {
            *doubt = below_zero(self.memory[*cell as usize]);
            any |= *doubt;
        }
        any
    }

    /// Returns the lanes in which one of these numbers is negative, or not a number.
    #[inline(always)]
    pub(super) fn below_zero(&self, cells: impl IntoIterator<Item = Cell>) -> u64 {
        cells.into_iter().fold(0, |any, cell| any | below_zero(self.memory[cell as usize]))
    }

    /// Returns whether a condition of a contact may fail in a lane.
    #[inline(always)]
    pub(super) fn may_fail(&self, cells: &[Cell; 4], bound: ConditionBound, lane: usize) -> bool {
        let least = self.memory[cells[bound as usize] as usize][lane];
        least < 0.0 || least.is_nan()
    }

    /// Returns the series of the motion.
    #[inline(always)]
    pub(super) fn series(&self) -> SeriesView<'_, S> {
        SeriesView { memory: &self.memory[self.first..], slots: self.slots }
    }

    /// Returns the changes of the series along a perturbation.
    #[inline(always)]
    pub(super) fn changes(&self) -> SeriesView<'_, S> {
        SeriesView { memory: &self.memory[self.perturbed + self.first..], slots: self.slots }
    }

    /// Sets the state at the start of a step, or a perturbation of it.
    #[inline(always)]
    pub(super) fn start(&mut self, components: &[Lanes<S>], perturbed: bool) {
        let first = self.first + if perturbed { self.perturbed } else { 0 };
        self.memory[first..first + components.len()].copy_from_slice(components);
    }
}

#[inline(always)]
fn below_zero<S: Vector>(number: Lanes<S>) -> u64 {
    !number.simd_ge(Lanes::splat(number.simd, 0.0)).to_bitmask() & ALL_LANES
}

/// Power series in time in all lanes. The coefficients of one order stand side by side.
#[derive(Clone, Copy)]
pub(super) struct SeriesView<'m, S: Vector> {
    memory: &'m [Lanes<S>],
    slots: usize,
}

impl<'m, S: Vector> SeriesView<'m, S> {
    /// Returns the coefficients of a series.
    #[inline(always)]
    pub(super) fn of(self, slot: Slot) -> SeriesCoefficients<'m, S> {
        SeriesCoefficients { memory: &self.memory[slot as usize..], slots: self.slots }
    }

    /// Returns the coefficients of all series of one order.
    #[inline(always)]
    pub(super) fn order(self, k: usize) -> &'m [Lanes<S>] {
        &self.memory[k * self.slots..][..self.slots]
    }
}

/// The coefficients of a series, from order zero.
#[derive(Clone, Copy)]
pub(super) struct SeriesCoefficients<'m, S: Vector> {
    memory: &'m [Lanes<S>],
    slots: usize,
}

impl<S: Vector> Index<usize> for SeriesCoefficients<'_, S> {
    type Output = Lanes<S>;

    #[inline(always)]
    fn index(&self, k: usize) -> &Lanes<S> {
        &self.memory[k * self.slots]
    }
}
