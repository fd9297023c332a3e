//! An integration that is independent of the engine: the hand-written equations of the balancer and the Runge-Kutta
//! method DOP853, with given phases.

mod dop853;
mod dop853_tableau;

use stickslip::model::{Balancer, Contact, ContactMode, Forces, State};
use stickslip::motion::Phase;

pub use dop853::step;

/// Returns how friction acts on every ball.
pub fn contacts<const N: usize>(
    balancer: &Balancer<N>,
    phases: &[Phase],
    state: &State<N>,
) -> [Contact; N] {
    std::array::from_fn(|ball| match phases[ball].mode() {
        ContactMode::Stick | ContactMode::Apart | ContactMode::Open | ContactMode::Closed => {
            Contact::STICK
        }
        ContactMode::Slip(direction) => {
            balancer.balls[ball].friction.slip(direction, state.beta_dot[ball])
        }
        ContactMode::BreakingAway(direction) => balancer.balls[ball].friction.slip(direction, 0.0),
    })
}

/// Returns the forces in a state for given phases.
pub fn forces<const N: usize>(
    balancer: &Balancer<N>,
    phases: &[Phase],
    state: &State<N>,
) -> Forces<N> {
    balancer.forces(state, &contacts(balancer, phases, state))
}

/// Returns the time derivative of a state for given phases.
pub fn derivative<const N: usize>(
    balancer: &Balancer<N>,
    phases: &[Phase],
    state: &State<N>,
) -> State<N> {
    let contacts = contacts(balancer, phases, state);
    balancer.derivative(state, &contacts, &balancer.forces(state, &contacts))
}

/// Returns the remaining friction of a sticking ball, `μ_s f_n - |f_w|`.
pub fn stick_reserve<const N: usize>(
    balancer: &Balancer<N>,
    forces: &Forces<N>,
    ball: usize,
) -> f64 {
    balancer.balls[ball].friction.limit * forces.normal[ball] - forces.friction[ball].abs()
}
