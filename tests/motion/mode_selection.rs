//! The joint decision between stick, slip and transition for all balls in the band, and its
//! difficult cases.

use proptest::prelude::*;
use stickslip::classification::{Evidence, simulate};
use stickslip::model::{
    Balancer, ContactEquations, ContactLayout, Expression, Friction, Machine, Method, Number,
    Recorder, State, StateLayout, SystemEquations,
};
use stickslip::motion::{
    Direction, Evaluator, Failure, Motion, Phase, Phases, SLACK, Settings, Tolerance, decide,
};

use crate::support::reference::{self, stick_reserve};
use crate::support::{OwnSystem, for_each_kernel, shared, shipped_study, started};

fn balancer<const N: usize>(friction: f64, heavier: f64) -> Balancer<N> {
    let mut machine = Machine::default();
    machine.balls.resize(N, machine.balls[0]);
    for (index, ball) in machine.balls.iter_mut().enumerate() {
        ball.friction_coefficient = friction;
        ball.mass_kg *= heavier * (1.0 + index as f64);
    }
    Balancer::new(&machine).expect("the number of balls fits")
}

fn settings() -> Settings {
    let tolerance = Tolerance { relative: 1e-9, absolute: 1e-11 };
    Settings { method: Method::Switch, band: 1e-4, tolerance, effort_limit: 1_000_000 }
}

proptest! {
    /// The decision meets the conditions of the thesis's appendix C: a sticking ball's friction is
    /// within its limit, and a ball in transition accelerates against full friction.
    #[test]
    fn decided_configurations_meet_their_conditions(
        x in -0.1..0.1, y in -0.1..0.1, x_dot in -0.1..0.1, y_dot in -0.1..0.1,
        beta in prop::array::uniform4(0.0..std::f64::consts::TAU), beta_dot in prop::array::uniform4(-1e-4..1e-4),
        friction in 1e-4..0.3_f64, heavier in 1.0..50.0_f64,
    ) {
        let balancer = balancer::<4>(friction, heavier);
        let state = State { position: [x, y], velocity: [x_dot, y_dot], beta, beta_dot };
        let evaluator = Evaluator::new(shared(balancer));
        let mut phases = Phases::from_slice(&[Phase::Stick; 4]);
        let decided = decide(&evaluator, &state.components(), &mut phases).expect("a solution");
        prop_assert_eq!(&decided, &evaluator.forces(&phases, &state.components()));
        let forces = reference::forces(&balancer, &phases, &state);
        for ball in 0..4 {
            prop_assert!((decided[ball].normal - forces.normal[ball]).abs() < 1e-11);
            prop_assert!((decided[ball].friction - forces.friction[ball]).abs() < 1e-11);
            prop_assert!((decided[ball].acceleration - forces.beta_ddot[ball]).abs() < 1e-11);
        }
        for (ball, phase) in phases.iter().enumerate() {
            match *phase {
                Phase::Stick => prop_assert!(stick_reserve(&balancer, &forces, ball) >= -SLACK),
                Phase::Transition(direction) => {
                    prop_assert!(direction * forces.beta_ddot[ball] >= -SLACK);
                    let limit = friction * forces.normal[ball];
                    prop_assert!((forces.friction[ball] - direction * limit).abs() < 1e-12);
                }
                Phase::Slip(_) | Phase::Free | Phase::Apart | Phase::Open | Phase::Closed => prop_assert!(false, "no ball slips"),
            }
        }
        // A motion starts with the decided phases, unless a ball leaves the ring.
        for system in for_each_kernel(balancer) {
            match Motion::new(&system, settings(), &state.components()) {
                Ok(motion) => prop_assert_eq!(motion.phases(), &phases[..]),
                Err(Failure::ContactLost { ball }) => {
                    prop_assert!(forces.normal[ball - 1] <= 0.0);
                }
                Err(failure) => prop_assert!(false, "{}", failure),
            }
        }
    }
}

/// Time advances for a ball that starts exactly on the edge of the band and leaves it while others
/// switch (a former defect).
#[test]
fn time_advances_from_the_edge_of_the_band() {
    let mut stalled = 0;
    for k in 0..400_u32 {
        let balancer = balancer::<4>(2.75e-3, 20.0);
        let spread = |factor: f64| (f64::from(k) * factor + 0.7).sin();
        let state = State {
            position: [0.05 * spread(1.3), 0.05 * spread(2.1)],
            velocity: [0.05 * spread(3.7), 0.05 * spread(4.9)],
            beta: [1.3, 2.9, 4.1, 5.7].map(|factor| 3.0 + 3.0 * spread(factor)),
            beta_dot: [1e-4, -1e-4, 1e-4, -1e-4],
        };
        for system in for_each_kernel(balancer) {
            let mut motion = started(&system, settings(), &state);
            while motion.time() < 1.0 && motion.effort().switches < 1000 {
                motion.advance(1.0).expect("continues");
            }
            stalled += i32::from(motion.time() < 1.0);
        }
    }
    assert_eq!(stalled, 0);
}

/// Two balls with nearly all mass and large friction: a machine without a unique decision.
pub(super) fn undecided_machine(friction: f64) -> Machine {
    let mut machine = Machine { table_mass_kg: 0.02, speed_rad_s: -60.0, ..Machine::default() };
    for ball in &mut machine.balls {
        (ball.mass_kg, ball.friction_coefficient) = (0.15, friction);
    }
    machine
}

fn at_rest(x: f64, y: f64, beta: [f64; 2]) -> State<2> {
    State { position: [x, y], velocity: [0.0; 2], beta, beta_dot: [0.0; 2] }
}

/// Returns the accelerations of all combinations that meet the conditions of appendix C, pressed to
/// the ring.
fn all_solutions(balancer: &Balancer<2>, state: &State<2>) -> Vec<[f64; 2]> {
    let kinds = [
        Phase::Stick,
        Phase::Transition(Direction::Forward),
        Phase::Transition(Direction::Backward),
    ];
    let mut found: Vec<[f64; 2]> = Vec::new();
    for phases in kinds.into_iter().flat_map(|a| kinds.map(|b| [a, b])) {
        let forces = reference::forces(balancer, &phases, state);
        let meets = |ball: usize| match phases[ball] {
            Phase::Stick => stick_reserve(balancer, &forces, ball) >= -SLACK,
            Phase::Transition(direction) => direction * forces.beta_ddot[ball] >= -SLACK,
            Phase::Slip(_) | Phase::Free | Phase::Apart | Phase::Open | Phase::Closed => true,
        };
        let pressed = forces.normal.iter().all(|&normal| normal > 0.0);
        let new = found
            .iter()
            .all(|other| (0..2).any(|ball| (other[ball] - forces.beta_ddot[ball]).abs() > 1e-5));
        if pressed && new && (0..2).all(meets) {
            found.push(forces.beta_ddot);
        }
    }
    found
}

/// If several solutions or none exist, the decision is refused.
#[test]
fn several_solutions_are_refused() {
    let mut seen = [0_u32; 4];
    for k in 0..20_000_u32 {
        let spread = |factor: f64| (f64::from(k) * factor + 0.7).sin();
        let machine = undecided_machine(3.0 + 2.0 * spread(0.9));
        let balancer = Balancer::new(&machine).expect("two balls");
        let beta = [0.95 + spread(1.3), -0.95 + spread(2.7)];
        let state = at_rest(-0.065 + 0.065 * spread(2.1), 0.02 * spread(3.7), beta);
        let mut phases = Phases::from_slice(&[Phase::Stick; 2]);
        let found = all_solutions(&balancer, &state);
        seen[found.len()] += 1;
        let evaluator = Evaluator::new(shared(balancer));
        match (decide(&evaluator, &state.components(), &mut phases), found.as_slice()) {
            (Ok(forces), [only]) => {
                assert!((0..2).all(|ball| (forces[ball].acceleration - only[ball]).abs() < 1e-5));
            }
            (Ok(forces), []) => assert!(forces.iter().any(|contact| contact.normal <= 0.0)),
            (Err(Failure::NoSolution { solutions }), several) => {
                assert_eq!(solutions, several.len());
                assert!(!balancer.one_solution_at(&beta));
            }
            (decided, found) => panic!("{decided:?} of {found:?}"),
        }
    }
    assert!(seen[..3].iter().all(|&count| count > 100), "{seen:?}");
    let message = |solutions| Failure::NoSolution { solutions }.to_string();
    assert_eq!(message(0), "no combination of stick and slip meets all conditions");
    assert_eq!(message(3), "3 different combinations of stick and slip meet all conditions");
}

/// Thirteen blocks on the ground, without coupling.
fn blocks(recorder: &Recorder) -> SystemEquations<'_> {
    let positions: Vec<_> = (0..13).map(|_| recorder.state()).collect();
    let contact = |_| {
        let speed = recorder.state();
        let [slips, direction] = ["slips", "direction"].map(|name| recorder.input(name));
        let (normal, limit) = (Expression::constant(1.0), Expression::constant(0.5));
        let friction = slips * direction * limit;
        ContactEquations { sliding_speed: speed, sliding_acceleration: -friction, normal, friction }
    };
    let contacts: Vec<_> = positions.iter().map(contact).collect();
    let speeds = contacts.iter().map(|contact| contact.sliding_speed);
    let accelerations = contacts.iter().map(|contact| contact.sliding_acceleration);
    SystemEquations {
        derivative: speeds.chain(accelerations).collect(),
        layout: StateLayout {
            contacts: (0..13).map(|position| ContactLayout { position, angular: false }).collect(),
            velocities: (13..26).map(|component| vec![component]).collect(),
            ..StateLayout::default()
        },
        contacts,
        ..SystemEquations::default()
    }
}

/// Three ways for each of thirteen blocks at rest are more combinations than are tried. That is not a lack of solutions.
#[test]
fn too_many_combinations_are_called_that() {
    let friction = vec![Friction::coulomb(0.5); 13];
    let mut system = OwnSystem::new(blocks, vec![], friction);
    system.unique = false;
    let system = shared(system);
    for method in [Method::Switch, Method::Event] {
        let settings = Settings { method, ..settings() };
        let failure = Motion::new(&system, settings, &[0.0; 26]).err();
        assert_eq!(failure, Some(Failure::TooManyCombinations));
    }
    let evidence = Evidence::Failure(Failure::TooManyCombinations);
    assert_eq!(evidence.name(), "too_many_combinations");
}

/// At the instant of break-away stick and transition both hold, with the same accelerations: that
/// counts as one solution, and the phases are unchanged.
#[test]
fn break_away_is_not_ambiguous() {
    let balancer = Balancer::new(&undecided_machine(3.0)).expect("two balls");
    let mut found = 0;
    for k in 0..2000 {
        let beta = [0.0, 0.003 * f64::from(k)];
        let slip = [Phase::Stick, Phase::Slip(Direction::Forward)];
        let moving = |x: f64| State { beta_dot: [0.0, 0.5], ..at_rest(x, 0.0, beta) };
        let reserve = |x: f64| {
            let state = moving(x);
            let forces = reference::forces(&balancer, &slip, &state);
            stick_reserve(&balancer, &forces, 0)
        };
        let (mut held, mut loose) = (0.0, -0.2);
        if balancer.one_solution_at(&beta) || reserve(held) <= 0.0 || reserve(loose) >= 0.0 {
            continue;
        }
        for _ in 0..100 {
            let middle = 0.5 * (held + loose);
            if reserve(middle) > 0.0 { held = middle } else { loose = middle }
        }
        let (state, mut phases) = (moving(held), Phases::from_slice(&slip));
        let evaluator = Evaluator::new(shared(balancer));
        let components = state.components();
        let held_forces = evaluator.forces(&slip, &components);
        if held_forces.iter().any(|contact| contact.normal <= 0.0) {
            continue;
        }
        assert_eq!(decide(&evaluator, &components, &mut phases), Ok(held_forces));
        assert_eq!(phases[..], slip);
        found += 1;
    }
    assert!(found > 0);
}

/// In the shipped example, most runs with large friction end in `no_solution`, and none with less
/// friction.
#[test]
fn the_example_without_a_unique_solution() {
    let study = shipped_study("no-unique-solution.yaml");
    let (mut none, mut several) = (0, 0);
    for run in 0..study.run_count() {
        let planned = study.planned_run(run);
        let outcome = simulate(&planned.case.expect("a valid case"));
        if let Evidence::Failure(Failure::NoSolution { solutions }) = outcome.evidence {
            assert_eq!(planned.point_id, 1, "less friction always has one solution");
            assert_eq!(outcome.evidence.name(), "no_solution");
            if solutions == 0 { none += 1 } else { several += 1 }
        }
    }
    let words = [0, 1]
        .map(|id| study.point(id).model().ball_balancer().expect("a balancer").existence().word());
    assert_eq!(words, ["unique", "not_unique"]);
    assert!((60..=110).contains(&none) && (25..=65).contains(&several), "{none} {several}");
}

/// If the closed form proves a unique solution, the decision never fails: it is either found, or a
/// contact opens.
#[test]
fn with_one_solution_a_decision_never_fails() {
    let mut opened = 0;
    for k in 0..50_000_u32 {
        let spread = |factor: f64| (f64::from(k) * factor + 0.7).sin();
        let machine = undecided_machine(2.5 + 2.49 * spread(0.9));
        let balancer = Balancer::new(&machine).expect("two balls");
        let beta = [3.0 * spread(1.3), 3.0 * spread(2.7)];
        if !balancer.one_solution_at(&beta) {
            continue;
        }
        let state = at_rest(0.2 * spread(2.1), 0.2 * spread(3.7), beta);
        let mut phases = Phases::from_slice(&[Phase::Stick; 2]);
        let forces = decide(&Evaluator::new(shared(balancer)), &state.components(), &mut phases);
        let forces = forces.unwrap_or_else(|failure| panic!("{k}: {failure}"));
        opened += u32::from(forces.iter().any(|contact| contact.normal <= 0.0));
    }
    assert!(opened > 1000, "{opened}");
}
