//! Irregular motion: a known exponent, exponents from two neighbouring motions, and regular motions
//! with slow separation.

use std::sync::Arc;

use nalgebra::DVector;
use rayon::prelude::*;
use stickslip::analysis::{RestForm, Stability, frictionless_equilibria, state_matrix};
use stickslip::classification::{Label, simulate};
use stickslip::model::{
    Balancer, Case, FrictionLaw, Machine, Method, Simulation, Start, State, System,
};
use stickslip::motion::{Phase, Settings};

use super::outputs::cases;
use super::simulate_all::simulate_all;
use crate::support::{
    cases_of, for_each_kernel, go_on, parse, settings, start_of, started, state_of,
};

/// At an unstable equilibrium with viscous drag only, neighbours separate at the rate of the
/// equations linearised there, an independent formulation (`exp(A t)`). Nothing else happens, so
/// that the motion is not irregular.
#[test]
fn the_exponent_at_an_unstable_equilibrium_is_that_of_the_linearised_equations() {
    let viscous_coefficient_n_s_m = 5e-3;
    let mut compared = 0;
    for speed_rad_s in [-150.0, -178.0, -216.3772, -309.15] {
        let machine = Machine {
            speed_rad_s,
            friction: FrictionLaw::viscous(viscous_coefficient_n_s_m),
            ..Machine::default()
        };
        let natural = machine.natural_frequency_rad_s();
        let drag = viscous_coefficient_n_s_m / (machine.balls[0].mass_kg * natural);
        for equilibrium in frictionless_equilibria(&machine, drag).expect("two balls") {
            let rate = equilibrium.eigenvalues_per_s[0].re;
            // Fast enough to be measured before rounding errors have grown.
            if equilibrium.stability != Stability::Unstable || rate < 1e-3 * natural {
                continue;
            }
            let beta = equilibrium.beta_rad.expect("isolated");
            // All balls are displaced equally, which preserves balls side by side.
            if beta[0] == beta[1] {
                continue;
            }
            let position = equilibrium.position_m.map(|place| place / machine.ring_radius_m);
            let outcome = simulate(&Case {
                model: machine.clone().into(),
                start: Start::of_balancer(position, &beta, [0.0; 2], &[0.0; 2]),
                simulation: Simulation { end_time_s: 24.0 / rate, ..Simulation::default() },
            });
            assert_eq!(outcome.evidence.name(), "end_time", "{speed_rad_s} {:?}", equilibrium.kind);
            let found = outcome.lyapunov.expect("measured");
            let form = RestForm::new(&machine).expect("two balls");
            let matrix = state_matrix(&form, &beta, drag).expect("a rest point");
            let window = found.window_s * natural;
            let is_ball = |row: usize, _| f64::from(u8::from(row == 2 || row == 3));
            let displaced = DVector::from_fn(matrix.nrows(), is_ball);
            let grown = (matrix * window).exp() * &displaced;
            let expected = (grown.norm() / displaced.norm()).ln() / found.window_s;
            let found = found.exponent_1_s;
            println!("{speed_rad_s} {:?}: {found}, {expected}, at last {rate}", equilibrium.kind);
            assert!((found / expected - 1.0).abs() < 1e-9, "{speed_rad_s}: {found}, {expected}");
            compared += 1;
        }
    }
    assert!(compared >= 4, "{compared}");
}

fn add<const N: usize>(state: &State<N>, factor: f64, other: &State<N>) -> State<N> {
    let mut sum = *state;
    sum.add_scaled(factor, other);
    sum
}

fn size<const N: usize>(state: &State<N>) -> f64 {
    let State { position, velocity, beta, beta_dot } = state;
    let all = position.iter().chain(velocity).chain(beta).chain(beta_dot);
    all.map(|value| value * value).sum::<f64>().sqrt()
}

/// Returns the mean rate at which a second motion leaves the first between two times, when it is
/// repeatedly put back near it.
fn side_by_side(
    system: &Arc<dyn System>,
    settings: Settings,
    start: State<2>,
    [begin, end]: [f64; 2],
) -> f64 {
    const NEAR: f64 = 1e-7;
    let mut first = started(system, settings, &start);
    go_on(&mut first, begin);
    let mut apart = State { beta: [1.0; 2], ..State::zero() };
    let mut growth = 0.0;
    let stretches = 400;
    for stretch in 1..=stretches {
        let now = state_of(&first);
        let mut from = add(&now, NEAR / size(&apart), &apart);
        for ball in 0..2 {
            if first.phases()[ball] == Phase::Stick {
                from.beta_dot[ball] = 0.0;
            }
        }
        let before = size(&add(&from, -1.0, &now));
        let mut second = started(system, settings, &from);
        let (begins, turned) = (first.time(), first.unwrapped());
        let began = second.unwrapped();
        let until = begin + f64::from(stretch) / f64::from(stretches) * (end - begin);
        let displaced = from.beta;
        let placed = now.beta;
        go_on(&mut first, until);
        go_on(&mut second, until - begins);
        apart = add(&state_of(&second), -1.0, &state_of(&first));
        for ball in 0..2 {
            let followed = first.unwrapped()[ball] - turned[ball];
            let beside = second.unwrapped()[ball] - began[ball];
            apart.beta[ball] = displaced[ball] - placed[ball] + beside - followed;
        }
        growth += (size(&apart) / before).ln();
    }
    growth / (end - begin)
}

/// At an irregular speed, exponents from the linearised flow and from two neighbouring motions
/// agree over the same window, which begins at the end of a step and is short enough for both
/// kernels to follow the same motion: the neighbours are computed by the other kernel than the run.
#[test]
fn exponents_are_those_of_two_motions_side_by_side() {
    let text = "
schema: 1
name: irregular
seed: 7
model: {kind: ball_balancer, parameters: {speed_rad_s: -191.6372}}
initial_conditions: {design: {latin_hypercube: {samples: 16}}}
simulation: {method: event, end_time_s: 5, tolerance: {relative: 1.0e-12, absolute: 1.0e-14}}
";
    let study = parse(text);
    let compared: Vec<(f64, f64)> = (0..study.run_count())
        .into_par_iter()
        .filter_map(|run| {
            let case = study.planned_run(run).case.expect("valid");
            // If neighbours only converge at first, the measurement ends early.
            let exponent = simulate(&case).lyapunov.filter(|found| found.window_s > 3.7)?;
            let (exponent, window_s) = (exponent.exponent_1_s, exponent.window_s);
            let machine = case.model.ball_balancer().expect("a balancer");
            let natural = machine.natural_frequency_rad_s();
            let balancer = Balancer::<2>::new(machine).expect("two balls");
            let start = start_of(&case.start);
            let end = case.simulation.end_time_s * natural;
            let window = [end - window_s * natural, end];
            let [_, general] = for_each_kernel(balancer);
            Some((
                exponent,
                side_by_side(&general, settings(Method::Event, 1e-12), start, window) * natural,
            ))
        })
        .collect();
    let mut errors: Vec<f64> = compared.iter().map(|(a, b)| (a - b).abs()).collect();
    errors.sort_by(f64::total_cmp);
    println!("{compared:.4?}\ndifferences {errors:?}");
    assert!(compared.len() >= 8, "{}", compared.len());
    // Occasionally two neighbours differ by more than first order, at a switch that one of them
    // barely meets.
    assert!(errors[errors.len() / 2] < 1e-5 && errors[errors.len() - 2] < 1e-4, "{errors:?}");
}

/// Motions that still move but do not separate are not irregular: slow approaches to a cycle, the
/// thesis's orbits with balls side by side, and a ball that advances by a ten-thousandth of a rad
/// per turn of the other.
#[test]
fn motions_that_stay_together_are_not_irregular() {
    let text = "
schema: 1
name: slow
seed: 5
model: {kind: ball_balancer}
sweep: [{grid: {speed_rad_s: [-216.3772, -247.3, -309.15]}}]
initial_conditions: {design: {latin_hypercube: {samples: 64}}}
";
    let study = parse(text);
    let labels = simulate_all(&cases_of(&study)).into_iter().map(|outcome| outcome.label());
    let moving: Vec<Label> = labels.filter(|label| *label != Label::Equilibrium).collect();
    let irregular = moving.iter().filter(|label| **label == Label::Irregular).count();
    println!("{irregular} irregular of {} that move", moving.len());
    assert!(moving.len() >= 40 && irregular <= 1, "{irregular} of {}", moving.len());
}

/// Over few turns, exponents of regular and irregular motion overlap and depend on the tolerance. Such
/// runs are undecided, at every tolerance, and show an exponent. At the end time of the thesis, all but
/// few of the moving runs without contact are irregular, and none with contact, whose motion approaches
/// a limit cycle slowly.
#[test]
fn irregular_motion_needs_many_turns() {
    let labels = |contact: &str, end_time_s: f64, tolerance: f64| {
        let absolute = tolerance / 100.0;
        let text = format!(
            "
schema: 1
name: window
seed: 2003
model: {{kind: ball_balancer, parameters: {{speed_rad_s: -191.6372}}, contact: {contact}}}
initial_conditions: {{design: {{monte_carlo: {{samples: 128}}}}}}
simulation: {{end_time_s: {end_time_s}, tolerance: {{relative: {tolerance:e}, absolute: {absolute:e}}}}}
"
        );
        let study = parse(text);
        let mut outcomes = simulate_all(&cases_of(&study));
        outcomes.retain(|outcome| outcome.label() != Label::Equilibrium);
        for outcome in &outcomes {
            let Some(exponent) = outcome.lyapunov else { continue };
            let irregular = outcome.label() == Label::Irregular;
            let low = exponent.interval_1_s.map_or(f64::NEG_INFINITY, |[low, _]| low);
            assert!(!irregular || exponent.blocks >= 6 && low > 0.0, "{exponent:?}");
            assert_eq!(exponent.interval_1_s.is_none(), exponent.blocks == 1, "{exponent:?}");
        }
        let irregular = outcomes.iter().filter(|outcome| outcome.label() == Label::Irregular);
        let measured = outcomes
            .iter()
            .filter(|outcome| outcome.lyapunov.is_some() || outcome.label() == Label::LimitCycle);
        [irregular.count(), measured.count(), outcomes.len()]
    };
    for (contact, end_time_s) in [("none", 4.0), ("{restitution: 0.36}", 8.0)] {
        for tolerance in [1e-7, 1e-8] {
            let [irregular, measured, moving] = labels(contact, end_time_s, tolerance);
            println!("{contact}, {end_time_s} s: {irregular}, {measured} of {moving}");
            assert!(irregular == 0 && 10 * measured >= 9 * moving && moving >= 100, "{irregular}");
        }
    }
    let [irregular, _, moving] = labels("none", 16.5, 1e-8);
    assert!(10 * irregular >= 8 * moving && moving >= 90, "{irregular} of {moving}");
    let [regular, _, moving] = labels("{restitution: 0.36}", 16.5, 1e-8);
    assert!(regular == 0 && moving >= 120, "{regular} of {moving}");
}

/// A ball jumps irregularly on a plate that vibrates. A second body, which the friction of the impacts moves to and fro, does not act on
/// the ball, so that it changes neither the label nor, by more than the intervals, the exponent. The contact has the position of the second
/// body.
#[test]
fn what_no_contact_moves_along_separates_too() {
    let exponent = |friction: &str| {
        let system = format!(
            "parameters: {{g: 0.15}}
coordinates: {{y: {{start: [3, 5]}}, x: {{start: [0, 1]}}}}
mass: {{y: {{y: 1}}, x: {{x: 1}}}}
force: {{y: -g, x: -x - 0.1 * x'}}
contacts: {{plate: {{gap: y - cos(t), restitution: 0.8{friction}}}}}
period: 2 * pi"
        );
        let mut cases = cases(&system, 2, 3000.0);
        cases.iter_mut().for_each(|case| case.simulation.method = Method::Event);
        cases.iter().map(simulate).collect::<Vec<_>>()
    };
    let with = ", sliding: x', friction: {coulomb: {coefficient: 0.01}}";
    for (without, with) in exponent("").iter().zip(exponent(with)) {
        assert_eq!(with.evidence.label(), Label::Irregular, "{with:?}");
        assert_eq!(without.evidence.label(), Label::Irregular, "{without:?}");
        let [without, with] = [without, &with].map(|outcome| {
            let exponent = outcome.lyapunov.expect("measured");
            exponent.interval_1_s.expect("several blocks")
        });
        assert!(with[0] <= without[1] && without[0] <= with[1], "{with:?}, {without:?}");
    }
}
