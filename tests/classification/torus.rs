//! Quasi-periodic motion: oscillators that a force drives at another frequency than their own.

use stickslip::classification::{Label, Outcome, simulate};
use stickslip::model::{Case, Method, Simulation, Tolerance};

use super::outputs::cases;

/// `x'' - ε (1 - x²) x' + x = A cos φ`: for `ε = 0` a linear oscillator, else that of van der Pol.
fn run([frequency, amplitude, excitation]: [f64; 3], method: Method) -> Outcome {
    let system = format!(
        "parameters: {{w: {frequency:?}, a: {amplitude:?}, eps: {excitation:?}}}
coordinates: {{x: {{start: 0.7, start_rate: 0.1}}}}
mass: {{x: {{x: 1}}}}
force: {{x: \"a * cos(w * t) - x + eps * (1 - x^2) * x'\"}}
period: 2 * pi / w"
    );
    let case = cases(&system, 1, 12_000.0).remove(0);
    let tolerance = Tolerance { relative: 1e-10, absolute: 1e-12 };
    let simulation = Simulation { method, tolerance, ..case.simulation };
    simulate(&Case { simulation, ..case })
}

#[test]
fn two_frequencies_without_a_common_period_are_quasi_periodic() {
    for (frequency, excitation) in [(0.618_034, 0.0), (2.0_f64.sqrt(), 0.0), (1.618_034, 0.2)] {
        for method in [Method::Event, Method::Switch] {
            let outcome = run([frequency, 0.3, excitation], method);
            assert_eq!(outcome.evidence.name(), "torus", "{frequency}: {outcome:?}");
            assert_eq!(outcome.label(), Label::QuasiPeriodic);
        }
    }
}

/// A force near the natural frequency locks van der Pol's oscillator to its own; the linear oscillator repeats after two periods of a
/// force at twice its frequency, but attracts no other motion.
#[test]
fn motions_that_repeat_are_not_quasi_periodic() {
    let outcome = run([1.0, 0.5, 0.2], Method::Event);
    assert_eq!(outcome.evidence.name(), "closed_orbit", "{outcome:?}");
    let outcome = run([2.0, 0.3, 0.0], Method::Event);
    assert_eq!(outcome.evidence.name(), "repeats", "{outcome:?}");
}
