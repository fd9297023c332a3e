//! Coulomb friction: one coefficient for rest and motion.

use smallvec::smallvec;

use super::{FrictionLaw, Law, LawInputs, LawNumbers, Sliding, SlidingForce, about};
use crate::model::{Expression, Number};

/// In slip `μ f_n`, in stick at most that.
pub(super) struct Coulomb;

impl FrictionLaw {
    /// Coulomb friction.
    pub const COULOMB: Self = FrictionLaw::new(&Coulomb, &[]);
}

impl Law for Coulomb {
    about! {
        "coulomb",
        "Coulomb friction: the friction force is at most `friction_coefficient` times the normal force."
    }

    fn force(&self, friction: &LawNumbers<'_>, sliding: Sliding) -> SlidingForce {
        SlidingForce { ratio: sliding.direction * friction.coefficient, drag: 0.0 }
    }

    fn expression_inputs(&self, friction: &LawNumbers<'_>) -> LawInputs {
        smallvec![friction.coefficient]
    }

    fn expression<'r>(
        &self,
        inputs: &[Expression<'r>],
        direction: Expression<'r>,
        _speed: Expression<'r>,
    ) -> [Expression<'r>; 2] {
        [direction * inputs[0], Expression::constant(0.0)]
    }

    fn slope(&self, _friction: &LawNumbers<'_>, _sliding: Sliding) -> SlidingForce {
        SlidingForce::default()
    }
}
