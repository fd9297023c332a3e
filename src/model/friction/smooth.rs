//! Smooth friction, which cannot stick (thesis section 3.3.1, the earlier work).

use std::f64::consts::FRAC_2_PI;

use smallvec::smallvec;

use super::{
    FrictionLaw, Law, LawDimension, LawInputs, LawNumbers, LawParameter, Lowest, Sliding,
    SlidingForce, about,
};
use crate::model::{Expression, Number};

/// `μ f_n (2/π) atan(v / v_0)`: without a force at rest, so that nothing ever sticks.
pub(super) struct Smooth;

impl FrictionLaw {
    /// Smooth friction with the speed `v_0`, positive, at which half of the limit is reached.
    pub const fn smooth(smoothing_speed: f64) -> Self {
        FrictionLaw::new(&Smooth, &[smoothing_speed])
    }
}

/// `v_0`.
fn scale(friction: &LawNumbers<'_>) -> f64 {
    friction.values.first().copied().unwrap_or(1.0)
}

/// The speed `v_0`.
const PARAMETERS: [LawParameter; 1] = [LawParameter {
    name: "smoothing_speed",
    dimension: LawDimension::SlidingSpeed {
        rad_s: "smoothing_speed_rad_s",
        m_s: "smoothing_speed_m_s",
    },
    lowest: Lowest::AboveZero,
    meaning: "speed at which friction reaches half of its limit",
    note: "",
    examples: [0.1, 1.0e-3],
}];

impl Law for Smooth {
    about! {
        "smooth",
        "Regularised friction `μ f_n (2/π) atan(v / v_0)`, which is zero at rest: no contact ever sticks.",
        PARAMETERS; can_stick: false
    }

    fn is_linear(&self, _coefficient: f64, _values: &[f64]) -> bool {
        false
    }

    fn force(&self, friction: &LawNumbers<'_>, sliding: Sliding) -> SlidingForce {
        let share = libm::atan(sliding.speed / scale(friction)) * FRAC_2_PI;
        SlidingForce { ratio: friction.coefficient * share, drag: 0.0 }
    }

    fn slope(&self, friction: &LawNumbers<'_>, sliding: Sliding) -> SlidingForce {
        let scale = scale(friction);
        let ratio = sliding.speed / scale;
        let bend = FRAC_2_PI / (scale * (1.0 + ratio * ratio));
        SlidingForce { ratio: friction.coefficient * bend, drag: 0.0 }
    }

    fn expression_inputs(&self, friction: &LawNumbers<'_>) -> LawInputs {
        smallvec![friction.coefficient * FRAC_2_PI, 1.0 / scale(friction)]
    }

    fn expression<'r>(
        &self,
        inputs: &[Expression<'r>],
        _direction: Expression<'r>,
        speed: Expression<'r>,
    ) -> [Expression<'r>; 2] {
        [inputs[0] * (speed * inputs[1]).atan(), Expression::constant(0.0)]
    }

    fn damping_rate(&self, friction: &LawNumbers<'_>, normal: f64) -> f64 {
        friction.coefficient * normal * FRAC_2_PI / scale(friction)
    }
}
