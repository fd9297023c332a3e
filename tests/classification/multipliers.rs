//! Floquet multipliers against finite differences of a return map computed from whole motions.

use std::f64::consts::TAU;
use std::sync::Arc;

use nalgebra::{DMatrix, DVector};
use stickslip::classification::{Label, Outcome, simulate};
use stickslip::model::{Balancer, Case, Machine, Method, Simulation, Start, State, System};
use stickslip::motion::{Phase, Settings, Tolerance};

use super::outputs;
use crate::support::{cases_of, parse, shared, start_of, started};

const FINE: Settings = Settings {
    method: Method::Event,
    band: 1e-8,
    tolerance: Tolerance { relative: 1e-12, absolute: 1e-13 },
    effort_limit: 10_000_000,
};

fn flat(state: &State<2>) -> DVector<f64> {
    DVector::from_vec([&state.position[..], &state.velocity, &state.beta, &state.beta_dot].concat())
}

fn state(values: &DVector<f64>) -> State<2> {
    State {
        position: [values[0], values[1]],
        velocity: [values[2], values[3]],
        beta: [values[4], values[5]],
        beta_dot: [values[6], values[7]],
    }
}

/// Returns the state at the next passage of a ball through the angle 0, with angles that include
/// turns.
fn passage(system: &Arc<dyn System>, start: &State<2>, ball: usize) -> (f64, State<2>) {
    let mut start = *start;
    start.beta = start.beta.map(|beta| beta.rem_euclid(TAU));
    start.beta[ball] = 0.0;
    let mut motion = started(system, FINE, &start);
    loop {
        motion.advance(1e3).expect("continues");
        if let Some((time, state)) = motion.passage(ball) {
            let mut state = State::of_components(&state).expect("two balls");
            let end = motion.within_last_step(motion.time()).expect("the step's end");
            let unwrapped = motion.unwrapped();
            state.beta = std::array::from_fn(|i| state.beta[i] + unwrapped[i] - end[4 + i]);
            return (time, state);
        }
    }
}

/// Returns the state on the section of the running ball after many turns of a cycle, and the
/// period.
fn settled(
    system: &Arc<dyn System>,
    outcome: &Outcome,
    start: &State<2>,
) -> (State<2>, usize, f64) {
    let turns = &outcome.evidence.cycle().expect("a cycle").turns;
    let ball = turns.iter().position(|&turns| turns != 0).expect("a ball runs");
    let mut motion = started(system, FINE, start);
    let (end, mut last) = (1e5, None);
    while motion.time() < end || last.is_none() {
        motion.advance(f64::INFINITY).expect("continues");
        if motion.time() > end {
            last = motion.passage(ball);
        }
    }
    let (_, state) = last.expect("a passage");
    let mut state = State::of_components(&state).expect("two balls");
    let mut period = 0.0;
    for _ in 0..200 {
        (period, state) = passage(system, &state, ball);
    }
    (state, ball, period)
}

/// Returns the moduli of the multipliers by central differences of the return map in the given
/// coordinates.
fn by_differences(
    system: &Arc<dyn System>,
    orbit: &State<2>,
    ball: usize,
    coordinates: &[usize],
) -> Vec<f64> {
    let step = 1e-6;
    let mut slope = DMatrix::zeros(coordinates.len(), coordinates.len());
    for (column, &coordinate) in coordinates.iter().enumerate() {
        let shifted = |step: f64| {
            let mut values = flat(orbit);
            values[coordinate] += step;
            flat(&passage(system, &state(&values), ball).1)
        };
        let change = (shifted(step) - shifted(-step)) / (2.0 * step);
        for (row, &coordinate) in coordinates.iter().enumerate() {
            slope[(row, column)] = change[coordinate];
        }
    }
    let mut moduli: Vec<f64> =
        slope.complex_eigenvalues().iter().map(|value| value.norm()).collect();
    moduli.sort_by(|a, b| b.total_cmp(a));
    moduli
}

fn case(speed_rad_s: f64, friction: [f64; 2], beta_dot: [f64; 2], method: Method) -> Case {
    let mut machine = Machine { speed_rad_s, ..Machine::default() };
    for (ball, coefficient) in machine.balls.iter_mut().zip(friction) {
        ball.friction_coefficient = coefficient;
    }
    Case {
        model: machine.into(),
        start: Start::of_balancer([0.01, 0.0], &[1.0, 3.3], [0.0, 0.01], &beta_dot),
        simulation: Simulation { method, end_time_s: 66.0, ..Simulation::default() },
    }
}

/// The multipliers are those of the return map for a ball that slips without stopping beside one
/// that swings, sticks twice a turn, or rests.
#[test]
fn multipliers_are_those_of_the_return_map() {
    for (speed, friction, configurations, neutral) in [
        (-216.3772, [2.75e-4; 2], 2, 0),
        (-247.3, [2.75e-3; 2], 4, 0),
        (-247.3, [1e-3, 2e-2], 1, 1),
    ] {
        let case = case(speed, friction, [0.5, 0.0], Method::Event);
        let outcome = simulate(&case);
        assert_eq!(outcome.evidence.name(), "closed_orbit", "{speed} {friction:?}");
        let cycle = outcome.evidence.cycle().expect("a cycle");
        assert_eq!(cycle.turns, [1, 0], "{speed}");
        assert_eq!(cycle.configurations.len(), configurations, "{:?}", cycle.configurations);
        assert_eq!(cycle.neutral_directions, neutral);
        let machine = case.model.ball_balancer().expect("a balancer");
        let natural = machine.natural_frequency_rad_s();
        let system = shared(Balancer::<2>::new(machine).expect("two balls"));
        let start = start_of(&case.start);
        let (orbit, ball, period) = settled(&system, &outcome, &start);
        let period_s = outcome.evidence.period_s().expect("a period");
        // With a neutral direction the period depends on where the other ball rests.
        assert!(
            (period / natural / period_s - 1.0).abs() < 1e-6,
            "{} {period_s}",
            period / natural
        );
        let mut motion = started(&system, FINE, &orbit);
        motion.advance(1e-3).expect("continues");
        // The running ball's angle is excluded; the other ball's speed is included if it moves, and
        // its angle always.
        let mut coordinates = vec![0, 1, 2, 3, 6];
        if motion.phases()[1] != Phase::Stick {
            coordinates.push(7);
        }
        coordinates.push(5);
        let mut expected = cycle.multipliers.clone();
        expected.extend(std::iter::repeat_n(1.0, neutral.into()));
        expected.sort_by(|a, b| b.total_cmp(a));
        let found = by_differences(&system, &orbit, ball, &coordinates);
        println!("{speed} rad/s, {friction:?}: {found:.7?}");
        assert_eq!(found.len(), expected.len());
        for (found, expected) in found.iter().zip(&expected) {
            assert!((found - expected).abs() < 1e-4, "{speed}: {found:?} {expected:?}");
        }
    }
}

/// A mass that a controller with an integral and a lag moves to and fro on the ground: the cycle and its only multiplier other than 0 do
/// not depend on the start state, although some runs mark the section in a step that ends where the mass stops. The multiplier
/// is that of an integration with SciPy (finite differences of the map from stop to stop).
#[test]
fn the_multiplier_of_a_hunting_controller_does_not_depend_on_the_section() {
    let system = "parameters: {m: 1, k_p: 4, k_i: 1, k_d: 2, mu: 1, mu_static: 1.5, v_str: 0.05, lag: 1}
coordinates: {x: {start: [-1, 1], start_rate: 0}, i: {start: [-1, 1], start_rate: 0}}
mass: {x: {x: m}, i: {i: lag}}
force: {x: -k_p * x - k_i * i - k_d * x', i: x - i'}
contacts: {ground: {normal: 1, sliding: x', friction: {stribeck: {coefficient: mu, static_coefficient: mu_static, stribeck_speed: v_str}}}}";
    let mut cycles = 0;
    for case in outputs::cases(system, 16, 4000.0) {
        for method in [Method::Event, Method::Switch] {
            let simulation = Simulation { method, ..case.simulation };
            let outcome = simulate(&Case { simulation, ..case.clone() });
            let Some(cycle) = outcome.evidence.cycle() else { continue };
            assert_eq!(outcome.evidence.name(), "closed_orbit", "{outcome:?}");
            assert!((cycle.multipliers[0] - 0.301_949).abs() < 2e-6, "{cycle:?}");
            assert!(cycle.multipliers[1] < 1e-6, "{cycle:?}");
            cycles += 1;
        }
    }
    assert!(cycles >= 30, "{cycles}");
}

/// Two blocks on a belt that start alike stick, break away and stop together, and neighbours do so one after the other. A difference
/// `d` of their places keeps its speed zero in stick. The one block breaks away later by `(k + 2 c) d / (k v)` with the stiffness
/// `c` between them, and loses the speed `F / m` per time before the other one does, with the jump `F` of friction. In slip the
/// difference is an oscillation with the frequency of `k + 2 c`. The blocks move as one block does, whose own multiplier is 0.
#[test]
fn contacts_that_switch_together_switch_one_after_another_nearby() {
    let couplings = [0.0_f64, 1.0, 5.0, 20.0, 50.0, 120.0];
    let (stiffness, belt_speed, jump) = (100.0_f64, 0.1, 1.0);
    let angle = (jump / (stiffness.sqrt() * belt_speed)).atan();
    let slips = 2.0 * (std::f64::consts::PI - angle) / stiffness.sqrt();
    for (method, accuracy) in [("event", 1e-7), ("switch", 1e-4)] {
        let study = parse(format!(
            "schema: 1\nname: a\nseed: 1\nmodel: {{system: systems/block_chain.yaml, parameters: {{blocks: 2}}}}\n\
             sweep: [{{grid: {{coupling_stiffness_n_m: {couplings:?}}}}}]\n\
             initial_conditions: {{design: {{monte_carlo: {{samples: 1}}}}, box: {{x_1_m: [0.05, 0.05], x_2_m: [0.05, 0.05], \
             x_rate_1_m_s: [0, 0], x_rate_2_m_s: [0, 0]}}}}\n\
             simulation: {{method: {method}, end_time_s: 100}}\n"
        ));
        for (case, coupling) in cases_of(&study).iter().zip(couplings) {
            let outcome = simulate(case);
            let frequency = (stiffness + 2.0 * coupling).sqrt();
            let (sine, cosine) = (frequency * slips).sin_cos();
            let parted = jump * (stiffness + 2.0 * coupling) / (stiffness * belt_speed);
            let expected = (cosine - parted * sine / frequency).abs();
            let found = &outcome.evidence.cycle().expect("a cycle").multipliers;
            let largest = found.first().copied().unwrap_or(f64::NAN);
            assert!(
                (largest - expected).abs() < accuracy,
                "{method} {coupling}: {found:?} {expected}"
            );
            let label = match expected {
                _ if coupling == 0.0 => Label::Periodic,
                _ if expected < 1.0 => Label::LimitCycle,
                _ => Label::Undecided,
            };
            assert_eq!(outcome.label(), label, "{method} {coupling}: {outcome:?}");
        }
    }
}
