//! The equations of a system, with the expressions that the system records.

use super::{Expression, NodeId};

/// The equations of a system, with expressions.
#[derive(Default)]
pub struct SystemEquations<'r> {
    /// The time derivative of each component of the state.
    pub derivative: Vec<Expression<'r>>,
    /// The contacts.
    pub contacts: Vec<ContactEquations<'r>>,
    /// The events that reset the state. Of several at one instant, the first in this order comes first.
    pub events: Vec<EventEquations<'r>>,
    /// The gaps between contacts.
    pub gaps: Vec<GapEquations<'r>>,
    /// The contacts that open and close.
    pub openings: Vec<OpeningEquations<'r>>,
    /// The meaning of the components.
    pub layout: StateLayout,
}

/// The meaning of the components of a state.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StateLayout {
    /// The contacts, in their order.
    pub contacts: Vec<ContactLayout>,
    /// The components that are velocities, which determine the length of a step. Of each group, the largest counts.
    pub velocities: Vec<Vec<usize>>,
    /// The components that are the displacement whose amplitude is measured, if the system has such a displacement;
    /// otherwise the positions of the contacts are measured.
    pub vibration: Option<[usize; 2]>,
    /// The component in which the equations are periodic, if the system is forced periodically.
    pub forcing: Option<ForcingLayout>,
    /// The coordinates without contact that are angles with a period of one turn.
    pub angles: Vec<usize>,
}

/// The time, or the phase of a periodic force.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ForcingLayout {
    /// The component of the state, which grows at a constant rate.
    pub component: usize,
    /// When the component has grown by this value, the equations are the same as before.
    pub period: f64,
}

/// The coordinate of a contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactLayout {
    /// The component that is its position.
    pub position: usize,
    /// Whether the position is an angle, with a period of one turn.
    pub angular: bool,
}

/// What the mode of a contact is decided by.
#[derive(Clone, Copy)]
pub struct ContactEquations<'r> {
    /// The sliding speed.
    pub sliding_speed: Expression<'r>,
    /// The sliding acceleration.
    pub sliding_acceleration: Expression<'r>,
    /// The normal force, compression positive.
    pub normal: Expression<'r>,
    /// The friction force; in stick, the force required to stick.
    pub friction: Expression<'r>,
}

/// What the mode of a gap is decided by.
#[derive(Clone, Copy)]
pub struct GapEquations<'r> {
    /// The second time derivative of its width.
    pub opening_acceleration: Expression<'r>,
    /// The force in it, compression positive; 0 while it is open. It is an unknown of [`super::Recorder::accelerations`], like the
    /// accelerations of contacts that move; impacts follow from its column.
    pub force: Expression<'r>,
}

/// What the opening and the closing of a contact are decided by, as expressions or by their nodes. While the contact is apart, the
/// `normal` of its [`ContactEquations`] is the gap.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Opening<T = NodeId> {
    /// The contact, counted from 0.
    pub contact: usize,
    /// The distance of the bodies, which depends on positions and time.
    pub gap: T,
    /// The rate of change of the gap.
    pub speed: T,
    /// The second time derivative of the gap.
    pub acceleration: T,
    /// The normal force: an unknown of the linear system of the accelerations, as is the friction force unless it is 0. Impacts
    /// follow from their columns.
    pub force: T,
    /// The friction force in these equations; contacts that share a load show other forces.
    pub friction: T,
}

/// An opening in the equations of a system.
pub type OpeningEquations<'r> = Opening<Expression<'r>>;

/// An event that resets the state, such as an impact or a kick, as expressions or by their nodes.
#[derive(Clone, Debug, PartialEq)]
pub struct Event<T = NodeId> {
    /// The event happens where this function of the state falls through zero. The reset must make it positive, or zero
    /// and rising.
    pub guard: T,
    /// The components that the event changes, with their values after it as functions of the state before it.
    pub reset: Vec<(usize, T)>,
}

/// An event in the equations of a system.
pub type EventEquations<'r> = Event<Expression<'r>>;
