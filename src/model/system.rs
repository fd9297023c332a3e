//! The interface of a mechanical system with dry friction, without dimensions.

use std::any::Any;
use std::fmt::Debug;
use std::sync::Arc;

use super::{
    Components, ContactMode, Friction, Gap, Graph, PerStructure, Recorder, Structure,
    SystemEquations,
};

/// A mechanical system. Its recorded equations define the motion, its tangents, forces and events.
pub trait System: Any + Debug + Send + Sync {
    /// Records the equations. Systems whose equations are equal expressions share lanes, with other inputs.
    fn record<'r>(&self, recorder: &'r Recorder) -> SystemEquations<'r>;

    /// Returns the values of the inputs, in their order, for modes of all contacts, and after these of all gaps.
    fn inputs(&self, modes: &[ContactMode]) -> Vec<f64>;

    /// Returns a key that only systems with equal equations share, so that these are recorded once; `None` if each
    /// system must be recorded.
    fn structure(&self) -> Option<Structure> {
        None
    }

    /// Returns the number of contacts.
    fn contacts(&self) -> usize;

    /// Returns the friction of a contact, counted from 0.
    fn friction(&self, contact: usize) -> &Friction;

    /// Returns the longest step within which a friction force cannot rise and fall undetected.
    fn longest_step(&self) -> f64;

    /// Returns the rate at which the motion may change, over the natural frequency; the number of
    /// steps of a well-behaved motion is proportional to it.
    fn fastest_rate(&self) -> f64;

    /// Returns the smallest number of steps per unit of time.
    fn fewest_steps(&self) -> f64 {
        1.0 / self.longest_step()
    }

    /// Returns whether a test of negligible cost proves that stick and slip are decided in exactly
    /// one way in every state.
    fn surely_one_solution(&self) -> bool;

    /// Returns whether stick and slip are decided in exactly one way in this state, for any forces.
    fn one_solution_at(&self, state: &[f64]) -> bool;

    /// Returns the size of the forces, to which rounding errors are relative.
    fn force_scale(&self) -> f64;

    /// Returns the smallest pivot of the mass matrix over the entry on its diagonal: from 0 to 1, or at most 0 if some motion has
    /// no kinetic energy, which is no mechanical system.
    fn smallest_inertia(&self, _state: &[f64]) -> f64 {
        1.0
    }

    /// Returns the closed forms with all contacts at rest, if there are any.
    fn rest_forms(&self) -> Option<&dyn RestForms> {
        None
    }

    /// Changes a state by a jump of the velocity of the table, which the balls follow. Returns the number of balls that the
    /// blow lifts off their support.
    fn jump_of_balls(&self, _state: &mut [f64], _jump: [f64; 2]) -> u32 {
        0
    }

    /// Returns the gaps between its contacts, if there are any.
    fn touching(&self) -> Option<&dyn Touching> {
        None
    }

    /// Returns the values of the outputs in a state, in the order of [`super::Units::outputs`].
    fn outputs(&self, _state: &[f64]) -> Components {
        Components::new()
    }

    /// Returns the value of one of the outputs, the same as in [`System::outputs`], from the components of the state that
    /// it needs; `None` if only [`System::outputs`] returns it.
    fn output(&self, _number: usize, _state: &dyn Fn(usize) -> f64) -> Option<f64> {
        None
    }

    /// Returns how the bodies of a contact that opens separate after an impact.
    fn impact_law(&self, _contact: usize) -> ImpactLaw {
        ImpactLaw::default()
    }

    /// Returns the system that has the same motion while no contacts touch, for kernels that are written for one type.
    fn while_apart(&self) -> &dyn Any {
        self.as_any()
    }

    /// Returns this system, for kernels that are written for one type.
    fn as_any(&self) -> &dyn Any;
}

impl Graph {
    /// Returns the recorded equations of a system.
    pub fn of(system: &dyn System) -> Arc<Self> {
        static RECORDED: PerStructure<Graph> = PerStructure::new();
        RECORDED.get(system.structure(), || {
            let recorder = Recorder::default();
            recorder.finish(&system.record(&recorder))
        })
    }
}

/// A system with gaps between its contacts that can close.
pub trait Touching {
    /// Returns the gaps, in the order of the recorded ones.
    fn gaps(&self) -> &[Gap];

    /// Returns the speed of separation over the speed of approach in an impact, 0 to 1.
    fn restitution(&self) -> f64;

    /// Returns the speed of approach, non-dimensional, below which contact lasts unless impacts lose no energy: infinitely
    /// many impacts would follow within a time that is proportional to the speed.
    fn lasting_approach(&self) -> f64;
}

/// What is known of a system with all contacts sticking, for states of the system.
pub trait RestForms {
    /// Returns whether no contact can ever break loose, by a bound of negligible cost.
    fn surely_rests(&self, state: &[f64]) -> bool;

    /// Returns whether no contact can ever break loose, by following the motion. `false` means that a
    /// contact breaks loose or that the margin is too small for a decision.
    fn rests(&self, state: &[f64]) -> bool {
        self.surely_rests(state)
    }

    /// Returns whether the forms are closed: they hold for any distance from the rest point.
    fn are_closed(&self) -> bool {
        true
    }

    /// Returns amplitude and friction margin at the rest point.
    fn at_rest(&self, state: &[f64]) -> RestAmplitude;

    /// Returns the rest point that belongs to a state; `None` if the forms do not know it.
    fn rest_state(&self, _state: &[f64]) -> Option<Components> {
        None
    }

    /// Returns the contact that the largest force `λ` in a gap acts on at the rest point, and this force over the contact's
    /// mass; `None` if no contacts touch. Of several forces that hold the contacts, the smallest count.
    fn contact_force(&self, _state: &[f64]) -> Option<(usize, f64)> {
        None
    }

    /// Returns whether the friction forces at the rest point and on the way there exceed their limits by at most this
    /// fraction of the limits.
    fn nearly_rests(&self, state: &[f64], excess: f64) -> bool;
}

/// A system at rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RestAmplitude {
    /// The amplitude of the vibration, over the unit of length.
    pub amplitude: f64,
    /// The smallest friction margin of a contact: 1 if none needs friction, 0 on the edge of the equilibrium set;
    /// infinite without friction.
    pub friction_margin: f64,
}

/// Returns the contribution of friction with this damping rate to the pace: the number of steps per
/// unit of time of an explicit method is about a sixth of the rate, far below the effort limit of
/// this pace. Above a rate of 1e5 a run is too stiff to compute.
pub fn stiff_rate(damping_rate: f64) -> f64 {
    1e-3 * damping_rate.min(1e5)
}

/// Passes methods of a system on to one of its fields.
macro_rules! pass_on {
    ($to:tt: $(fn $name:ident($($argument:ident: $of:ty),*) -> $result:ty;)*) => {
        $(fn $name(&self, $($argument: $of),*) -> $result { self.$to.$name($($argument),*) })*
    };
}
pub(super) use pass_on;

/// A system that hides its type: the general kernel computes it from its recorded equations.
#[derive(Clone, Debug)]
pub struct Recorded(pub Arc<dyn System>);

impl System for Recorded {
    fn record<'r>(&self, recorder: &'r Recorder) -> SystemEquations<'r> {
        self.0.record(recorder)
    }

    pass_on! { 0:
        fn inputs(modes: &[ContactMode]) -> Vec<f64>;
        fn structure() -> Option<Structure>;
        fn contacts() -> usize;
        fn friction(contact: usize) -> &Friction;
        fn longest_step() -> f64;
        fn fastest_rate() -> f64;
        fn fewest_steps() -> f64;
        fn surely_one_solution() -> bool;
        fn one_solution_at(state: &[f64]) -> bool;
        fn force_scale() -> f64;
        fn smallest_inertia(state: &[f64]) -> f64;
        fn rest_forms() -> Option<&dyn RestForms>;
        fn jump_of_balls(state: &mut [f64], jump: [f64; 2]) -> u32;
        fn touching() -> Option<&dyn Touching>;
        fn outputs(state: &[f64]) -> Components;
        fn output(number: usize, state: &dyn Fn(usize) -> f64) -> Option<f64>;
        fn impact_law(contact: usize) -> ImpactLaw;
    }

    fn as_any(&self) -> &dyn Any {
        self
    }
}

/// The speed of approach below which contact lasts: a ten-thousandth of a typical speed of running balls.
pub const LASTING_APPROACH: f64 = 1e-6;

/// How the bodies of a contact separate after an impact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImpactLaw {
    /// The speed of separation over the speed of approach, 0 to 1 (Newton).
    pub restitution: f64,
    /// The sliding speed after an impact without slip over that before it, with the opposite sign, 0 to 1.
    pub tangential_restitution: f64,
    /// The speed of approach, non-dimensional, below which contact lasts unless impacts lose no energy: infinitely many
    /// impacts would follow within a time that is proportional to the speed.
    pub lasting_approach: f64,
}

impl Default for ImpactLaw {
    /// The bodies stay together.
    fn default() -> Self {
        let lasting_approach = LASTING_APPROACH;
        ImpactLaw { restitution: 0.0, tangential_restitution: 0.0, lasting_approach }
    }
}
