//! Blocks that a periodic force shakes, against closed forms: Den Hartog's oscillator and the creep on a slope that vibrates.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use stickslip::classification::{CyclePhase, Evidence, Outcome};
use stickslip::model::{
    ContactEquations, ContactLayout, Expression, ForcingLayout, Friction, Layout, Method,
    ModelKind, Number, ParameterDescriptor, Recorder, Simulation, System, SystemEquations,
};
use stickslip::motion::{Direction, Motion, Phase, Settings, Tolerance};

use super::{METHODS, near};
use crate::support::{OwnSystem, UnitKind, simulate_kind, unit_kind};

/// A block of mass 1 with Coulomb friction, which the force `A cos φ - s` and maybe a spring of stiffness 1 pull. State:
/// phase `φ` of the force, position, speed.
fn shaken(recorder: &Recorder, with_spring: bool) -> SystemEquations<'_> {
    let [phase, position, speed] = [(); 3].map(|()| recorder.state());
    let [frequency, amplitude, slope, friction] =
        ["frequency", "amplitude", "slope", "friction"].map(|name| recorder.parameter(name));
    let (_, cosine) = phase.sin_cos();
    let force = amplitude * cosine - slope;
    let force = if with_spring { force - position } else { force };
    let [slips, direction] = ["slips", "direction"].map(|name| recorder.input(name));
    let acceleration = slips * (force - direction * friction);
    SystemEquations {
        derivative: vec![frequency, speed, acceleration],
        contacts: vec![ContactEquations {
            sliding_speed: speed,
            sliding_acceleration: acceleration,
            normal: Expression::constant(1.0),
            friction: slips * direction * friction + (Expression::constant(1.0) - slips) * force,
        }],
        layout: Layout {
            contacts: vec![ContactLayout { position: 1, angular: false }],
            velocities: vec![vec![2]],
            vibration: None,
            forcing: Some(ForcingLayout { component: 0, period: TAU }),
        },
        ..SystemEquations::default()
    }
}

static KIND: ModelKind = unit_kind(
    "shaken_block",
    &[
        ParameterDescriptor::positive("frequency", "1", "frequency of the force", 0.8),
        ParameterDescriptor::positive("amplitude", "1", "amplitude of the force", 1.0),
        ParameterDescriptor::not_negative("slope", "1", "constant force", 0.0),
        ParameterDescriptor::count("springs", "number of springs, 1, or none: 2", 1, 2),
        ParameterDescriptor::positive("friction_coefficient", "1", "friction", 0.3),
    ],
    &SHAKEN,
);

static SHAKEN: UnitKind = UnitKind {
    coordinates: 1,
    phases: 1,
    contacts: 1,
    system: |model| {
        let friction = model.number("friction_coefficient");
        let parameters = ["frequency", "amplitude", "slope"].map(|name| model.number(name));
        let record: for<'r> fn(&'r Recorder) -> SystemEquations<'r> = match model.count("springs") {
            1 => |recorder| shaken(recorder, true),
            _ => |recorder| shaken(recorder, false),
        };
        let parameters = parameters.into_iter().chain([friction]).collect();
        let system = OwnSystem::new(record, parameters, vec![Friction::coulomb(friction)]);
        Arc::new(OwnSystem { outputs: &[1], ..system })
    },
};

/// Runs a block with these parameters, in the order of the kind, from a start position and speed.
fn run(parameters: [f64; 5], start: [f64; 2], method: Method) -> Outcome {
    let simulation = Simulation {
        method,
        band: 1e-10,
        end_time_s: 400.0,
        tolerance: Tolerance { relative: 1e-11, absolute: 1e-13 },
        ..Simulation::default()
    };
    simulate_kind(&KIND, &parameters, &start, simulation)
}

/// The amplitude of the motion without stops, over the static deflection (J. P. Den Hartog, *Forced vibrations with combined
/// Coulomb and viscous friction*, Trans. ASME 53, 1931, 107-115): `A² = V² - (s U)²` with the friction `s` over the force, the
/// amplitude `V = 1 / (1 - r²)` without friction and `U = sin(π/r) / (r (1 + cos(π/r)))`.
fn den_hartog(ratio: f64, friction: f64) -> f64 {
    let free = 1.0 / (1.0 - ratio * ratio);
    let (sine, cosine) = (PI / ratio).sin_cos();
    let held = sine / (ratio * (1.0 + cosine));
    (free.powi(2) - (friction * held).powi(2)).sqrt()
}

/// The program finds Den Hartog's motion without stops, at frequencies below and above the natural one.
#[test]
fn den_hartogs_oscillator_has_the_amplitude_of_the_closed_form() {
    for (ratio, friction) in [(0.8, 0.3), (0.6, 0.2), (1.3, 0.4), (1.6, 0.1)] {
        for method in METHODS {
            let outcome = run([ratio, 1.0, 0.0, 1.0, friction], [0.4, -0.1], method);
            assert_eq!(outcome.evidence, Evidence::ClosedOrbit, "{ratio} {method:?}: {outcome:?}");
            near(outcome.amplitude_m, den_hartog(ratio, friction), 1e-9);
            near(outcome.period_s, TAU / ratio, 1e-12);
            let cycle = outcome.cycle.as_ref().expect("known");
            let mut phases = cycle.configurations.concat();
            phases.sort();
            assert_eq!(phases, [CyclePhase::Forward, CyclePhase::Backward], "{ratio}");
            assert!(cycle.multipliers.iter().all(|multiplier| *multiplier < 1.0));
        }
    }
}

/// The block begins to stop where its acceleration after a turning point would vanish: `s = r² A`, hence
/// `s = r² |V| / sqrt(1 + (r² U)²)` with the terms of [`den_hartog`].
#[test]
fn den_hartogs_oscillator_begins_to_stick_at_the_boundary_of_the_closed_form() {
    for ratio in [0.7, 0.9, 1.3] {
        let (sine, cosine) = (PI / ratio).sin_cos();
        let held = ratio * sine / (1.0 + cosine);
        let free = ratio * ratio / (1.0 - ratio * ratio);
        let boundary = free.abs() / (1.0 + held * held).sqrt();
        for (part, sticks) in [(0.99, false), (1.01, true)] {
            let friction = part * boundary;
            let outcome = run([ratio, 1.0, 0.0, 1.0, friction], [0.4, -0.1], Method::Event);
            assert_eq!(outcome.evidence, Evidence::ClosedOrbit, "{ratio} {part}: {outcome:?}");
            let cycle = outcome.cycle.expect("known");
            let found = cycle.configurations.iter().any(|phases| phases[0] == CyclePhase::Stick);
            assert_eq!(found, sticks, "{ratio} {friction}: {:?}", cycle.configurations);
        }
    }
}

/// The force is ahead of the block: at the greatest deflection its phase has the cosine `A / V` and the sine `|s U / V|`
/// (Den Hartog 1931).
#[test]
fn den_hartogs_oscillator_lags_by_the_phase_of_the_closed_form() {
    for (ratio, friction) in [(0.8, 0.3), (1.3, 0.4)] {
        let system: Arc<dyn System> = Arc::new(OwnSystem::new(
            |recorder| shaken(recorder, true),
            vec![ratio, 1.0, 0.0, friction],
            vec![Friction::coulomb(friction)],
        ));
        let tolerance = Tolerance { relative: 1e-12, absolute: 1e-14 };
        let settings =
            Settings { method: Method::Event, band: 0.0, tolerance, effort_limit: 1_000_000 };
        let mut motion = Motion::new(&system, settings, &[0.0, 0.4, -0.1]).expect("starts");
        let mut phase = f64::NAN;
        while motion.time() < 2000.0 {
            let turns = motion.advance(2000.0).expect("continues");
            if turns && motion.phases()[0] == Phase::Slip(Direction::Backward) {
                phase = motion.state()[0].rem_euclid(TAU);
            }
        }
        let free = 1.0 / (1.0 - ratio * ratio);
        let (sine, cosine) = (PI / ratio).sin_cos();
        let held = sine / (ratio * (1.0 + cosine));
        let exact = (friction * held / free).abs().atan2(den_hartog(ratio, friction) / free);
        near(Some(phase), exact, 1e-9);
    }
}

/// With more friction the block stops twice or more often per period; the motion is still periodic.
#[test]
fn a_forced_oscillator_with_much_friction_stops() {
    for method in METHODS {
        let outcome = run([0.5, 1.0, 0.0, 1.0, 0.8], [0.1, 0.0], method);
        assert_eq!(outcome.evidence, Evidence::ClosedOrbit, "{outcome:?}");
        let cycle = outcome.cycle.expect("known");
        let sticks = cycle.configurations.iter().filter(|phases| phases[0] == CyclePhase::Stick);
        assert!(sticks.count() >= 2, "{:?}", cycle.configurations);
    }
}

/// A block that friction holds against the force in every period is at rest, with the least margin of a period.
#[test]
fn a_block_that_friction_holds_against_the_force_is_at_rest() {
    for springs in [1.0, 2.0] {
        for method in METHODS {
            let outcome = run([0.8, 0.5, 0.1, springs, 0.8], [0.0, 0.0], method);
            assert_eq!(outcome.evidence, Evidence::PeriodicRest, "{outcome:?}");
            // The largest force is 0.6 of a limit of 0.8.
            near(outcome.friction_margin, 0.25, 1e-7);
            near(outcome.time_to_rest_s, 0.0, 0.0);
            assert!(outcome.cycle.is_none());
        }
    }
}

/// Returns the way that a block slides down a slope in one period: it breaks loose where `A cos φ - s = -μ`, and stops where
/// `A (sin φ - sin φ₁) = (s - μ) (φ - φ₁)`.
fn creep(frequency: f64, amplitude: f64, slope: f64, friction: f64) -> f64 {
    let loose = ((slope - friction) / amplitude).acos();
    let speed = |phase: f64| {
        (amplitude * (phase.sin() - loose.sin()) - (slope - friction) * (phase - loose)) / frequency
    };
    let (mut from, mut to) = (TAU - loose, TAU + loose);
    for _ in 0..100 {
        let middle = 0.5 * (from + to);
        *(if speed(middle) < 0.0 { &mut from } else { &mut to }) = middle;
    }
    let slid = from - loose;
    let moved = amplitude * (loose.cos() - from.cos() - slid * loose.sin())
        - 0.5 * (slope - friction) * slid * slid;
    moved / frequency.powi(2)
}

/// A block on a slope that vibrates sticks and creeps down in each period, by the way of the closed form.
#[test]
fn a_block_on_a_vibrating_slope_creeps_as_in_closed_form() {
    for (frequency, amplitude, slope, friction) in [(1.0, 0.5, 0.3, 0.6), (2.0, 0.9, 0.1, 0.95)] {
        let exact = creep(frequency, amplitude, slope, friction);
        assert!(exact < 0.0);
        for method in METHODS {
            let outcome = run([frequency, amplitude, slope, 2.0, friction], [0.3, 0.1], method);
            assert_eq!(outcome.evidence, Evidence::ClosedOrbit, "{method:?}: {outcome:?}");
            let speed = outcome.mean_speed.as_ref().map(|speeds| speeds[0]);
            near(speed, exact * frequency / TAU, 1e-9);
            let cycle = outcome.cycle.expect("known");
            assert_eq!(cycle.configurations.len(), 2, "{:?}", cycle.configurations);
            assert_eq!(cycle.neutral_directions, 1);
        }
    }
}
