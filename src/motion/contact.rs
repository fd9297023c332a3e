//! The phase of each contact, and the joint decision for several contacts.

use super::Failure;
use crate::model::{Contact, Dual, Forces, Friction, State, System};

/// The phase of a ball (thesis table 4.2) or a block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Phase {
    /// It moves, faster than the band, in the direction 1 or -1. In the exact motion, which has no
    /// band, this phase starts when the contact breaks away.
    Slip(f64),
    /// It rests on the ring: friction holds it.
    Stick,
    /// It is in the band but friction does not hold it: it accelerates in the direction 1 or -1.
    Transition(f64),
    /// Its law has no stick: it moves in either direction.
    Free,
}

impl Phase {
    /// How friction acts on a contact in this phase.
    #[inline]
    pub fn contact(self, friction: &Friction, speed: f64) -> Contact {
        match self {
            Phase::Stick => Contact::STICK,
            Phase::Slip(direction) | Phase::Transition(direction) => {
                friction.slip(direction, speed)
            }
            Phase::Free => friction.slip(0.0, speed),
        }
    }

    /// [`Phase::contact`] to first order in the speed.
    #[inline]
    pub(super) fn contact_along(self, friction: &Friction, speed: Dual) -> Contact<Dual> {
        match self {
            Phase::Stick => Contact::STICK.lifted(),
            Phase::Slip(direction) | Phase::Transition(direction) => {
                friction.slip_along(direction, speed)
            }
            Phase::Free => friction.slip_along(0.0, speed),
        }
    }

    /// Returns whether it sticks, or may stick at any moment.
    pub fn in_band(self) -> bool {
        matches!(self, Phase::Stick | Phase::Transition(_))
    }
}

/// Time interval for the rate of change of a condition, non-dimensional.
pub(super) const AHEAD: f64 = 1e-6;

/// Returns the state after the interval [`AHEAD`], to first order.
pub(super) fn look_ahead<const N: usize, const FREE: usize>(
    state: &State<N, f64, FREE>,
    derivative: &State<N, f64, FREE>,
) -> State<N, f64, FREE> {
    let mut ahead = *state;
    ahead.add_scaled(AHEAD, derivative);
    ahead
}

/// How friction acts on every contact.
#[inline]
pub fn contacts<S: System<N, FREE>, const N: usize, const FREE: usize>(
    system: &S,
    phases: &[Phase; N],
    state: &State<N, f64, FREE>,
) -> [Contact; N] {
    std::array::from_fn(|i| phases[i].contact(system.friction(i), state.beta_dot[i]))
}

/// The forces in a state for given phases.
pub fn forces<S: System<N, FREE>, const N: usize, const FREE: usize>(
    system: &S,
    phases: &[Phase; N],
    state: &State<N, f64, FREE>,
) -> Forces<N, f64, FREE> {
    system.forces(state, &contacts(system, phases, state))
}

/// The time derivative of a state for given phases.
pub fn derivative<S: System<N, FREE>, const N: usize, const FREE: usize>(
    system: &S,
    phases: &[Phase; N],
    state: &State<N, f64, FREE>,
) -> State<N, f64, FREE> {
    SmoothPhase::new(system, phases).derivative(state)
}

/// The equations of motion between two phase changes. Friction that does not depend on speed is
/// evaluated once.
#[derive(Clone, Copy, Debug)]
pub(super) struct SmoothPhase<'a, S, const N: usize, const FREE: usize> {
    system: &'a S,
    phases: [Phase; N],
    constant: Option<[Contact; N]>,
}

impl<'a, S: System<N, FREE>, const N: usize, const FREE: usize> SmoothPhase<'a, S, N, FREE> {
    pub(super) fn new(system: &'a S, phases: &[Phase; N]) -> Self {
        let contact = |ball: usize| phases[ball].contact(system.friction(ball), 0.0);
        let constant = (0..N).all(|ball| system.friction(ball).is_constant());
        SmoothPhase {
            system,
            phases: *phases,
            constant: constant.then(|| std::array::from_fn(contact)),
        }
    }

    #[inline]
    fn contacts(&self, state: &State<N, f64, FREE>) -> [Contact; N] {
        self.constant.unwrap_or_else(|| contacts(self.system, &self.phases, state))
    }

    /// The forces in a state.
    #[inline]
    pub(super) fn forces(&self, state: &State<N, f64, FREE>) -> Forces<N, f64, FREE> {
        self.system.forces(state, &self.contacts(state))
    }

    /// The time derivative of a state.
    #[inline]
    pub(super) fn derivative(&self, state: &State<N, f64, FREE>) -> State<N, f64, FREE> {
        let contacts = self.contacts(state);
        self.system.derivative(state, &contacts, &self.system.forces(state, &contacts))
    }

    /// Forces and time derivative to first order along a direction.
    #[inline]
    pub(super) fn along(
        &self,
        state: &State<N, Dual, FREE>,
    ) -> (Forces<N, Dual, FREE>, State<N, Dual, FREE>) {
        let contacts = match &self.constant {
            Some(contacts) => contacts.map(Contact::lifted),
            None => std::array::from_fn(|ball| {
                let friction = self.system.friction(ball);
                self.phases[ball].contact_along(friction, state.beta_dot[ball])
            }),
        };
        self.system.along(state, &contacts)
    }

    /// The time derivative of a state in which the forces are known.
    #[inline]
    pub(super) fn derivative_with(
        &self,
        state: &State<N, f64, FREE>,
        forces: &Forces<N, f64, FREE>,
    ) -> State<N, f64, FREE> {
        self.system.derivative(state, &self.contacts(state), forces)
    }
}

/// Returns the remaining friction of a sticking contact, `μ_s f_n - |f_w|`.
pub fn stick_reserve<S: System<N, FREE>, const N: usize, const FREE: usize>(
    system: &S,
    forces: &Forces<N, f64, FREE>,
    contact: usize,
) -> f64 {
    system.friction(contact).limit * forces.normal[contact] - forces.friction[contact].abs()
}

/// Returns an error for forces that are not finite and for normal forces that pull.
pub(super) fn check_forces<const N: usize, const FREE: usize>(
    forces: &Forces<N, f64, FREE>,
) -> Result<(), Failure> {
    let Forces { table_acceleration, beta_ddot, normal, .. } = forces;
    if !table_acceleration.iter().chain(beta_ddot).chain(normal).all(|force| force.is_finite()) {
        return Err(Failure::NotFinite);
    }
    match normal.iter().position(|&force| force <= 0.0) {
        Some(ball) => Err(Failure::ContactLost { ball: ball + 1 }),
        None => Ok(()),
    }
}
