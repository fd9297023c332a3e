//! Coulomb friction and viscous drag together (H. Olsson, K. J. Åström, C. Canudas de Wit, M. Gäfvert, P. Lischinsky,
//! "Friction models and friction compensation", European Journal of Control 4 (1998) 176,
//! doi:10.1016/S0947-3580(98)70113-X, section 3).

use smallvec::smallvec;

use super::viscous::{PARAMETERS, drag};
use super::{FrictionLaw, Law, LawInputs, LawNumbers, LawParameter, Sliding, SlidingForce, about};
use crate::model::Expression;

/// In slip `μ f_n sign(v) + c v`, in stick at most `μ f_n`.
pub(super) struct CoulombViscous;

impl FrictionLaw {
    /// Coulomb friction and viscous drag: force over sliding speed (of the ball's centre along the ring, or of the
    /// block), N s/m.
    pub const fn coulomb_viscous(viscous_coefficient_n_s_m: f64) -> Self {
        FrictionLaw::new(&CoulombViscous, &[viscous_coefficient_n_s_m])
    }
}

impl Law for CoulombViscous {
    about! {
        "coulomb_viscous",
        "Coulomb friction and viscous drag together: the friction force in slip is `friction_coefficient` times the \
         normal force, plus a drag proportional to the sliding speed; at rest there is no drag.",
        PARAMETERS
    }

    fn force(
        &self,
        friction: &LawNumbers<'_>,
        Sliding { direction, speed }: Sliding,
    ) -> SlidingForce {
        SlidingForce { ratio: direction * friction.coefficient, drag: drag(friction) * speed }
    }

    fn slope(&self, friction: &LawNumbers<'_>, _sliding: Sliding) -> SlidingForce {
        SlidingForce { ratio: 0.0, drag: drag(friction) }
    }

    fn expression_inputs(&self, friction: &LawNumbers<'_>) -> LawInputs {
        smallvec![friction.coefficient, drag(friction)]
    }

    fn expression<'r>(
        &self,
        inputs: &[Expression<'r>],
        direction: Expression<'r>,
        speed: Expression<'r>,
    ) -> [Expression<'r>; 2] {
        [direction * inputs[0], inputs[1] * speed]
    }

    fn damping_rate(&self, friction: &LawNumbers<'_>, _normal: f64) -> f64 {
        drag(friction)
    }
}
