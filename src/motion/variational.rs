//! Neighbouring motions to first order: the linearised flow, through stick and slip.
//!
//! In a smooth phase a small displacement follows the linearised equations. Each step of the motion
//! is repeated in dual numbers, so that the displacement is propagated by the exact derivative of
//! the step, of the same order as the step itself. At a switch, which a neighbour meets slightly
//! earlier or later, it jumps by the saltation matrix
//!
//! ```text
//! S = 1 + (f⁺ - f⁻) ∇hᵀ / (∇hᵀ f⁻)
//! ```
//!
//! with the time derivatives `f⁻`, `f⁺` before and after and the condition `h` that fails (M. A.
//! Aizerman, F. R. Gantmakher, Quart. J. Mech. Appl. Math. 11 (1958) 433,
//! doi:10.1093/qjmam/11.4.433; R. I. Leine, H. Nijmeijer, *Dynamics and Bifurcations of Non-Smooth
//! Mechanical Systems*, Springer 2004, chapter 7, doi:10.1007/978-3-540-44398-8). A ball that comes
//! to rest thereby loses its speed in every direction; where it breaks loose against friction that
//! does not jump, nothing happens.
//!
//! If several contacts switch at the same instant (balls side by side by symmetry), the motion of a
//! neighbour depends on which of its contacts comes first; the condition that the motion itself has
//! met first is then used for all of them.

use super::contact::SmoothPhase;
use super::dop853::Step;
use super::driver::Motion;
use super::guard::{Guard, Margins};
use crate::model::{Dual, Number, State, System};

/// A condition whose rate is below this fraction of the largest possible rate is grazed: there the
/// neighbours' motions differ by more than first order.
const GRAZING: f64 = 1e-12;

/// Jumps of the rate of change up to this, over the size of the forces, count as zero: a ball
/// breaks loose against friction that does not jump, within the width in which the instant is
/// located.
const NO_JUMP: f64 = 1e-8;

/// Small displacements from a motion, each in its own direction.
#[derive(Clone, Debug, PartialEq)]
pub struct Variational<const N: usize, const FREE: usize = 2> {
    /// The displacements, up to a common small factor.
    pub directions: Vec<State<N, f64, FREE>>,
    /// Whether a switch was met by grazing, so that the displacements are undefined.
    pub grazed: bool,
}

impl<const N: usize, const FREE: usize> Variational<N, FREE> {
    /// Creates displacements in these directions.
    pub fn new(directions: Vec<State<N, f64, FREE>>) -> Self {
        Variational { directions, grazed: false }
    }

    /// Propagates the displacements over the latest step of the motion, and over the switch at its
    /// end if there was one. Must be called once after each step.
    pub fn follow<S: System<N, FREE>>(&mut self, motion: &Motion<S, N, FREE>) {
        let Some(last) = motion.last_step() else { return };
        let system = motion.system();
        let before = SmoothPhase::new(system, &last.phases);
        let length = last.used * last.step.length;
        if length > 0.0 {
            self.carry(&before, &last.step.start, length);
        }
        let Some(guard) = last.ended_by.filter(|_| last.phases != *motion.phases()) else {
            return;
        };
        self.grazed |= saltation(
            (system, motion.margins()),
            (&before, guard),
            (motion.state(), motion.derivative()),
            &mut self.directions,
        );
    }

    /// Returns the displacements at a time within the latest step of the motion, before that step
    /// has been followed.
    pub fn followed_to<S: System<N, FREE>>(
        &self,
        motion: &Motion<S, N, FREE>,
        time: f64,
    ) -> Vec<State<N, f64, FREE>> {
        let mut there = self.clone();
        if let Some(last) = motion.last_step() {
            let phase = SmoothPhase::new(motion.system(), &last.phases);
            there.carry(&phase, &last.step.start, time - last.start_time);
        }
        there.directions
    }

    /// Propagates the displacements over a smooth part of the motion from `start`.
    fn carry<S: System<N, FREE>>(
        &mut self,
        phase: &SmoothPhase<S, N, FREE>,
        start: &State<N, f64, FREE>,
        length: f64,
    ) {
        for direction in &mut self.directions {
            let start = start.along(direction);
            let rate = |state: &State<N, Dual, FREE>| phase.along(state).1;
            let step = Step::attempt(rate, &start, &rate(&start), Dual::constant(length));
            *direction = step.end.slope();
        }
    }
}

/// Propagates displacements over a switch at which the phase `before` ended because this condition
/// failed; `state` and `rate` are those at the start of the next phase. Returns whether the switch
/// was met by grazing.
pub(super) fn saltation<S: System<N, FREE>, const N: usize, const FREE: usize>(
    (system, margins): (&S, Margins),
    (before, guard): (&SmoothPhase<S, N, FREE>, Guard),
    (state, rate): (&State<N, f64, FREE>, &State<N, f64, FREE>),
    directions: &mut [State<N, f64, FREE>],
) -> bool {
    let rate_before = before.derivative(state);
    let mut jump = *rate;
    jump.add_scaled(-1.0, &rate_before);
    if largest(&jump) <= NO_JUMP * system.force_scale() {
        return false;
    }
    let change_of_condition = |direction: &State<N, f64, FREE>| {
        guard.slope_along(direction).unwrap_or_else(|| {
            let state = state.along(direction);
            let (forces, _) = before.along(&state);
            guard.value(system, margins, (&state, &forces)).slope
        })
    };
    let rate = change_of_condition(&rate_before);
    for direction in directions {
        let factor = change_of_condition(direction) / rate;
        direction.add_scaled(factor, &jump);
    }
    rate.is_nan() || rate.abs() <= GRAZING * system.force_scale()
}

fn largest<const N: usize, const FREE: usize>(state: &State<N, f64, FREE>) -> f64 {
    let State { position, velocity, beta, beta_dot } = state;
    let all = position.iter().chain(velocity).chain(beta).chain(beta_dot);
    all.fold(0.0, |most: f64, value| most.max(value.abs()))
}
