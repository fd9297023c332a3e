//! The components of a balancer's state in all lanes.

use fearless_simd::{mask64x8, prelude::*};

use crate::model::State;
use crate::motion::lockstep::Lanes;
use crate::motion::lockstep::vector::{Fused, Vector};

/// The components of a state, or of its rate of change, of each run.
#[derive(Clone, Copy)]
pub(in crate::motion::lockstep) struct BalancerLaneStates<S: Vector, const N: usize> {
    /// x, y, ẋ, ẏ.
    pub(super) table: [Lanes<S>; 4],
    /// Angles of the balls.
    pub(super) angle: [Lanes<S>; N],
    /// Their speeds.
    pub(super) speed: [Lanes<S>; N],
}

impl<S: Vector, const N: usize> BalancerLaneStates<S, N> {
    /// Zero in all lanes.
    #[inline(always)]
    pub(super) fn zero(simd: S) -> Self {
        let zero = Lanes::splat(simd, 0.0);
        BalancerLaneStates { table: [zero; 4], angle: [zero; N], speed: [zero; N] }
    }

    /// Replaces the components in the lanes of a mask.
    #[inline(always)]
    pub(super) fn select(&mut self, from: &Self, mask: mask64x8<S>) {
        for i in 0..4 {
            self.table[i] = mask.select(from.table[i], self.table[i]);
        }
        for i in 0..N {
            self.angle[i] = mask.select(from.angle[i], self.angle[i]);
            self.speed[i] = mask.select(from.speed[i], self.speed[i]);
        }
    }

    /// Returns zero in the lanes in which all components are finite.
    #[inline(always)]
    pub(super) fn finite(&self, start: Lanes<S>) -> Lanes<S> {
        let zero = Lanes::splat(start.simd, 0.0);
        let mut nought = start;
        for value in self.table.iter().chain(&self.angle).chain(&self.speed) {
            nought = value.fused(zero, nought);
        }
        nought
    }

    /// Returns the sum of the squares of all components of a perturbation.
    #[inline(always)]
    pub(super) fn square(&self) -> Lanes<S> {
        let mut size = Lanes::splat(self.table[0].simd, 0.0);
        for value in self.table {
            size = value.fused(value, size);
        }
        for i in 0..N {
            size = self.angle[i].fused(self.angle[i], size);
            size = self.speed[i].fused(self.speed[i], size);
        }
        size
    }

    /// Returns one run's components.
    pub(super) fn lane(&self, lane: usize) -> State<N> {
        let [x, y, x_dot, y_dot] = self.table.each_ref().map(|of_all| of_all[lane]);
        State {
            position: [x, y],
            velocity: [x_dot, y_dot],
            beta: self.angle.each_ref().map(|of_all| of_all[lane]),
            beta_dot: self.speed.each_ref().map(|of_all| of_all[lane]),
        }
    }

    /// Sets one run's components, which must be those of `N` balls.
    pub(super) fn set_lane(&mut self, lane: usize, components: &[f64]) {
        let states = self.table.iter_mut().chain(&mut self.angle).chain(&mut self.speed);
        states.zip(components).for_each(|(of_all, value)| of_all[lane] = *value);
    }
}

/// Returns the components of a balancer that are angles.
pub(in crate::motion::lockstep) fn angles(balls: usize) -> std::ops::Range<usize> {
    4..4 + balls
}
