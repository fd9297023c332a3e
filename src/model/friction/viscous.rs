//! Viscous drag without dry friction (thesis section 5.1).

use smallvec::smallvec;

use super::{
    FrictionLaw, Law, LawDimension, LawInputs, LawNumbers, LawParameter, Lowest, Sliding,
    SlidingForce, about,
};
use crate::model::{Expression, Number};

/// A drag in proportion to speed and independent of the normal force.
pub(super) struct Viscous;

impl FrictionLaw {
    /// Viscous drag: force over sliding speed (of the ball's centre along the ring, or of the block), N s/m.
    pub const fn viscous(viscous_coefficient_n_s_m: f64) -> Self {
        FrictionLaw::new(&Viscous, &[viscous_coefficient_n_s_m])
    }
}

/// The viscous coefficient.
pub(super) const PARAMETERS: [LawParameter; 1] = [LawParameter {
    name: "viscous_coefficient_n_s_m",
    dimension: LawDimension::Drag,
    lowest: Lowest::Zero,
    meaning: "viscous drag force divided by sliding speed",
    note: "",
    examples: [1.0e-4, 1.0e-4],
}];

/// Returns drag over speed, the first parameter of a law.
pub(super) fn drag(friction: &LawNumbers<'_>) -> f64 {
    friction.values.first().copied().unwrap_or(0.0)
}

impl Law for Viscous {
    about! {
        "viscous",
        "Viscous drag proportional to the sliding speed, without dry friction.",
        PARAMETERS; uses_friction_coefficient: false; can_stick: false
    }

    fn force(&self, friction: &LawNumbers<'_>, sliding: Sliding) -> SlidingForce {
        SlidingForce { ratio: 0.0, drag: drag(friction) * sliding.speed }
    }

    fn slope(&self, friction: &LawNumbers<'_>, _sliding: Sliding) -> SlidingForce {
        SlidingForce { ratio: 0.0, drag: drag(friction) }
    }

    fn expression_inputs(&self, friction: &LawNumbers<'_>) -> LawInputs {
        smallvec![drag(friction)]
    }

    fn expression<'r>(
        &self,
        inputs: &[Expression<'r>],
        _direction: Expression<'r>,
        speed: Expression<'r>,
    ) -> [Expression<'r>; 2] {
        [Expression::constant(0.0), inputs[0] * speed]
    }

    fn damping_rate(&self, friction: &LawNumbers<'_>, _normal: f64) -> f64 {
        drag(friction)
    }
}
