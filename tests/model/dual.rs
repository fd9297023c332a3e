//! Dual numbers: their slopes agree with central differences.

use stickslip::model::{Dual, FRICTION_LAWS, FrictionLaw, Number};

use crate::support::example_law;

/// Every operation agrees with central differences.
#[test]
fn slopes_are_derivatives() {
    fn function<T: Number>(x: T) -> T {
        let (sine, cosine) = (x * T::constant(1.3)).sin_cos();
        (sine - cosine * x + T::constant(2.5)).reciprocal() * -x + cosine
    }
    for x in [-2.0, -0.3, 0.0, 0.7, 1.9] {
        let slope = function(Dual { value: x, slope: 1.0 }).slope;
        let step = 1e-5;
        let difference = (function(x + step) - function(x - step)) / (2.0 * step);
        assert!((slope - difference).abs() < 1e-8 * slope.abs().max(1.0), "{x}: {slope}");
    }
}

/// The slope of every law is the limit of differences, also where its parameters have special values.
#[test]
fn slopes_of_the_friction_laws() {
    let examples = FRICTION_LAWS.iter().flat_map(|law| [0, 1].map(|unit| example_law(*law, unit)));
    let special = [
        FrictionLaw::stribeck(0.8, 0.3),
        FrictionLaw::stribeck(0.8, 0.0),
        FrictionLaw::smooth(0.2),
        FrictionLaw::viscous(0.7),
        FrictionLaw::coulomb_viscous(0.7),
    ];
    for law in examples.chain(special) {
        let friction = law.contact(0.5, 1.0, 1.0);
        for speed in [-1.1, -0.2, 0.25, 0.9] {
            let direction = f64::signum(speed);
            let along = friction.slip_along(direction, Dual { value: speed, slope: 1.0 });
            let at = |speed| friction.slip(direction, speed);
            let (low, high) = (at(speed - 1e-6), at(speed + 1e-6));
            let expected = (high.signed_friction - low.signed_friction) / 2e-6;
            assert!((along.signed_friction.slope - expected).abs() < 1e-8, "{law:?}");
            assert!((along.drag.slope - (high.drag - low.drag) / 2e-6).abs() < 1e-8, "{law:?}");
            assert_eq!(along.signed_friction.value, at(speed).signed_friction);
        }
    }
}
