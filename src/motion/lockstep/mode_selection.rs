//! The decision between stick and slip after an event in a lane, as for a run computed alone, with
//! the common parts of all candidate configurations computed once.

use super::lane::Lane;
use crate::model::{Balancer, Contact, Dual, Forces, Friction, Method, State, System};
use crate::motion::Failure;
use crate::motion::contact::Phase;

/// A balancer with fixed angles of its balls.
pub(super) struct InPlace<'a, const N: usize> {
    balancer: &'a Balancer<N>,
    beta: [f64; N],
    /// Sine and cosine of the angles.
    turned: [(f64, f64); N],
    surely_one_solution: bool,
}

impl<'a, const N: usize> InPlace<'a, N> {
    pub(super) fn new(lane: &'a Lane<N>, state: &State<N>) -> Self {
        InPlace {
            balancer: &lane.balancer,
            beta: state.beta,
            turned: state.beta.map(libm::sincos),
            surely_one_solution: lane.surely_one_solution,
        }
    }
}

impl<const N: usize> System<N, 2> for InPlace<'_, N> {
    const ANGULAR: bool = true;

    #[inline]
    fn forces(&self, state: &State<N>, contacts: &[Contact; N]) -> Forces<N> {
        if state.beta == self.beta {
            return self.balancer.forces_turned(state, contacts, &self.turned);
        }
        self.balancer.forces(state, contacts)
    }

    #[inline]
    fn derivative(
        &self,
        state: &State<N>,
        contacts: &[Contact; N],
        forces: &Forces<N>,
    ) -> State<N> {
        self.balancer.derivative(state, contacts, forces)
    }

    fn along(
        &self,
        state: &State<N, Dual>,
        contacts: &[Contact<Dual>; N],
    ) -> (Forces<N, Dual>, State<N, Dual>) {
        self.balancer.along(state, contacts)
    }

    #[inline]
    fn friction(&self, contact: usize) -> &Friction {
        self.balancer.friction(contact)
    }

    fn longest_step(&self) -> f64 {
        self.balancer.longest_step()
    }

    fn pace(&self) -> f64 {
        self.balancer.pace()
    }

    #[inline]
    fn surely_one_solution(&self) -> bool {
        self.surely_one_solution
    }

    fn one_solution_at(&self, state: &State<N>) -> bool {
        self.balancer.one_solution_at(&state.beta)
    }

    #[inline]
    fn force_scale(&self) -> f64 {
        self.balancer.force_scale()
    }
}

/// Returns the phases after an event, by the run's method.
pub(super) fn next_phases<const N: usize>(
    lane: &Lane<N>,
    system: &InPlace<N>,
    state: &mut State<N>,
    phases: &mut [Phase; N],
) -> Result<Forces<N>, Failure> {
    match lane.settings.method {
        Method::Switch => {
            crate::motion::switch_model::switch(system, lane.settings.band, state, phases)
        }
        Method::Event => crate::motion::event_driven::switch(system, state, phases, None),
    }
}
