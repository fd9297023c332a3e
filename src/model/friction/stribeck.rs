//! Stribeck friction: the coefficient falls from a static to a kinetic value with speed (thesis figure 3.3).

use smallvec::smallvec;

use super::{
    FrictionLaw, Law, LawDimension, LawInputs, LawNumbers, LawParameter, Lowest, Sliding,
    SlidingForce, about,
};
use crate::model::{Expression, Number};

/// `μ(v) = μ + (μ_s - μ) e^{-|v|/v_s}`: at most `μ_s f_n` in stick, tending to `μ f_n` with growing speed.
pub(super) struct Stribeck;

impl FrictionLaw {
    /// Stribeck friction with the static coefficient `μ_s`, not below the (kinetic) friction coefficient, and the
    /// speed `v_s`, zero or more. With `v_s = 0` the coefficient drops immediately (static and kinetic friction).
    pub const fn stribeck(static_friction_coefficient: f64, stribeck_speed: f64) -> Self {
        FrictionLaw::new(&Stribeck, &[static_friction_coefficient, stribeck_speed])
    }
}

/// `μ_s` and `v_s`.
fn parameters(values: &[f64]) -> (f64, f64) {
    match *values {
        [static_coefficient, speed, ..] => (static_coefficient, speed),
        _ => (0.0, 0.0),
    }
}

/// `μ_s` and `v_s`.
const PARAMETERS: [LawParameter; 2] = [
    LawParameter {
        name: "static_friction_coefficient",
        dimension: LawDimension::Ratio,
        lowest: Lowest::FrictionCoefficient,
        meaning: "coefficient of friction at rest",
        note: "",
        examples: [4.0e-3, 0.2],
    },
    LawParameter {
        name: "stribeck_speed",
        dimension: LawDimension::SlidingSpeed {
            rad_s: "stribeck_speed_rad_s",
            m_s: "stribeck_speed_m_s",
        },
        lowest: Lowest::Zero,
        meaning: "speed over which friction falls from its static value",
        note: "0 gives a jump",
        examples: [1.0, 0.01],
    },
];

impl Law for Stribeck {
    about! {
        "stribeck",
        "Stribeck friction: the coefficient decays with the sliding speed from a static value to the kinetic \
         `friction_coefficient`, as `μ + (μ_s - μ) exp(-|v| / v_s)`.",
        PARAMETERS
    }

    fn static_ratio(&self, _coefficient: f64, values: &[f64]) -> f64 {
        parameters(values).0
    }

    fn is_linear(&self, coefficient: f64, values: &[f64]) -> bool {
        let (static_coefficient, speed) = parameters(values);
        speed == 0.0 || static_coefficient == coefficient
    }

    fn force(
        &self,
        friction: &LawNumbers<'_>,
        Sliding { direction, speed }: Sliding,
    ) -> SlidingForce {
        let (_, scale) = parameters(friction.values);
        let sliding = (direction * speed).max(0.0);
        let excess = if scale > 0.0 { libm::exp(-sliding / scale) } else { 0.0 };
        let ratio = friction.coefficient + (friction.limit - friction.coefficient) * excess;
        SlidingForce { ratio: direction * ratio, drag: 0.0 }
    }

    fn slope(&self, friction: &LawNumbers<'_>, sliding: Sliding) -> SlidingForce {
        let (_, scale) = parameters(friction.values);
        let Sliding { direction, speed } = sliding;
        let excess = self.force(friction, sliding).ratio - direction * friction.coefficient;
        let falls = scale > 0.0 && direction * speed >= 0.0;
        SlidingForce { ratio: if falls { -direction * excess / scale } else { 0.0 }, drag: 0.0 }
    }

    /// The excess `μ_s - μ` decays with the rate `1 / v_s`; both are 0 where the coefficient jumps.
    fn expression_inputs(&self, friction: &LawNumbers<'_>) -> LawInputs {
        let (_, scale) = parameters(friction.values);
        let [excess, rate] = match scale > 0.0 {
            true => [friction.limit - friction.coefficient, 1.0 / scale],
            false => [0.0; 2],
        };
        smallvec![friction.coefficient, excess, rate]
    }

    fn expression<'r>(
        &self,
        inputs: &[Expression<'r>],
        direction: Expression<'r>,
        speed: Expression<'r>,
    ) -> [Expression<'r>; 2] {
        let decay = (-(direction * inputs[2]) * speed).exp();
        [direction * (inputs[0] + inputs[1] * decay), Expression::constant(0.0)]
    }
}
