//! What a friction law defines: its force, and its parameters with their names, dimensions and lowest values.

use std::fmt;

use smallvec::SmallVec;

use crate::model::Expression;

/// The numbers of a law's recorded expression.
pub type LawInputs = SmallVec<[f64; 4]>;

/// A friction law: the force as a function of sliding speed and normal force, and its parameters.
///
/// The friction of a contact is `ratio(v) f_n + drag(v)`, with the normal force `f_n`.
pub trait Law: Sync {
    /// The name in a study file.
    fn name(&self) -> &'static str;

    /// What the law is, for the documentation: a sentence or two.
    fn meaning(&self) -> &'static str;

    /// The parameters, at most [`super::MAX_LAW_PARAMETERS`].
    fn parameters(&self) -> &'static [LawParameter] {
        &[]
    }

    /// Whether the force depends on the contact's friction coefficient.
    fn uses_friction_coefficient(&self) -> bool {
        true
    }

    /// Whether bodies can stick: whether the force at rest can take any value in an interval.
    fn can_stick(&self) -> bool {
        true
    }

    /// The largest ratio of friction to normal force in stick, for a (kinetic) coefficient; 0 if bodies
    /// cannot stick.
    fn static_ratio(&self, coefficient: f64, _values: &[f64]) -> f64 {
        if self.can_stick() { coefficient } else { 0.0 }
    }

    /// Whether the force in slip is a fixed part of the normal force and a drag in proportion to speed.
    fn is_linear(&self, _coefficient: f64, _values: &[f64]) -> bool {
        true
    }

    /// The force in slip.
    fn force(&self, friction: &LawNumbers<'_>, sliding: Sliding) -> SlidingForce;

    /// The derivative of the force by the speed.
    fn slope(&self, friction: &LawNumbers<'_>, sliding: Sliding) -> SlidingForce;

    /// The numbers that [`Law::expression`] takes, such as an inverse speed.
    fn expression_inputs(&self, friction: &LawNumbers<'_>) -> LawInputs;

    /// The force in slip in a direction, as ratio to the normal force and drag, in a recorded system. `inputs` are those
    /// of [`Law::expression_inputs`]. The speed has the direction of the motion, or is negligible.
    fn expression<'r>(
        &self,
        inputs: &[Expression<'r>],
        direction: Expression<'r>,
        speed: Expression<'r>,
    ) -> [Expression<'r>; 2];

    /// The largest damping rate of a contact of mass 1 under this normal force by friction that grows
    /// with speed: a measure of the stiffness of the equations of motion.
    fn damping_rate(&self, _friction: &LawNumbers<'_>, _normal: f64) -> f64 {
        0.0
    }
}

/// What a law is: its name and meaning, and the parameters and properties that differ from the default of [`Law`].
macro_rules! about {
    ($name:literal, $meaning:literal $(, $parameters:expr)? $(; $property:ident: $value:literal)*) => {
        fn name(&self) -> &'static str { $name }
        fn meaning(&self) -> &'static str { $meaning }
        $(fn parameters(&self) -> &'static [LawParameter] { &$parameters })?
        $(fn $property(&self) -> bool { $value })*
    };
}
pub(super) use about;

impl PartialEq for dyn Law {
    fn eq(&self, other: &Self) -> bool {
        self.name() == other.name()
    }
}

impl fmt::Debug for dyn Law {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(self.name())
    }
}

/// The numbers of the friction of a contact, without dimensions.
#[derive(Clone, Copy, Debug)]
pub struct LawNumbers<'a> {
    /// Ratio of friction to normal force in fast slip, `μ`; 0 without dry friction.
    pub coefficient: f64,
    /// Largest ratio of friction to normal force in stick, `μ_s`; 0 if the contact cannot stick.
    pub limit: f64,
    /// The parameters of the law, in the order of [`Law::parameters`].
    pub values: &'a [f64],
}

/// How a contact slides.
#[derive(Clone, Copy, Debug)]
pub struct Sliding {
    /// The direction of the motion, or of the motion that is about to begin: 1 or -1. A law that cannot stick ignores it.
    pub direction: f64,
    /// The speed, with sign. Inside the band of the switch model, a speed against the direction is rounding or rest.
    pub speed: f64,
}

/// The friction force in slip: `ratio` times the normal force plus `drag`. Both act against the positive direction.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SlidingForce {
    /// Ratio to the normal force, with sign.
    pub ratio: f64,
    /// Force that does not depend on the normal force, with sign.
    pub drag: f64,
}

/// The largest number of parameters of a law.
pub const MAX_LAW_PARAMETERS: usize = 4;

/// A parameter of a friction law.
#[derive(Clone, Copy, Debug)]
pub struct LawParameter {
    /// Name in a study file where it does not depend on the unit of sliding speeds.
    pub name: &'static str,
    /// Its dimension.
    pub dimension: LawDimension,
    /// Its lowest value.
    pub lowest: Lowest,
    /// Its meaning, in a few words.
    pub meaning: &'static str,
    /// What a special value means, as the rest of a sentence; empty if there is none.
    pub note: &'static str,
    /// Values of an example for balls and for blocks.
    pub examples: [f64; 2],
}

/// The dimension of a law's parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LawDimension {
    /// Dimensionless.
    Ratio,
    /// A sliding speed, whose name has its unit.
    SlidingSpeed {
        /// Name in rad/s, for balls.
        rad_s: &'static str,
        /// Name in m/s, for blocks.
        m_s: &'static str,
    },
    /// A force over a speed, N s/m.
    Drag,
}

/// The lowest value of a law's parameter; all values are finite.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lowest {
    /// Zero or more.
    Zero,
    /// More than zero.
    AboveZero,
    /// The (kinetic) friction coefficient or more.
    FrictionCoefficient,
}

/// The unit of the sliding speeds of a model.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum SlidingSpeed {
    /// rad/s, of balls relative to the ring.
    RadS,
    /// m/s.
    MS,
}

impl LawParameter {
    /// Returns the name in a study file.
    pub fn name(&self, speed: SlidingSpeed) -> &'static str {
        match (self.dimension, speed) {
            (LawDimension::SlidingSpeed { rad_s, .. }, SlidingSpeed::RadS) => rad_s,
            (LawDimension::SlidingSpeed { m_s, .. }, SlidingSpeed::MS) => m_s,
            _ => self.name,
        }
    }

    /// Returns the names for both units of sliding speeds.
    pub fn names(&self) -> [&'static str; 2] {
        [SlidingSpeed::RadS, SlidingSpeed::MS].map(|speed| self.name(speed))
    }

    /// Returns the unit; `1` for dimensionless numbers.
    pub fn unit(&self, speed: SlidingSpeed) -> &'static str {
        match (self.dimension, speed) {
            (LawDimension::Ratio, _) => "1",
            (LawDimension::Drag, _) => "N s/m",
            (LawDimension::SlidingSpeed { .. }, SlidingSpeed::RadS) => "rad/s",
            (LawDimension::SlidingSpeed { .. }, SlidingSpeed::MS) => "m/s",
        }
    }
}
