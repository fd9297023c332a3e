//! The balancer whose balls cannot pass through each other.
//!
//! While no balls touch, the equations are those of [`Balancer`]. The forces `λ` in closed gaps are unknowns like the
//! acceleration of the table: a closed gap keeps its width, and in an open gap there is no force. Friction in a closed gap
//! is `q = σ μ_b λ` with the direction `σ` in which both balls roll. In a gap between two balls that stick to the ring the
//! force is not determined; the equations then contain none, and [`super::held()`] decides whether the balls stick.

use std::any::{Any, TypeId};

use super::recorded_balancer::DrivenDisc;
use super::system::pass_on;
use super::{
    Balancer, BallContact, ContactMode, Friction, Gap, LASTING_APPROACH, Machine, Recorder,
    RestForms, Structure, System, SystemEquations, Touching, wrap_to_two_pi,
};

/// A balancer with contact between neighbouring balls.
#[derive(Clone, Debug)]
pub struct BallsInContact<const N: usize> {
    /// The balancer.
    pub balancer: Balancer<N>,
    restitution: f64,
    /// The speed of approach below which contact lasts.
    pub lasting_approach: f64,
    gaps: Vec<Gap>,
}

impl<const N: usize> BallsInContact<N> {
    /// Returns the non-dimensional form of a machine with exactly `N` balls whose order along the ring is that of these
    /// angles; `None` for another number.
    pub fn new(machine: &Machine, contact: &BallContact, angles: &[f64]) -> Option<Self> {
        let balancer = Balancer::new(machine)?;
        let mut order: Vec<usize> = (0..N).collect();
        let place = |ball: &usize| wrap_to_two_pi(angles[*ball]);
        order.sort_by(|left, right| place(left).total_cmp(&place(right)));
        // The first ball of the list does not matter: the gaps are those of a circle.
        let first = order.iter().position(|ball| *ball == 0)?;
        order.rotate_left(first);
        let gap = |place: usize| {
            let contacts = [order[place], order[(place + 1) % N]];
            let [behind, ahead] = contacts.map(|ball| &machine.balls[ball]);
            let angle = machine.contact_angle_rad(behind, ahead);
            let masses = contacts.map(|ball| balancer.balls[ball].mass);
            Gap::between_balls(contacts, angle, masses, contact.friction_coefficient)
        };
        let gaps = (0..if N > 1 { N } else { 0 }).map(gap).collect();
        Some(BallsInContact {
            balancer,
            restitution: contact.restitution,
            lasting_approach: LASTING_APPROACH,
            gaps,
        })
    }
}

impl<const N: usize> DrivenDisc<N> for BallsInContact<N> {
    fn balancer(&self) -> &Balancer<N> {
        &self.balancer
    }

    fn gaps(&self) -> &[Gap] {
        &self.gaps
    }
}

impl<const N: usize> System for BallsInContact<N> {
    fn record<'r>(&self, recorder: &'r Recorder) -> SystemEquations<'r> {
        self.record_turning(recorder, || None)
    }

    fn inputs(&self, modes: &[ContactMode]) -> Vec<f64> {
        self.inputs_turning(modes, false)
    }

    fn structure(&self) -> Option<Structure> {
        let (_, laws, runout) = self.balancer.structure()?;
        let order = self.gaps.iter().flat_map(|gap| gap.contacts);
        Some((TypeId::of::<Self>(), laws, order.chain(runout).collect()))
    }

    fn contacts(&self) -> usize {
        N
    }

    pass_on! { balancer:
        fn friction(contact: usize) -> &Friction;
        fn longest_step() -> f64;
        fn fastest_rate() -> f64;
        fn fewest_steps() -> f64;
        fn surely_one_solution() -> bool;
        fn force_scale() -> f64;
        fn jump_of_balls(state: &mut [f64], jump: [f64; 2]) -> u32;
    }

    fn one_solution_at(&self, state: &[f64]) -> bool {
        System::one_solution_at(&self.balancer, state)
    }

    fn rest_forms(&self) -> Option<&dyn RestForms> {
        Some(self)
    }

    fn touching(&self) -> Option<&dyn Touching> {
        Some(self)
    }

    fn while_apart(&self) -> &dyn Any {
        &self.balancer
    }

    fn as_any(&self) -> &dyn Any {
        self
    }
}

impl<const N: usize> Touching for BallsInContact<N> {
    fn gaps(&self) -> &[Gap] {
        &self.gaps
    }

    fn restitution(&self) -> f64 {
        self.restitution
    }

    fn lasting_approach(&self) -> f64 {
        self.lasting_approach
    }
}
