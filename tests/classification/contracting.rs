//! Rest of a system whose equations are not affine while its contact sticks: a block that may leave the ground, with a damped
//! pendulum on it.

use std::sync::Arc;

use stickslip::classification::{Evidence, Label, Outcome};
use stickslip::model::{
    Expression, Friction, ImpactLaw, Mechanism, MechanismContact, MechanismNormal, Method,
    ModelKind, Number, ParameterDescriptor, Recorder, Simulation, System,
};
use stickslip::motion::{Motion, Settings, Tolerance, all_stick};

use crate::support::{OwnMechanism, TestRng, UnitKind, simulate_kind, unit_kind};

/// The block has mass 1 and the pendulum mass 0.5 and length 1; gravity is 1.
fn block_with_pendulum<'r>(recorder: &'r Recorder, friction: &[Friction]) -> Mechanism<'r> {
    let [x, y, angle, x_speed, y_speed, turn] = [(); 6].map(|()| recorder.state());
    let damping = recorder.parameter("damping");
    let [zero, mass, both] = [0.0, 0.5, 1.5].map(Expression::constant);
    let (sine, cosine) = angle.sin_cos();
    let centrifugal = mass * turn * turn;
    Mechanism {
        coordinates: vec![[x, x_speed], [y, y_speed], [angle, turn]],
        rates: vec![],
        others: vec![],
        mass: vec![
            vec![both, zero, mass * cosine],
            vec![zero, both, mass * sine],
            vec![mass * cosine, mass * sine, mass],
        ],
        forces: vec![
            centrifugal * sine,
            -centrifugal * cosine - both,
            -mass * sine - damping * turn,
        ],
        contacts: vec![MechanismContact {
            position: (x, false),
            sliding_speed: x_speed,
            normal: MechanismNormal::Gap(y),
            friction: friction[0],
            force_unit: 1.0,
        }],
        forcing: None,
    }
}

fn system(friction: f64, damping: f64) -> Arc<dyn System> {
    let contacts = vec![(Friction::coulomb(friction), true, ImpactLaw::default())];
    Arc::new(OwnMechanism::new(block_with_pendulum, vec![damping], contacts))
}

static KIND: ModelKind = unit_kind(
    "block_with_pendulum",
    &[
        ParameterDescriptor::positive("friction_coefficient", "1", "friction", 0.2),
        ParameterDescriptor::not_negative("damping", "1", "damping of the pendulum", 0.1),
    ],
    &BLOCK,
);

static BLOCK: UnitKind = UnitKind {
    coordinates: 3,
    phases: 0,
    contacts: 1,
    system: |model| system(model.number("friction_coefficient"), model.number("damping")),
};

fn run(friction: f64, damping: f64, start: &[f64], method: Method) -> Outcome {
    let simulation = Simulation { method, end_time_s: 1000.0, ..Simulation::default() };
    simulate_kind(&KIND, &[friction, damping], start, simulation)
}

/// Whatever its start, the block comes to rest, and does not move again when it is followed on. Much friction holds it while the
/// pendulum still swings far; the proof then comes when the swing is small enough for the bounds.
#[test]
fn a_block_with_a_damped_pendulum_comes_to_rest_for_good() {
    let mut draws = TestRng::new(48);
    for number in 0..40 {
        let method = [Method::Event, Method::Switch][number % 2];
        let friction = [0.05, 0.2, 0.6][number % 3];
        let mut one = |most: f64| most * (2.0 * draws.uniform() - 1.0);
        let start = [one(1.0), one(0.2).abs(), one(3.0), one(0.5), one(0.5), one(1.5)];
        let outcome = run(friction, 0.1, &start, method);
        assert_eq!(outcome.evidence, Evidence::RestContracting, "{start:?} {outcome:?}");
        assert_eq!(outcome.label(), Label::Equilibrium);
        let margin = outcome.friction_margin.expect("known");
        assert!((margin - 1.0).abs() < 1e-6, "the pendulum hangs down at rest: {margin}");
        let since = outcome.time_to_rest_s.expect("known");
        let tolerance = Tolerance { relative: 1e-8, absolute: 1e-10 };
        let settings = Settings { method, band: 1e-8, tolerance, effort_limit: 1_000_000 };
        let mut motion =
            Motion::new(&system(friction, 0.1), settings, &start).expect("starts above the ground");
        while motion.time() < 1000.0 {
            motion.advance(1000.0).expect("continues");
        }
        assert!(all_stick(motion.phases()) && motion.last_switches()[0] <= since + 1e-6, "{since}");
    }
}

/// Without damping the pendulum swings for ever: nothing proves that the block rests.
#[test]
fn a_pendulum_without_damping_proves_nothing() {
    let outcome = run(0.6, 0.0, &[0.0, 0.0, 0.3, 0.0, 0.0, 0.0], Method::Event);
    assert_eq!(outcome.label(), Label::Undecided, "{outcome:?}");
}
