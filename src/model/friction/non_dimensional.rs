//! Friction of one contact without dimensions, as the motion uses it, and what it does in the equations of motion.

use super::{FrictionLaw, LawDimension, LawInputs, LawNumbers, Sliding, SlidingForce};
use crate::model::{Dual, Expression, Number, Recorder};

/// Non-dimensional friction of one contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Friction {
    /// Ratio of friction to normal force in fast slip, `μ`; 0 without dry friction.
    pub coefficient: f64,
    /// Largest ratio of friction to normal force in stick, `μ_s`; 0 if the contact cannot stick.
    pub limit: f64,
    /// The law with its non-dimensional parameters.
    law: FrictionLaw,
}

impl Friction {
    /// The friction of a contact with this (kinetic) coefficient; the parameters of the law are non-dimensional.
    pub(super) fn new(law: FrictionLaw, coefficient: f64) -> Self {
        let dry = law.law().uses_friction_coefficient();
        let limit = law.law().static_ratio(coefficient, law.values());
        Friction { coefficient: if dry { coefficient } else { 0.0 }, limit, law }
    }

    /// Coulomb friction.
    pub fn coulomb(coefficient: f64) -> Self {
        Friction::new(FrictionLaw::COULOMB, coefficient)
    }

    /// The law's parameters, non-dimensional, in their order.
    pub fn values(&self) -> &[f64] {
        self.law.values()
    }

    #[inline]
    fn numbers(&self) -> LawNumbers<'_> {
        LawNumbers { coefficient: self.coefficient, limit: self.limit, values: &self.law.values }
    }

    /// Returns the largest ratio of friction to normal force, at rest or at any speed.
    #[inline]
    pub fn largest_ratio(&self) -> f64 {
        self.limit.max(self.coefficient)
    }

    /// The name of the law.
    pub fn law_name(&self) -> &'static str {
        self.law.name()
    }

    /// Whether the force in slip is a fixed part of the normal force and a drag in proportion to speed.
    pub fn is_linear(&self) -> bool {
        self.law.is_linear(self.coefficient)
    }

    /// Whether the contact can stick.
    pub fn can_stick(&self) -> bool {
        self.law.can_stick()
    }

    /// Returns the largest damping rate by friction that grows with speed, non-dimensional, for a
    /// contact of mass 1 under this normal force: a measure of the stiffness of the equations of
    /// motion.
    pub fn damping_rate(&self, normal: f64) -> f64 {
        self.law.law().damping_rate(&self.numbers(), normal)
    }

    /// Returns the friction of a contact that moves, or is about to move, in a direction (1 or -1)
    /// at a speed. A law that cannot stick ignores the direction.
    #[inline]
    pub fn slip(&self, direction: f64, speed: f64) -> Contact {
        let SlidingForce { ratio, drag } =
            self.law.law().force(&self.numbers(), Sliding { direction, speed });
        Contact { free: 1.0, signed_friction: ratio, drag }
    }

    /// Returns the numbers of the law's expression in a recorded system.
    pub fn expression_inputs(&self) -> LawInputs {
        self.law.law().expression_inputs(&self.numbers())
    }

    /// Records the friction of this contact, which sticks or slips in a direction at a speed: `free` is 1 in slip and 0
    /// in stick. The law's numbers become inputs.
    pub(in crate::model) fn record<'r>(
        &self,
        recorder: &'r Recorder,
        [free, direction]: [Expression<'r>; 2],
        speed: Expression<'r>,
    ) -> Contact<Expression<'r>> {
        let name = self.law.name();
        let inputs: Vec<Expression<'r>> =
            self.expression_inputs().iter().map(|_| recorder.parameter(name)).collect();
        let [ratio, drag] = self.law.law().expression(&inputs, direction, speed);
        Contact { free, signed_friction: free * ratio, drag: free * drag }
    }

    /// Returns [`Friction::slip`] to first order in the speed.
    pub fn slip_along(&self, direction: f64, speed: Dual) -> Contact<Dual> {
        let sliding = Sliding { direction, speed: speed.value };
        let force = self.law.law().force(&self.numbers(), sliding);
        let slope = self.law.law().slope(&self.numbers(), sliding);
        let dual = |value, slope| Dual { value, slope: slope * speed.slope };
        Contact {
            free: Dual::constant(1.0),
            signed_friction: dual(force.ratio, slope.ratio),
            drag: dual(force.drag, slope.drag),
        }
    }
}

impl FrictionLaw {
    /// Returns the largest ratio of friction to normal force, at rest or at any speed, of a contact
    /// with this (kinetic) coefficient.
    pub fn largest_ratio(&self, friction_coefficient: f64) -> f64 {
        self.contact(friction_coefficient, 1.0, 1.0).largest_ratio()
    }

    /// Returns the non-dimensional friction of a contact with the (kinetic) coefficient
    /// `coefficient`, the unit of sliding speed `speed_unit` (SI) and the unit of the viscous
    /// coefficient `drag_unit` (N s/m).
    pub fn contact(&self, coefficient: f64, speed_unit: f64, drag_unit: f64) -> Friction {
        let mut values = self.values;
        for (value, parameter) in values.iter_mut().zip(self.law.parameters()) {
            *value /= match parameter.dimension {
                LawDimension::Ratio => 1.0,
                LawDimension::SlidingSpeed { .. } => speed_unit,
                LawDimension::Drag => drag_unit,
            };
        }
        Friction::new(FrictionLaw { law: self.law, values }, coefficient)
    }
}

/// The friction of one ball, as numbers instead of cases, so that runs in lockstep can differ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact<T = f64> {
    /// 1 where the ball may accelerate, 0 where it sticks.
    pub free: T,
    /// Friction force over normal force, with sign: `μ` times the direction that friction acts
    /// against; 0 where the ball sticks.
    pub signed_friction: T,
    /// Friction that does not depend on the normal force (viscous), with sign.
    pub drag: T,
}

impl Contact {
    /// A contact that sticks.
    pub const STICK: Contact = Contact { free: 0.0, signed_friction: 0.0, drag: 0.0 };

    /// Returns this contact in another arithmetic.
    #[inline]
    pub fn lifted<T: Number>(self) -> Contact<T> {
        Contact {
            free: T::constant(self.free),
            signed_friction: T::constant(self.signed_friction),
            drag: T::constant(self.drag),
        }
    }
}
