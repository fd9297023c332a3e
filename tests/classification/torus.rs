//! Quasi-periodic motion: oscillators that a force drives at another frequency than their own.

use std::f64::consts::TAU;
use std::sync::Arc;

use stickslip::classification::{Evidence, Label, Outcome};
use stickslip::model::{
    Expression, Friction, Mechanism, Method, ModelKind, Number, ParameterDescriptor, Recorder,
    Simulation, Tolerance,
};

use crate::support::{OwnMechanism, UnitKind, simulate_kind, unit_kind};

/// `x'' - ε (1 - x²) x' + x = A cos φ`: for `ε = 0` a linear oscillator, else that of van der Pol.
fn oscillator<'r>(recorder: &'r Recorder, _: &[Friction]) -> Mechanism<'r> {
    let [phase, position, speed] = [(); 3].map(|()| recorder.state());
    let [frequency, amplitude, excitation] =
        ["frequency", "amplitude", "excitation"].map(|name| recorder.parameter(name));
    let one = Expression::constant(1.0);
    let driven = amplitude * phase.sin_cos().1 - position;
    Mechanism {
        coordinates: vec![[position, speed]],
        rates: vec![],
        others: vec![[phase, frequency]],
        mass: vec![vec![one]],
        forces: vec![driven + excitation * (one - position * position) * speed],
        contacts: vec![],
        forcing: Some((phase, TAU)),
    }
}

static KIND: ModelKind = unit_kind(
    "driven_oscillator",
    &[
        ParameterDescriptor::positive("frequency", "1", "frequency of the force", 1.7),
        ParameterDescriptor::positive("amplitude", "1", "amplitude of the force", 0.3),
        ParameterDescriptor::not_negative("excitation", "1", "negative damping", 0.0),
        ParameterDescriptor::positive("friction_coefficient", "1", "without effect", 0.1),
    ],
    &OSCILLATOR,
);

static OSCILLATOR: UnitKind = UnitKind {
    coordinates: 1,
    phases: 1,
    contacts: 0,
    system: |model| {
        let parameters = ["frequency", "amplitude", "excitation"].map(|name| model.number(name));
        Arc::new(OwnMechanism::new(oscillator, parameters.to_vec(), vec![]))
    },
};

fn run(parameters: [f64; 3], method: Method) -> Outcome {
    let simulation = Simulation {
        method,
        end_time_s: 12_000.0,
        tolerance: Tolerance { relative: 1e-10, absolute: 1e-12 },
        ..Simulation::default()
    };
    simulate_kind(&KIND, &parameters, &[0.7, 0.1], simulation)
}

#[test]
fn two_frequencies_without_a_common_period_are_quasi_periodic() {
    for (frequency, excitation) in [(0.618_034, 0.0), (2.0_f64.sqrt(), 0.0), (1.618_034, 0.2)] {
        for method in [Method::Event, Method::Switch] {
            let outcome = run([frequency, 0.3, excitation], method);
            assert_eq!(outcome.evidence, Evidence::Torus, "{frequency}: {outcome:?}");
            assert_eq!(outcome.label(), Label::QuasiPeriodic);
        }
    }
}

/// A force near the natural frequency locks van der Pol's oscillator to its own; the linear oscillator repeats after two periods of a
/// force at twice its frequency, but attracts no other motion.
#[test]
fn motions_that_repeat_are_not_quasi_periodic() {
    let outcome = run([1.0, 0.5, 0.2], Method::Event);
    assert_eq!(outcome.evidence, Evidence::ClosedOrbit, "{outcome:?}");
    let outcome = run([2.0, 0.3, 0.0], Method::Event);
    assert_eq!(outcome.evidence, Evidence::EndTime, "{outcome:?}");
}
