//! The contacts of a mechanism: as its author gives them, and their rows in the linear system of the accelerations.

use super::{Contact, Expression, Friction, Number};

/// A contact of a mechanism.
pub struct MechanismContact<'r> {
    /// The coordinate that results show as the position of the contact, and whether it is an angle.
    pub position: (Expression<'r>, bool),
    /// The sliding speed; the number 0 for a contact without friction.
    pub sliding_speed: Expression<'r>,
    /// The force that presses the bodies together.
    pub normal: MechanismNormal<'r>,
    /// Its law of friction.
    pub friction: Friction,
    /// The unit of its forces over that of the mechanism: 1, or the size of the inertia that slides if this is far below 1.
    /// Conditions on forces have a tolerance that is small against 1. A contact that opens has the unit 1.
    pub force_unit: f64,
}

/// The normal force of a contact of a mechanism.
#[derive(Clone)]
pub enum MechanismNormal<'r> {
    /// It is given, and part of the forces of the mechanism.
    Given(Expression<'r>),
    /// It is the reaction of a guide: the first number, and for each coordinate a factor of its acceleration.
    Reaction(Expression<'r>, Vec<Expression<'r>>),
    /// It keeps this gap from becoming negative.
    Gap(Expression<'r>),
}

impl<'r> MechanismContact<'r> {
    /// Returns the normal force in the unit of the contact's forces.
    pub(super) fn normal(&self) -> MechanismNormal<'r> {
        let in_unit = |force: &Expression<'r>| Expression::constant(1.0 / self.force_unit) * *force;
        match &self.normal {
            MechanismNormal::Given(force) => MechanismNormal::Given(in_unit(force)),
            MechanismNormal::Reaction(rest, factors) => {
                MechanismNormal::Reaction(in_unit(rest), factors.iter().map(in_unit).collect())
            }
            MechanismNormal::Gap(gap) => MechanismNormal::Gap(*gap),
        }
    }
}

/// The equations of a contact for the linear system.
pub(super) struct ContactRows<'r> {
    /// The derivatives of the rate of the gap by the velocities, and the part of its second time derivative without accelerations.
    pub(super) normal: Option<(Vec<Expression<'r>>, Expression<'r>)>,
    /// The derivatives of the sliding speed by the velocities, and the part of its time derivative without accelerations.
    pub(super) tangential: (Vec<Expression<'r>>, Expression<'r>),
    pub(super) gap: [Expression<'r>; 2],
    pub(super) closed: Expression<'r>,
    pub(super) contact: Contact<Expression<'r>>,
    /// The static coefficient of friction.
    pub(super) limit: Expression<'r>,
}

impl<'r> ContactRows<'r> {
    /// Returns the velocity that alone determines the sliding speed, and its constant factor: `x'` and 1 for `x' - v_belt`.
    pub(super) fn only_velocity(&self) -> Option<(usize, Expression<'r>)> {
        let (along, drift) = &self.tangential;
        let mut moving = along.iter().enumerate().filter(|(_, share)| share.known() != Some(0.0));
        let (place, factor) = moving.next()?;
        (moving.next().is_none() && drift.known() == Some(0.0)).then_some((place, *factor))
    }
}
