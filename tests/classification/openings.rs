//! Endings of motions whose contacts open and close: rest on the ground, and a cycle with lasting contact in it.

use std::f64::consts::TAU;
use std::sync::Arc;

use stickslip::classification::{CyclePhase, Label, Outcome, simulate};
use stickslip::model::{
    Expression, Friction, FrictionLaw, ImpactLaw, Mechanism, MechanismContact, MechanismNormal,
    Method, ModelKind, Number, OutputValue, OwnModel, ParameterDescriptor, Recorder, Simulation,
    System, Tolerance,
};

use super::METHODS;
use super::outputs::cases;
use crate::support::{OwnSystem, UnitKind, simulate_kind, unit_kind};

/// A block of weight 1 above a plate that vibrates; a force pushes it along the plate.
pub fn block<'r>(recorder: &'r Recorder, friction: &[Friction]) -> Mechanism<'r> {
    let [phase, along, height, speed, rise] = [(); 5].map(|()| recorder.state());
    let [shaking, push] = ["shaking", "push"].map(|name| recorder.parameter(name));
    let [zero, one] = [0.0, 1.0].map(Expression::constant);
    Mechanism {
        coordinates: vec![[along, speed], [height, rise]],
        rates: vec![],
        others: vec![[phase, one]],
        mass: vec![vec![one, zero], vec![zero, one]],
        forces: vec![push, shaking * phase.sin_cos().1 - one],
        contacts: vec![MechanismContact {
            position: (along, false),
            sliding_speed: speed,
            normal: MechanismNormal::Gap(height),
            friction: friction[0],
            force_unit: 1.0,
        }],
        forcing: Some((phase, TAU)),
        angles: vec![],
    }
}

static KIND: ModelKind = unit_kind(
    "block_on_plate",
    &[
        ParameterDescriptor::not_negative("shaking", "1", "acceleration of the plate over g", 0.0),
        ParameterDescriptor::not_negative(
            "push",
            "1",
            "force along the plate over the weight",
            0.0,
        ),
        ParameterDescriptor::not_negative("restitution", "1", "restitution", 0.4),
        ParameterDescriptor::positive("friction_coefficient", "1", "friction", 0.3),
    ],
    &BLOCK,
);

static BLOCK: UnitKind = UnitKind { coordinates: 2, phases: 1, contacts: 1, system };

fn system(model: &OwnModel) -> Arc<dyn System> {
    let law = ImpactLaw { restitution: model.number("restitution"), ..ImpactLaw::default() };
    let coefficient = model.number("friction_coefficient");
    // Below this coefficient the block has no friction.
    let friction = match coefficient < 1e-3 {
        true => FrictionLaw::viscous(0.0).contact(0.0, 1.0, 1.0),
        false => Friction::coulomb(coefficient),
    };
    let parameters = ["shaking", "push"].map(|name| model.number(name));
    Arc::new(OwnSystem::mechanism(block, parameters.to_vec(), vec![(friction, true, law)]))
}

/// Runs a block from a place above the plate; the speeds are along it and up.
fn run(parameters: [f64; 4], start: [f64; 4], method: Method) -> Outcome {
    let simulation = Simulation {
        method,
        band: 1e-8,
        end_time_s: 400.0,
        tolerance: Tolerance { relative: 1e-11, absolute: 1e-13 },
        ..Simulation::default()
    };
    simulate_kind(&KIND, &parameters, &start, simulation)
}

/// A block falls on a plate at rest, bounces, slides and sticks for good, unless the push exceeds friction.
#[test]
fn a_block_comes_to_rest_where_friction_holds_it() {
    for method in METHODS {
        let outcome = run([0.0, 0.2, 0.4, 0.3], [0.0, 1.0, 0.7, 0.0], method);
        assert_eq!(outcome.label(), Label::Equilibrium, "{outcome:?}");
        let margin = outcome.evidence.friction_margin().expect("known");
        assert!((margin - (1.0 - 0.2 / 0.3)).abs() < 1e-6, "{margin}");
        let outcome = run([0.0, 0.35, 0.4, 0.3], [0.0, 1.0, 0.7, 0.0], method);
        assert_ne!(outcome.label(), Label::Equilibrium, "{outcome:?}");
    }
}

/// A plate with an acceleration above that of gravity throws the block once per period; it comes to rest on the plate by
/// accumulation before it is thrown again, whatever its start. Such a motion forgets its start within a period.
#[test]
fn a_block_that_a_plate_throws_once_per_period_forgets_its_start() {
    for method in METHODS {
        for height in [0.0, 0.3] {
            let outcome = run([1.3, 0.0, 0.4, 0.3], [0.0, height, 0.0, 0.0], method);
            assert_eq!(outcome.evidence.name(), "closed_orbit", "{method:?} {height} {outcome:?}");
            let period_s = outcome.evidence.period_s().expect("a cycle has a period");
            assert!((period_s - TAU).abs() < 1e-12, "{period_s}");
            let cycle = outcome.evidence.cycle().expect("known");
            assert!(cycle.multipliers.iter().all(|multiplier| *multiplier < 1e-6), "{cycle:?}");
            assert!(cycle.configurations.contains(&vec![CyclePhase::Apart]), "{cycle:?}");
            assert!(cycle.configurations.contains(&vec![CyclePhase::Stick]), "{cycle:?}");
        }
    }
}

/// Two blocks that springs press against each other rest in touch. The force between them is not determined: they are at rest with the
/// margin of friction that the best force leaves, `min(1 - |T_x - force| / limit, 1 - |T_y + force| / limit)`. A third block rests apart.
#[test]
fn blocks_that_touch_rest_if_any_force_between_them_holds_them() {
    let [stiffness, offset, load, coefficient] = [100.0, 0.05, 10.0, 0.2];
    let system = format!(
        "parameters: {{m: 1 kg, n: 2 kg, k: {stiffness} N/m, a: {offset} m, load: {load} N, mu: {coefficient}}}
coordinates:
  x: {{unit: m, start: [-0.1, -0.01], start_rate: [-0.5, 0.5]}}
  y: {{unit: m, start: [0.01, 0.1], start_rate: [-0.5, 0.5]}}
  z: {{unit: m, start: [0.9, 1.1], start_rate: [-0.5, 0.5]}}
mass: {{x: {{x: m}}, y: {{y: n}}, z: {{z: m}}}}
force: {{x: -k * (x - a), y: -k * (y + a), z: -k * (z - 1)}}
contacts:
  far: {{normal: load, sliding: \"z'\", friction: {{coulomb: {{coefficient: mu}}}}}}
  left: {{normal: load, sliding: \"x'\", friction: {{coulomb: {{coefficient: mu}}}}}}
  right: {{normal: load, sliding: \"y'\", friction: {{coulomb: {{coefficient: mu}}}}}}
  between: {{gap: y - x, restitution: 0.3}}"
    );
    for method in METHODS {
        for mut case in cases(&system, 32, 20.0) {
            case.simulation.method = method;
            let outcome = simulate(&case);
            assert_eq!(outcome.evidence.name(), "settled", "{method:?} {outcome:?}");
            let end = |output: usize| {
                outcome.outputs[output].value(OutputValue::End).expect("a place of rest")
            };
            let pulls = [-stiffness * (end(0) - offset), -stiffness * (end(1) + offset)];
            // The best force makes both forces of friction equal, or there is none.
            let force = (0.5 * (pulls[0] - pulls[1])).max(0.0);
            let needed = (pulls[0] - force).abs().max((pulls[1] + force).abs());
            let needed = needed.max((stiffness * (end(2) - 1.0)).abs());
            let margin = 1.0 - needed / (coefficient * load);
            let found = outcome.evidence.friction_margin().expect("a margin");
            assert!((found - margin).abs() < 1e-9, "{found} {margin}");
        }
    }
}

/// A block without friction presses one that rests: the force between them is determined, and the motion ends at rest or goes on, but
/// the search for the best force between them ends.
#[test]
fn a_block_without_friction_leans_on_one_that_rests() {
    let system = "parameters: {m: 1 kg, n: 10 N, f: 1.2 N, g: -0.5 N, mu: 0.1}
coordinates:
  x: {unit: m, start: [-1, -0.5], start_rate: [0, 1]}
  y: {unit: m, start: [0.1, 0.5], start_rate: [-1, 0]}
mass: {x: {x: m}, y: {y: m}}
force: {x: f, y: g}
contacts:
  a: {normal: n, sliding: \"x'\", friction: {coulomb: {coefficient: mu}}}
  b: {normal: n, sliding: \"y'\", friction: {coulomb: {coefficient: 0}}}
  touch: {gap: y - x}";
    for outcome in cases(system, 2, 30.0).iter().map(simulate) {
        assert_ne!(outcome.label(), Label::Failed, "{outcome:?}");
    }
}
