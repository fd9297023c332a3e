//! The balancer whose balls cannot pass through each other.
//!
//! While no balls touch, the equations are those of [`Balancer`]. The forces `λ` in closed gaps are unknowns like the
//! acceleration of the table: a closed gap keeps its width, and in an open gap there is no force. Friction in a closed gap
//! is `q = σ μ_b λ` with the direction `σ` in which both balls roll. In a gap between two balls that stick to the ring the
//! force is not determined; the equations then contain none, and [`super::held()`] decides whether the balls stick.

use std::any::{Any, TypeId};

use smallvec::SmallVec;

use super::contact_mode::record_contact;
use super::recorded_balancer::{RecordedGap, equations, record_state};
use super::system::{DiscSpeed, DrivenDisc, pass_on};
use super::{
    Balancer, BallContact, ContactMode, Expression, Friction, Gap, GapEquations, LASTING_APPROACH,
    Machine, Recorder, RestForms, Structure, System, SystemEquations, Touching, pushes,
    wrap_to_two_pi,
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

    /// Returns the gaps between neighbouring balls.
    pub(super) fn gaps(&self) -> &[Gap] {
        &self.gaps
    }
}

impl<const N: usize> DrivenDisc for BallsInContact<N> {
    fn record_turning<'r>(
        &self,
        recorder: &'r Recorder,
        turning: impl FnOnce() -> Option<DiscSpeed<'r>>,
    ) -> SystemEquations<'r> {
        let state = record_state(recorder);
        let balancer = self.balancer.record_parameters(recorder, turning());
        let contacts = std::array::from_fn(|i| {
            record_contact(recorder, &self.balancer.balls[i].friction, state.beta_dot[i])
        });
        let closed: Vec<_> = self.gaps.iter().map(|_| recorder.input("closed")).collect();
        // Tangential and normal force on the ball behind and on the ball ahead.
        let pushes: Vec<[[Expression<'r>; 2]; 2]> = self
            .gaps
            .iter()
            .map(|_| [(); 2].map(|()| [(); 2].map(|()| recorder.input("push"))))
            .collect();
        let parts = self.gaps.iter().zip(closed).zip(pushes);
        let gaps: Vec<_> = parts
            .map(|((gap, closed), pushes)| RecordedGap { contacts: gap.contacts, closed, pushes })
            .collect();
        let (forces, gap_forces) = balancer.record_forces(recorder, &state, &contacts, &gaps);
        let derivative = balancer.derivative(&state, &contacts, &forces);
        let gaps = self.gaps.iter().zip(&gap_forces).map(|(gap, force)| {
            let [behind, ahead] = gap.contacts;
            GapEquations {
                opening_acceleration: forces.beta_ddot[ahead] - forces.beta_ddot[behind],
                force: *force,
            }
        });
        let gaps = gaps.collect();
        SystemEquations { gaps, ..equations(&state, &derivative, &forces, true) }
    }

    fn inputs_turning(&self, modes: &[ContactMode], turning: bool) -> Vec<f64> {
        let mut inputs = self.balancer.inputs_turning(modes, turning);
        let pushes: SmallVec<[_; 8]> = pushes(&self.gaps, modes).collect();
        inputs.extend(pushes.iter().map(|pushes| if pushes.is_some() { 1.0 } else { 0.0 }));
        // Without a force, the pushes do not matter.
        for (gap, pushes) in self.gaps.iter().zip(&pushes) {
            inputs.extend(pushes.unwrap_or_else(|| gap.rolling_pushes(0.0)).as_flattened());
        }
        inputs
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
