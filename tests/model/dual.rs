//! Dual numbers: their slopes agree with central differences.

use stickslip::model::{Dual, Friction, Number, Sliding};

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

#[test]
fn slopes_of_the_friction_laws() {
    let laws = [
        Sliding::Coulomb,
        Sliding::Stribeck { speed: 0.3 },
        Sliding::Stribeck { speed: 0.0 },
        Sliding::Smooth { speed: 0.2 },
        Sliding::Viscous { drag: 0.7 },
    ];
    for sliding in laws {
        let friction = Friction { coefficient: 0.5, limit: 0.8, sliding };
        for speed in [-1.1, -0.2, 0.25, 0.9] {
            let direction = f64::signum(speed);
            let along = friction.slip_along(direction, Dual { value: speed, slope: 1.0 });
            let at = |speed| friction.slip(direction, speed);
            let (low, high) = (at(speed - 1e-6), at(speed + 1e-6));
            let expected = (high.signed_friction - low.signed_friction) / 2e-6;
            assert!((along.signed_friction.slope - expected).abs() < 1e-8, "{sliding:?}");
            assert!((along.drag.slope - (high.drag - low.drag) / 2e-6).abs() < 1e-8);
            assert_eq!(along.signed_friction.value, at(speed).signed_friction);
        }
    }
}
