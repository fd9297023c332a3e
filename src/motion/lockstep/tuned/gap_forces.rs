//! The forces in closed gaps between balls.
//!
//! A force `λ` accelerates the ball behind the gap and the ball ahead of it by constant factors, so that it needs no products
//! of series: for each power of time, the forces are those for which balls that touch accelerate alike. Their effect on all
//! accelerations, that by way of the table included, depends on the start of the step only.

use fearless_simd::SimdBase;

use super::equations::Equations;
use super::terms::Solver;
use crate::model::{self, pushes};
use crate::motion::lockstep::Lanes;
use crate::motion::lockstep::gap_conditions::Pressure;
use crate::motion::lockstep::lane::Lane;
use crate::motion::lockstep::vector::{Fused, Vector, vectorized};

/// The forces in the gaps, or the accelerations of the balls, for one power of time.
pub(super) type OfEach<S, const N: usize> = [Lanes<S>; N];

/// The gaps of all lanes. Their number is that of the balls.
pub(super) struct GapForceEquations<S: Vector, const N: usize> {
    pub(super) gaps: [GapForceEquation<S, N>; N],
}

/// A gap in all lanes. All numbers are 0 in lanes in which it has no force.
#[derive(Clone, Copy)]
pub(super) struct GapForceEquation<S: Vector, const N: usize> {
    /// Bit mask of lanes in which it is closed and has a force.
    closed: u64,
    /// 1 in other lanes.
    open: Lanes<S>,
    /// Acceleration of each ball along the ring by a unit of force.
    push: OfEach<S, N>,
    /// Normal force on each ball, over its mass, by a unit of force.
    pub(super) outward: OfEach<S, N>,
    /// 1 for the ball ahead, -1 for the ball behind.
    side: OfEach<S, N>,
    pub(super) pressure: Pressure<S>,
}

impl<S: Vector, const N: usize> GapForceEquations<S, N> {
    /// No gaps.
    pub(super) fn none(simd: S) -> Self {
        let zero = Lanes::splat(simd, 0.0);
        let gap = GapForceEquation {
            closed: 0,
            open: Lanes::splat(simd, 1.0),
            push: [zero; N],
            outward: [zero; N],
            side: [zero; N],
            pressure: Pressure::none(simd),
        };
        GapForceEquations { gaps: [gap; N] }
    }

    /// Returns whether any lane has a force in a gap.
    #[inline(always)]
    pub(super) fn have_forces(&self) -> bool {
        let mut any = 0;
        for gap in &self.gaps {
            any |= gap.closed;
        }
        any != 0
    }

    /// Forgets a lane.
    pub(super) fn clear(&mut self, lane: usize) {
        for gap in &mut self.gaps {
            gap.closed &= !(1 << lane);
            gap.open[lane] = 1.0;
            gap.pressure.clear(lane);
            for ball in 0..N {
                gap.push[ball][lane] = 0.0;
                gap.outward[ball][lane] = 0.0;
                gap.side[ball][lane] = 0.0;
            }
        }
    }

    /// Sets the gaps of a lane by its phases. The coefficients of its balls must be set.
    pub(super) fn set(
        &mut self,
        lane: usize,
        run: &Lane,
        gaps: &[model::Gap],
        equations: &Equations<S, N>,
    ) {
        self.clear(lane);
        let modes: Vec<_> = run.phases.iter().map(|phase| phase.mode()).collect();
        let pushes = pushes(gaps, &modes);
        let phases = &run.phases[N..];
        for ((of_all, gap), (pushes, phase)) in
            self.gaps.iter_mut().zip(gaps).zip(pushes.zip(phases))
        {
            of_all.pressure.set(lane, run, (gap, *phase));
            let Some(pushes) = pushes else { continue };
            of_all.closed |= 1 << lane;
            of_all.open[lane] = 0.0;
            for ((&ball, [along, outward]), side) in
                gap.contacts.iter().zip(pushes).zip([-1.0, 1.0])
            {
                let of_ball = &equations.balls[ball];
                let along = along - of_ball.friction[lane] * outward;
                of_all.push[ball][lane] = of_ball.mobility[lane] * along;
                of_all.outward[ball][lane] = outward;
                of_all.side[ball][lane] = side;
            }
        }
    }
}

/// The effect of the forces in gaps from the start of a step on.
pub(super) struct GapForceEffect<S: Vector, const N: usize> {
    /// Whether there are forces; if not, everything else is of another step.
    pub(super) active: bool,
    /// Bit mask of gaps with a force in any lane.
    closed: u64,
    /// The acceleration of the table by a unit of force in each gap.
    table: [[Lanes<S>; 2]; N],
    /// The accelerations of the balls by a unit of force in each gap.
    balls: [OfEach<S, N>; N],
    /// The sides of the gaps ([`GapForceEquation::side`]).
    sides: [OfEach<S, N>; N],
    /// The forces by a unit of relative acceleration in each gap.
    inverse: [OfEach<S, N>; N],
}

impl<S: Vector, const N: usize> GapForceEffect<S, N> {
    pub(super) fn none(simd: S) -> Self {
        let zero = [[Lanes::splat(simd, 0.0); N]; N];
        GapForceEffect {
            active: false,
            closed: 0,
            table: [[Lanes::splat(simd, 0.0); 2]; N],
            balls: zero,
            sides: zero,
            inverse: zero,
        }
    }

    /// Prepares a step.
    #[inline(always)]
    pub(super) fn begin(&mut self, gaps: &GapForceEquations<S, N>, solver: &Solver<S, N>) {
        self.active = gaps.have_forces();
        if self.active {
            self.set(gaps, solver);
        }
    }

    #[inline(never)]
    fn set(&mut self, gaps: &GapForceEquations<S, N>, solver: &Solver<S, N>) {
        let simd = solver.inverse[0].simd;
        vectorized!(simd, {
            let [zero, one] = [0.0, 1.0].map(|value| Lanes::splat(simd, value));
            let [a, b, c, d] = solver.inverse;
            self.closed = 0;
            for (g, gap) in gaps.gaps.iter().enumerate() {
                self.closed |= u64::from(gap.closed != 0) << g;
                let [mut force_x, mut force_y] = [zero; 2];
                for ball in 0..N {
                    let [along, across] = solver.reaction[ball];
                    force_x += along * gap.push[ball];
                    force_y += across * gap.push[ball];
                }
                let pull = [a.fused(force_x, b * force_y), d.fused(force_y, c * force_x)];
                self.table[g] = pull;
                self.sides[g] = gap.side;
                for ball in 0..N {
                    let [along, across] = solver.drawn[ball];
                    self.balls[g][ball] = along.fused(pull[0], across * pull[1]) + gap.push[ball];
                }
            }
            // The relative accelerations by the forces, inverted by elimination: the matrix is nearly symmetric and definite.
            let mut matrix = [[zero; N]; N];
            for (row, (values, gap)) in matrix.iter_mut().zip(&gaps.gaps).enumerate() {
                for (column, value) in values.iter_mut().enumerate() {
                    for ball in 0..N {
                        *value += gap.side[ball] * self.balls[column][ball];
                    }
                }
                values[row] += gap.open;
                self.inverse[row] = [zero; N];
                self.inverse[row][row] = one;
            }
            for pivot in 0..N {
                if !self.has(pivot) {
                    continue;
                }
                let scale = one / matrix[pivot][pivot];
                for value in matrix[pivot].iter_mut().chain(&mut self.inverse[pivot]) {
                    *value *= scale;
                }
                let (of_pivot, of_inverse) = (matrix[pivot], self.inverse[pivot]);
                let closed = self.closed;
                for (row, (values, inverse)) in matrix.iter_mut().zip(&mut self.inverse).enumerate()
                {
                    if row == pivot || closed & 1 << row == 0 {
                        continue;
                    }
                    let factor = zero - values[pivot];
                    for (value, above) in values.iter_mut().zip(of_pivot) {
                        *value = factor.fused(above, *value);
                    }
                    for (value, above) in inverse.iter_mut().zip(of_inverse) {
                        *value = factor.fused(above, *value);
                    }
                }
            }
        })
    }

    #[inline(always)]
    fn has(&self, gap: usize) -> bool {
        self.closed & 1 << gap != 0
    }

    /// Returns the forces that make balls that touch accelerate alike, from their accelerations without forces; adds the
    /// effect of the forces to these and to the acceleration of the table.
    #[inline(always)]
    pub(super) fn join(
        &self,
        accelerations: &mut OfEach<S, N>,
        pull: &mut [Lanes<S>; 2],
    ) -> OfEach<S, N> {
        let zero = Lanes::splat(pull[0].simd, 0.0);
        let (mut relative, mut forces) = ([zero; N], [zero; N]);
        for (gap, relative) in relative.iter_mut().enumerate() {
            if self.has(gap) {
                for (side, acceleration) in self.sides[gap].iter().zip(&*accelerations) {
                    *relative = side.fused(*acceleration, *relative);
                }
            }
        }
        for (gap, force) in forces.iter_mut().enumerate() {
            if !self.has(gap) {
                continue;
            }
            let mut sum = zero;
            for (other, relative) in relative.iter().enumerate() {
                if self.has(other) {
                    sum = self.inverse[gap][other].fused(*relative, sum);
                }
            }
            *force = zero - sum;
        }
        for (gap, force) in forces.into_iter().enumerate() {
            if !self.has(gap) {
                continue;
            }
            for (pull, by_force) in pull.iter_mut().zip(self.table[gap]) {
                *pull = by_force.fused(force, *pull);
            }
            for (acceleration, by_force) in accelerations.iter_mut().zip(self.balls[gap]) {
                *acceleration = by_force.fused(force, *acceleration);
            }
        }
        forces
    }
}
