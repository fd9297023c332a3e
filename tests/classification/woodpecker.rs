//! The woodpecker toy: a sleeve with play on a pole, with a bird on a spring, slides down by impacts and stick (C. Glocker,
//! *Dynamik von Starrkörpersystemen mit Reibung und Stößen*, VDI 1995; R. I. Leine, C. Glocker, D. H. van Campen, *Nonlinear
//! dynamics of the woodpecker toy*, Proc. ASME DETC 2001, VIB-21608). Three contacts with friction: the beak, the lower and the
//! upper edge of the sleeve.

use std::sync::Arc;

use stickslip::classification::Evidence;
use stickslip::model::{
    Expression, Friction, ImpactLaw, Mechanism, MechanismContact, MechanismNormal, Method,
    ModelKind, Number, ParameterDescriptor, Recorder, Simulation, System,
};
use stickslip::motion::{Motion, Phase, Settings, Tolerance};

use crate::support::{OwnMechanism, UnitKind, simulate_kind, unit_kind};

/// Units: the mass of the bird, 1 cm, and the acceleration of gravity.
const MASS_KG: f64 = 0.0045;
const LENGTH_M: f64 = 0.01;
const GRAVITY_M_S2: f64 = 9.81;

/// Half the length and the inner radius of the sleeve, its arm to the spring, the arm of the spring to the bird, the place of the
/// beak, and the radius of the pole.
const SLEEVE: [f64; 3] = [0.58, 0.31, 1.0];
const BIRD: f64 = 1.5;
const BEAK: [f64; 2] = [2.0, 2.01];
const POLE: f64 = 0.25;
const SLEEVE_MASS: f64 = 0.0003 / MASS_KG;

fn inertia(kg_m2: f64) -> f64 {
    kg_m2 / (MASS_KG * LENGTH_M * LENGTH_M)
}

fn seconds() -> f64 {
    (LENGTH_M / GRAVITY_M_S2).sqrt()
}

/// State: height, angles of the sleeve and of the bird, and their speeds.
fn woodpecker<'r>(recorder: &'r Recorder, friction: &[Friction]) -> Mechanism<'r> {
    let [y, sleeve, bird, y_speed, sleeve_speed, bird_speed] = [(); 6].map(|()| recorder.state());
    let number = Expression::constant;
    let stiffness = number(0.0056 / (MASS_KG * GRAVITY_M_S2 * LENGTH_M));
    let [edge, radius, arm] = SLEEVE.map(number);
    let [beak_up, beak_out] = BEAK;
    let play = number(SLEEVE[1] - POLE);
    let turn = stiffness * (sleeve - bird);
    let contact = |gap, sliding_speed, which: usize| MechanismContact {
        position: (y, false),
        sliding_speed,
        normal: MechanismNormal::Gap(gap),
        friction: friction[which],
        force_unit: 1.0,
    };
    let beak_gap = number(SLEEVE[2] + BIRD - beak_out - POLE) - number(beak_up) * bird;
    let beak_speed = y_speed + arm * sleeve_speed + number(BIRD - beak_out) * bird_speed;
    let edge_speed = y_speed + radius * sleeve_speed;
    let coupling = number(SLEEVE[2] * BIRD);
    Mechanism {
        coordinates: vec![[y, y_speed], [sleeve, sleeve_speed], [bird, bird_speed]],
        rates: vec![],
        others: vec![],
        mass: vec![
            vec![number(1.0 + SLEEVE_MASS), arm, number(BIRD)],
            vec![arm, number(inertia(5e-9) + SLEEVE[2] * SLEEVE[2]), coupling],
            vec![number(BIRD), coupling, number(inertia(7e-7) + BIRD * BIRD)],
        ],
        forces: vec![number(-1.0 - SLEEVE_MASS), -turn - arm, turn - number(BIRD)],
        contacts: vec![
            contact(beak_gap, beak_speed, 0),
            contact(play + edge * sleeve, edge_speed, 1),
            contact(play - edge * sleeve, edge_speed, 2),
        ],
        forcing: None,
    }
}

fn system() -> Arc<dyn System> {
    let law = |restitution| ImpactLaw { restitution, ..ImpactLaw::default() };
    let contacts = [0.5, 0.0, 0.0].map(|e| (Friction::coulomb(0.3), true, law(e)));
    Arc::new(OwnMechanism::new(woodpecker, vec![], contacts.to_vec()))
}

/// In SI units: y, both angles, and their velocities.
fn si(state: &[f64]) -> [f64; 6] {
    let speed = LENGTH_M / seconds();
    let units = [LENGTH_M, 1.0, 1.0, speed, 1.0 / seconds(), 1.0 / seconds()];
    std::array::from_fn(|place| state[place] * units[place])
}

/// A state in the slide before the sleeve sticks, as the example of Siconos starts (V. Acary, O. Bonnefon, M. Brémond, O. Huber,
/// F. Pérignon, S. Sinclair, *An introduction to Siconos*, INRIA TR-0340, 2019): the lower edge touches.
fn published_start() -> [f64; 6] {
    let play = (SLEEVE[1] - POLE) / SLEEVE[0];
    let speed = LENGTH_M / seconds();
    [0.0, -play, -0.2788, -0.3411 / speed, 0.0, -7.4583 * seconds()]
}

/// The motion of Siconos by time stepping (Moreau and Jean, steps of 2e-5 s), whose impacts are up to a step late.
#[test]
fn the_motion_is_that_of_time_stepping() {
    let tolerance = Tolerance { relative: 1e-11, absolute: 1e-13 };
    let settings =
        Settings { method: Method::Event, band: 0.0, tolerance, effort_limit: 1_000_000 };
    let mut motion = Motion::new(&system(), settings, &published_start()).expect("starts");
    let mut at = |time_s: f64| {
        while motion.time() * seconds() < time_s {
            motion.advance(time_s / seconds()).expect("continues");
        }
        (si(&motion.state()), motion.phases().to_vec())
    };
    let (stuck, phases) = at(0.03);
    assert_eq!(phases, [Phase::Apart, Phase::Stick, Phase::Apart]);
    let published: [f64; 6] = [-4.40745e-3, 0.0, -0.526191, 0.0, 0.0, -2.83141];
    let (late, _) = at(0.29998);
    let published_late: [f64; 6] = [-41.348e-3, -0.103448, -0.340934, -0.260137, 0.0, -8.32756];
    for (found, published) in [(stuck, published), (late, published_late)] {
        for place in [0, 2, 3, 5] {
            let scale = published[place].abs().max(0.05);
            let off = (found[place] - published[place]) / scale;
            assert!(off.abs() < 0.01, "{place}: {} {}", found[place], published[place]);
        }
    }
}

static KIND: ModelKind = unit_kind(
    "woodpecker",
    &[ParameterDescriptor::positive("friction_coefficient", "1", "friction", 0.3)],
    &WOODPECKER,
);

static WOODPECKER: UnitKind =
    UnitKind { coordinates: 3, phases: 0, contacts: 3, system: |_| system() };

/// Returns the slope of the return map from successive returns: the ratio of the changes of the bird's least angle, which it
/// reaches while the sleeve sticks.
fn slope_of_returns() -> f64 {
    let tolerance = Tolerance { relative: 1e-12, absolute: 1e-14 };
    let settings =
        Settings { method: Method::Event, band: 0.0, tolerance, effort_limit: 1_000_000 };
    let mut motion = Motion::new(&system(), settings, &published_start()).expect("starts");
    let mut least = Vec::new();
    while least.len() < 40 {
        motion.advance(1e4).expect("continues");
        if motion.phases_during_step()[1] == Phase::Stick {
            least.extend(motion.falls_through_zero(|state| -state[5]).map(|(_, state)| state[2]));
        }
    }
    (least[39] - least[38]) / (least[38] - least[37])
}

/// The bird comes down on a limit cycle, by either method and from two starts. The period and the mean speed are those of an
/// independent time stepping (steps of 1e-5 s) to its accuracy, and the multiplier is the slope of successive returns.
#[test]
fn the_bird_comes_down_on_a_limit_cycle() {
    let slope = slope_of_returns();
    assert!(slope < 0.0, "it swings from side to side: {slope}");
    for (method, band) in [(Method::Event, 0.0), (Method::Switch, 1e-8)] {
        for bird in [-0.2788, -0.30] {
            let simulation = Simulation {
                method,
                band,
                end_time_s: 1000.0,
                tolerance: Tolerance { relative: 1e-10, absolute: 1e-12 },
                ..Simulation::default()
            };
            let mut start = published_start();
            start[2] = bird;
            let outcome = simulate_kind(&KIND, &[], &start, simulation);
            assert_eq!(outcome.evidence, Evidence::ClosedOrbit, "{method:?} {bird}: {outcome:?}");
            let period_s = outcome.period_s.expect("a cycle has a period") * seconds();
            assert!((period_s - 0.14600).abs() < 5e-5, "{period_s}");
            let cycle = outcome.cycle.expect("known");
            assert!((cycle.multipliers[0] + slope).abs() < 1e-4, "{slope} {cycle:?}");
            assert!(cycle.multipliers[1..].iter().all(|one| *one < 1e-6), "{cycle:?}");
            assert_eq!(cycle.neutral_directions, 1, "the height");
            let mean = outcome.mean_speed.expect("the bird moves on")[0] * LENGTH_M / seconds();
            assert!((mean + 0.1332).abs() < 1e-4, "{mean}");
        }
    }
}
