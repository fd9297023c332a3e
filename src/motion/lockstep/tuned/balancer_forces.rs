//! A balancer in one state, for deciding stick and slip, with the common parts of all candidate configurations
//! computed once.

use std::sync::Arc;

use fearless_simd::SimdBase;

use super::equations::{contact, contact_along, while_apart};
use crate::model::{Balancer, Components, Contact, Dual, State, System};
use crate::motion::Phase;
use crate::motion::evaluator::{ContactForces, Forces};
use crate::motion::joint_decision::{AHEAD, ForceModel};
use crate::motion::lockstep::trigonometry::sin_cos;
use crate::motion::lockstep::vector::{Vector, vectorized};
use crate::motion::lockstep::{LANES, Lanes};

/// A balancer in one state.
pub(super) struct BalancerForces<'a, const N: usize> {
    pub(super) balancer: &'a Balancer<N>,
    pub(super) state: State<N>,
    /// Sine and cosine of the angles.
    pub(super) turned: [(f64, f64); N],
    pub(super) surely_one_solution: bool,
}

impl<const N: usize> BalancerForces<'_, N> {
    fn contacts(&self, phases: &[Phase], state: &State<N>) -> [Contact; N] {
        std::array::from_fn(|i| {
            contact(phases[i], &self.balancer.balls[i].friction, state.beta_dot[i])
        })
    }

    fn rate(&self, phases: &[Phase]) -> State<N> {
        let contacts = self.contacts(phases, &self.state);
        let forces = self.balancer.forces_turned(&self.state, &contacts, &self.turned);
        self.balancer.derivative(&self.state, &contacts, &forces)
    }
}

fn of_contacts<const N: usize, T: Copy>(
    speed: [T; N],
    forces: &crate::model::Forces<N, T>,
) -> Forces<T> {
    let contact = |i: usize| ContactForces {
        speed: speed[i],
        acceleration: forces.beta_ddot[i],
        normal: forces.normal[i],
        friction: forces.friction[i],
    };
    Forces::from_slice(&std::array::from_fn::<_, N, _>(contact))
}

impl<const N: usize> ForceModel for BalancerForces<'_, N> {
    fn limit(&self, contact: usize) -> f64 {
        self.balancer.balls[contact].friction.limit
    }

    fn speed(&self, contact: usize) -> f64 {
        self.state.beta_dot[contact]
    }

    fn forces(&self, phases: &[Phase]) -> Forces {
        let contacts = self.contacts(phases, &self.state);
        let forces = self.balancer.forces_turned(&self.state, &contacts, &self.turned);
        of_contacts(self.state.beta_dot, &forces)
    }

    fn rates(&self, phases: &[Phase]) -> Components {
        self.rate(phases).components()
    }

    fn forces_ahead(&self, phases: &[Phase]) -> Forces {
        let mut ahead = self.state;
        ahead.add_scaled(AHEAD, &self.rate(phases));
        let forces = self.balancer.forces(&ahead, &self.contacts(phases, &ahead));
        of_contacts(ahead.beta_dot, &forces)
    }

    fn speed_along(&self, contact: usize, direction: &[f64]) -> f64 {
        direction[4 + N + contact]
    }

    fn forces_along(&self, phases: &[Phase], direction: &[f64]) -> Forces<Dual> {
        let direction = State::of_components(direction).unwrap_or(State::zero());
        let state = self.state.along(&direction);
        let contacts = std::array::from_fn(|i| {
            contact_along(phases[i], &self.balancer.balls[i].friction, state.beta_dot[i])
        });
        of_contacts(state.beta_dot, &self.balancer.lifted().forces(&state, &contacts))
    }

    fn has_one_solution(&self) -> bool {
        self.surely_one_solution || self.balancer.one_solution_at(&self.state.beta)
    }

    fn force_scale(&self) -> f64 {
        1.0 + self.balancer.speed * self.balancer.speed
    }
}

/// Returns sine and cosine of the angles of one lane.
pub(super) fn turned<S: Vector, const N: usize>(simd: S, angles: [f64; N]) -> [(f64, f64); N] {
    vectorized!(simd, {
        // A vector of the angles of one lane, not of lanes.
        const { assert!(N <= LANES) };
        let mut all = Lanes::splat(simd, 0.0);
        for (place, angle) in angles.into_iter().enumerate() {
            all[place] = angle;
        }
        let (sines, cosines) = sin_cos(all);
        std::array::from_fn(|place| (sines[place], cosines[place]))
    })
}

/// Calls a function that is large, without inlining it a second time.
#[cold]
#[inline(never)]
pub(super) fn called<R>(with: impl FnOnce(&dyn ForceModel) -> R, at: &dyn ForceModel) -> R {
    with(at)
}

/// Calls `with` with a balancer at constant speed in one state; `None` for another system.
pub(in crate::motion::lockstep) fn with_balancer_forces<R>(
    system: &Arc<dyn System>,
    surely_one_solution: bool,
    state: &[f64],
    with: impl FnOnce(&dyn ForceModel) -> R,
) -> Option<R> {
    macro_rules! of_balls {
        ($($balls:literal)*) => {
            $(
                if let Some(balancer) = while_apart::<$balls>(system) {
                    let state = State::<$balls>::of_components(state)?;
                    let turned = state.beta.map(libm::sincos);
                    return Some(with(&BalancerForces {
                        balancer,
                        state,
                        turned,
                        surely_one_solution,
                    }));
                }
            )*
        };
    }
    of_balls!(1 2 3 4 5 6 7 8);
    None
}
