//! The interface of a mechanical system with dry friction.

use super::{Balancer, Contact, Dual, Forces, Friction, State};

/// A system with `N` contacts that stick or slip and `FREE` other coordinates, without dimensions.
pub trait System<const N: usize, const FREE: usize> {
    /// Whether the contacts' coordinates are angles with a period of one turn.
    const ANGULAR: bool;

    /// Accelerations and contact forces in a state, for given contacts.
    fn forces(&self, state: &State<N, f64, FREE>, contacts: &[Contact; N]) -> Forces<N, f64, FREE>;

    /// Returns the time derivative of the state, from the forces in it. A sticking contact rests on
    /// its support, and its residual speed decays (switch model, thesis section 4.2: `β' = 0`,
    /// `(β̇)' = -β̇`).
    fn derivative(
        &self,
        state: &State<N, f64, FREE>,
        contacts: &[Contact; N],
        forces: &Forces<N, f64, FREE>,
    ) -> State<N, f64, FREE>;

    /// The forces and the time derivative to first order along a direction.
    fn along(
        &self,
        state: &State<N, Dual, FREE>,
        contacts: &[Contact<Dual>; N],
    ) -> (Forces<N, Dual, FREE>, State<N, Dual, FREE>);

    /// The friction of a contact, counted from 0.
    fn friction(&self, contact: usize) -> &Friction;

    /// Returns the longest step within which a friction force cannot rise and fall undetected.
    fn longest_step(&self) -> f64;

    /// Returns the rate at which the motion may change, over the natural frequency; the number of
    /// steps of a well-behaved motion is proportional to it.
    fn pace(&self) -> f64;

    /// Returns the smallest number of steps per unit of time.
    fn fewest_steps(&self) -> f64 {
        1.0 / self.longest_step()
    }

    /// Returns whether a test of negligible cost proves that stick and slip are decided in exactly
    /// one way in every state.
    fn surely_one_solution(&self) -> bool;

    /// Returns whether stick and slip are decided in exactly one way in this state, for any forces.
    fn one_solution_at(&self, state: &State<N, f64, FREE>) -> bool;

    /// Returns the size of the forces, to which rounding errors are relative.
    fn force_scale(&self) -> f64;
}

/// Returns the contribution of friction with this damping rate to the pace: the number of steps per
/// unit of time of an explicit method is about a sixth of the rate, far below the effort limit of
/// this pace. Above a rate of 1e5 a run is too stiff to compute.
pub(super) fn stiff_pace(damping_rate: f64) -> f64 {
    1e-3 * damping_rate.min(1e5)
}

impl<const N: usize> System<N, 2> for Balancer<N> {
    const ANGULAR: bool = true;

    #[inline]
    fn forces(&self, state: &State<N>, contacts: &[Contact; N]) -> Forces<N> {
        Balancer::forces(self, state, contacts)
    }

    #[inline]
    fn derivative(
        &self,
        state: &State<N>,
        contacts: &[Contact; N],
        forces: &Forces<N>,
    ) -> State<N> {
        Balancer::derivative(self, state, contacts, forces)
    }

    #[inline]
    fn along(
        &self,
        state: &State<N, Dual>,
        contacts: &[Contact<Dual>; N],
    ) -> (Forces<N, Dual>, State<N, Dual>) {
        let balancer = self.lifted();
        let forces = balancer.forces(state, contacts);
        (forces, balancer.derivative(state, contacts, &forces))
    }

    #[inline]
    fn friction(&self, contact: usize) -> &Friction {
        &self.balls[contact].friction
    }

    /// A quarter of the shortest period of the table in the turning frame.
    fn longest_step(&self) -> f64 {
        0.5 * std::f64::consts::PI / (self.speed.abs() + 1.0)
    }

    fn pace(&self) -> f64 {
        let weight = self.speed * self.speed;
        let rates = self.balls.iter().map(|ball| ball.friction.damping_rate(weight));
        1.0 + self.speed.abs() + self.damping_ratio + stiff_pace(rates.fold(0.0, f64::max))
    }

    /// The number of steps of an explicit method is about a tenth of the table's damping rate.
    fn fewest_steps(&self) -> f64 {
        1.0 / self.longest_step() + 0.2 * self.damping_ratio
    }

    #[inline]
    fn surely_one_solution(&self) -> bool {
        Balancer::surely_one_solution(self)
    }

    fn one_solution_at(&self, state: &State<N>) -> bool {
        Balancer::one_solution_at(self, &state.beta)
    }

    fn force_scale(&self) -> f64 {
        1.0 + self.speed * self.speed
    }
}
