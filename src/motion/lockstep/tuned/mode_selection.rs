//! A balancer in one state, for deciding stick and slip, with the common parts of all candidate configurations
//! computed once.

use crate::model::{Balancer, Components, Contact, Dual, Friction, State};
use crate::motion::Phase;
use crate::motion::evaluator::{ContactForces, Forces};
use crate::motion::modes::{AHEAD, InState};

/// A balancer in one state.
pub(super) struct InPlace<'a, const N: usize> {
    balancer: &'a Balancer<N>,
    state: State<N>,
    /// Sine and cosine of the angles.
    turned: [(f64, f64); N],
    surely_one_solution: bool,
}

impl<'a, const N: usize> InPlace<'a, N> {
    /// Creates it from the state and the sine and cosine of each angle.
    pub(super) fn new(
        balancer: &'a Balancer<N>,
        surely_one_solution: bool,
        (state, turned): (State<N>, [(f64, f64); N]),
    ) -> Self {
        InPlace { balancer, state, turned, surely_one_solution }
    }

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

/// Returns how friction acts on a contact in a phase.
pub(super) fn contact(phase: Phase, friction: &Friction, speed: f64) -> Contact {
    match phase {
        Phase::Stick | Phase::Open | Phase::Closed => Contact::STICK,
        Phase::Slip(direction) => friction.slip(direction, speed),
        Phase::Transition(direction) => friction.slip(direction, 0.0),
        Phase::Free => friction.slip(0.0, speed),
    }
}

/// Returns [`contact`] to first order in the speed.
pub(super) fn contact_along(phase: Phase, friction: &Friction, speed: Dual) -> Contact<Dual> {
    match phase {
        Phase::Stick | Phase::Open | Phase::Closed => Contact::STICK.lifted(),
        Phase::Slip(direction) => friction.slip_along(direction, speed),
        Phase::Transition(direction) => {
            friction.slip_along(direction, Dual { value: 0.0, slope: 0.0 })
        }
        Phase::Free => friction.slip_along(0.0, speed),
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

impl<const N: usize> InState for InPlace<'_, N> {
    fn friction(&self, contact: usize) -> &Friction {
        &self.balancer.balls[contact].friction
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
