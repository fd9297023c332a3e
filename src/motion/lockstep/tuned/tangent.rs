//! Small perturbations from the motions in lockstep: propagated by the linearised flow in vectors.

use fearless_simd::prelude::*;

use super::equations::Equations;
use super::lane_states::BalancerLaneStates;
use super::recurrence::{Constants, Solving, products, solve};
use super::series::BalancerSeries;
use crate::motion::lockstep::Lanes;
use crate::motion::lockstep::vector::{Fused, Vector, vectorized};

/// The highest power of time in the series of a perturbation's speeds.
pub(super) const LINEAR: usize = 14;

impl<S: Vector, const N: usize> BalancerSeries<S, N> {
    /// Expands a perturbation from the expanded motion: the same equations to first order.
    #[inline(always)]
    pub(super) fn expand_perturbation(
        &self,
        equations: &Equations<S, N>,
        start: &BalancerLaneStates<S, N>,
        perturbed: &mut Self,
    ) {
        let [x, y, x_dot, y_dot] = start.table;
        let [first, second, ..] = &mut perturbed.terms;
        first.table = [x, y];
        second.table = [x_dot, y_dot];
        let zero = Lanes::splat(x.simd, 0.0);
        let two = Lanes::splat(x.simd, 2.0);
        let double_speed = equations.double_speed;
        let mut residual = [[zero; 2]; 2];
        let mut left_over = zero;
        for i in 0..N {
            let ball = &equations.balls[i];
            let [real, imaginary] = self.terms[0].balls[i].direction;
            let base = self.terms[0].balls[i].speed;
            let angle = start.angle[i];
            let speed = ball.free * start.speed[i];
            let turned = [-(imaginary * angle), real * angle];
            first.balls[i].speed = speed;
            first.balls[i].direction = turned;
            second.balls[i].direction =
                [-base.fused(turned[1], speed * imaginary), base.fused(turned[0], speed * real)];
            // The residual speed of a sticking ball: (2ω r + r²) e, to first order.
            let [c, s] = self.solver.trigonometry[i];
            let left = self.solver.residual[i];
            let perturbed_left = start.speed[i] - speed;
            left_over = left_over.max(left.abs()).max(perturbed_left.abs());
            let forces = [
                [double_speed * perturbed_left, double_speed * left],
                [two * left * perturbed_left, left * left],
            ];
            for ([speed, turned], residual) in forces.into_iter().zip(&mut residual) {
                let turned = turned * angle;
                residual[0] += ball.mass * (speed * c - turned * s);
                residual[1] += ball.mass * (speed * s + turned * c);
            }
        }
        perturbed.residual = (!left_over.simd_eq(zero).all_true()).then_some(residual);
        if self.response.active {
            for k in 0..LINEAR {
                self.order_of_perturbation::<true>(equations, perturbed, k);
            }
        } else {
            for k in 0..LINEAR {
                self.order_of_perturbation::<false>(equations, perturbed, k);
            }
        }
    }

    #[inline(never)]
    fn order_of_perturbation<const TOUCHING: bool>(
        &self,
        equations: &Equations<S, N>,
        perturbed: &mut Self,
        k: usize,
    ) {
        vectorized!(equations.speed.simd, self.linear_order::<TOUCHING>(equations, perturbed, k));
    }

    #[inline(always)]
    fn linear_order<const TOUCHING: bool>(
        &self,
        equations: &Equations<S, N>,
        perturbed: &mut Self,
        k: usize,
    ) {
        let BalancerSeries { terms, residual, sums, .. } = perturbed;
        let [all, others] = sums;
        products(&self.terms, terms, k, all);
        products(terms, &self.terms, k, others);
        let [pull_x, pull_y] = self.terms[k].pull;
        for i in 0..N {
            let [real, imaginary] = terms[0].balls[i].direction;
            let next = self.terms[k + 1].balls[i].speed;
            let sums = &mut all[i];
            sums.turning[0] += next.fused(real, others[i].turning[0]);
            sums.turning[1] += next.fused(imaginary, others[i].turning[1]);
            sums.drawn += others[i].drawn + (imaginary * pull_x - real * pull_y);
            let mut squared = Lanes::splat(pull_x.simd, 0.0);
            let along = terms[..=k].iter().rev();
            for (term, along) in self.terms[..=k].iter().zip(along) {
                squared = term.balls[i].speed.fused(along.balls[i].speed, squared);
            }
            sums.squared = squared + squared;
        }
        let start = Some(&self.terms[0]);
        let residual = residual.as_ref();
        let by = Solving { solver: &self.solver, start, residual, gaps: &self.response };
        solve::<S, N, TOUCHING>(terms, equations, &by, k, all, Constants::None);
    }
}

/// Propagates perturbations over a step of this length, in all lanes; `perturbed` is work space.
#[inline(always)]
pub(super) fn propagate<S: Vector, const N: usize>(
    series: &BalancerSeries<S, N>,
    equations: &Equations<S, N>,
    perturbation: &BalancerLaneStates<S, N>,
    length: Lanes<S>,
    perturbed: &mut BalancerSeries<S, N>,
) -> BalancerLaneStates<S, N> {
    series.expand_perturbation(equations, perturbation, perturbed);
    let higher = series.beyond(equations, perturbed, length);
    perturbed.at_with(equations, perturbation, length, LINEAR, higher)
}
