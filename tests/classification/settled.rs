//! Settled runs are claimed if and only if the run has come to a stable equilibrium without dry
//! friction.

use std::f64::consts::TAU;

use crate::support::{Block, Ground};
use rayon::prelude::*;
use stickslip::analysis::{FrictionlessEquilibrium, Stability, frictionless_equilibria};
use stickslip::classification::{Outcome, simulate};
use stickslip::model::{
    Balancer, Ball, BallContact, Case, FrictionLaw, Machine, Model, Simulation, Start, State,
    Tolerance,
};
use stickslip::motion::Settings;

use crate::support::{angular_distance, go_on, shared, start_of, started, state_of};

fn run(model: impl Into<Model>, start: &Start, end_time_s: f64) -> Outcome {
    let simulation = Simulation { end_time_s, ..Simulation::default() };
    simulate(&Case { model: model.into(), start: start.clone(), simulation })
}

/// Simulates with errors far below the speed at which a steep law bends.
fn run_finely(model: impl Into<Model>, start: &Start, end_time_s: f64) -> Outcome {
    let tolerance = Tolerance { relative: 1e-12, absolute: 1e-20 };
    let simulation = Simulation { end_time_s, tolerance, ..Simulation::default() };
    simulate(&Case { model: model.into(), start: start.clone(), simulation })
}

fn viscous(speed_rad_s: f64, balls: usize, viscous_coefficient_n_s_m: f64) -> Machine {
    Machine {
        speed_rad_s,
        balls: vec![Ball::default(); balls],
        friction: FrictionLaw::viscous(viscous_coefficient_n_s_m),
        ..Machine::default()
    }
}

/// Returns the equilibria of a machine with viscous friction, with the stability for its drag.
fn equilibria(machine: &Machine) -> Vec<FrictionlessEquilibrium> {
    let drag = machine.friction.value("viscous_coefficient_n_s_m").expect("viscous drag");
    let unit = machine.balls[0].mass_kg * machine.natural_frequency_rad_s();
    frictionless_equilibria(machine, drag / unit).expect("balls")
}

fn apart(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| angular_distance(*a, *b)).fold(0.0, f64::max)
}

/// Returns a start state with table and balls at rest at these angles.
fn resting<const N: usize>(machine: &Machine, beta: [f64; N]) -> Start {
    let [x, y] = Balancer::<N>::new(machine).expect("balls").rest_point(&beta).position;
    Start::of_balancer([x, y], &beta, [0.0; 2], &[0.0; N])
}

/// Returns the positions of the balls at a time in the further motion, and the speed of the fastest
/// ball.
fn later<const N: usize>(machine: &Machine, start: &Start, time_s: f64) -> ([f64; N], f64) {
    let balancer = Balancer::<N>::new(machine).expect("balls");
    let settings = Settings::new(&Simulation::default(), u64::MAX);
    let state: State<N> = start_of(start);
    let mut motion = started(&shared(balancer), settings, &state);
    go_on(&mut motion, time_s * machine.natural_frequency_rad_s());
    let State { beta, beta_dot, .. }: State<N> = state_of(&motion);
    (beta, beta_dot.map(f64::abs).into_iter().fold(0.0, f64::max))
}

/// Returns start states distributed over the box.
fn start<const N: usize>(k: u32) -> Start {
    let spread = |factor: f64| (f64::from(k + 1) * factor + 0.37).fract();
    let beta: [f64; N] =
        std::array::from_fn(|ball| TAU * spread(0.754_877_666 + 0.1137 * ball as f64));
    let beta_dot: [f64; N] =
        std::array::from_fn(|ball| spread(0.569_840_291 + 0.0731 * ball as f64) - 0.5);
    let table = [0.618_034, 0.414_214, 0.302_776, 0.236_068].map(|f| 0.05 * (spread(f) - 0.5));
    Start::of_balancer([table[0], table[1]], &beta, [table[2], table[3]], &beta_dot)
}

/// Every claim for two balls with viscous friction is a stable equilibrium of the closed forms, and
/// after ten times the time the balls are still there, at rest. The other runs are cycles.
#[test]
fn claims_are_stable_equilibria_and_last() {
    let cases: Vec<(f64, u32)> = [-150.0, -170.0, -216.3772, -260.0, -309.15]
        .into_iter()
        .flat_map(|speed| (0..6).map(move |k| (speed, k)))
        .collect();
    let claimed: usize = cases
        .par_iter()
        .map(|&(speed, k)| {
            let (machine, start) = (viscous(speed, 2, 5e-4), start::<2>(k));
            let outcome = run(machine.clone(), &start, 60.0);
            if outcome.evidence.name() != "settled" {
                assert_eq!(outcome.evidence.name(), "closed_orbit", "{speed}, start {k}");
                return 0;
            }
            let (position, time) =
                (outcome.position.clone().expect("known"), outcome.end_time_s.expect("known"));
            assert_eq!(outcome.evidence.friction_margin(), None);
            assert!(outcome.time_to_rest_s().expect("at rest") <= time);
            let mut sorted = position.clone();
            sorted.sort_by(f64::total_cmp);
            let stable = |rest: &&FrictionlessEquilibrium| rest.stability == Stability::Stable;
            let near = equilibria(&machine)
                .iter()
                .filter(stable)
                .any(|rest| apart(rest.beta_rad.as_ref().expect("angles"), &sorted) < 1e-3);
            assert!(near, "{speed} {sorted:?}");
            let (beta, fastest) = later::<2>(&machine, &start, 10.0 * time);
            assert!(apart(&beta, &position) < 1e-3 && fastest < 1e-9, "{speed} {beta:?} {fastest}");
            1
        })
        .sum();
    assert!((15..30).contains(&claimed), "{claimed} of {}", cases.len());
}

/// Above the natural frequency, balls exactly side by side approach an equilibrium from which any
/// disturbance separates them, so that it is not claimed.
#[test]
fn balls_side_by_side_do_not_settle_above_the_natural_frequency() {
    for (speed, settles) in [(-150.0, true), (-216.3772, false), (-309.15, false)] {
        let machine = viscous(speed, 2, 5e-3);
        let start = Start::of_balancer([0.01, 0.0], &[0.3; 2], [0.0; 2], &[0.1; 2]);
        let outcome = run(machine.clone(), &start, 30.0);
        let (beta, fastest) = later::<2>(&machine, &start, 30.0);
        assert!(beta[0].to_bits() == beta[1].to_bits() && fastest < 1e-8, "{beta:?} {fastest}");
        assert_eq!(outcome.evidence.name() == "settled", settles, "{speed}");
    }
}

/// From rest at and near any equilibrium of the closed forms, stable equilibria are claimed
/// immediately, and unstable ones never, however short the run.
#[test]
fn only_stable_equilibria_are_claimed() {
    let mut seen = [0, 0];
    for coefficient in [5e-4, 5e-2] {
        for speed in [-150.0, -178.0, -186.0, -216.3772, -309.15] {
            let machine = viscous(speed, 2, coefficient);
            for rest in equilibria(&machine) {
                let Some(&[first, second]) = rest.beta_rad.as_deref() else { panic!("isolated") };
                for (aside, at_once) in [(0.0, true), (1e-8, true), (1e-5, false)] {
                    let start = resting(&machine, [first + aside, second - 0.7 * aside]);
                    let outcome = run(machine.clone(), &start, 0.2);
                    let claimed = outcome.evidence.name() == "settled";
                    let stable = rest.stability == Stability::Stable;
                    seen[usize::from(stable)] += 1;
                    if at_once || !stable {
                        assert_eq!(claimed, stable, "{speed} {rest:?} {aside}");
                    }
                }
            }
        }
    }
    assert!(seen[0] > 60 && seen[1] > 20, "{seen:?}");
}

/// A steep smooth law lets balls and blocks creep very slowly at any position; such creep is not an
/// equilibrium.
#[test]
fn slow_creep_is_not_settled() {
    let coulomb = Machine::default();
    let beta = [1.9, 4.4];
    let balancer = Balancer::<2>::new(&coulomb).expect("two balls");
    assert!(balancer.friction_use(&balancer.rest_point(&beta), 0.0) < 0.9);
    for (smoothing_speed, end) in [(1e-4, 0.5), (1e-6, 5e-3), (1e-9, 5e-6), (1e-13, 1e-9)] {
        let friction = FrictionLaw::smooth(smoothing_speed);
        let machine = Machine { friction, ..Machine::default() };
        let (state, fastest) = later::<2>(&machine, &resting(&machine, beta), end);
        assert!(apart(&state, &beta) < 1e-3 && fastest < 1e-6, "slow: {fastest}");
        let outcome = run_finely(machine.clone(), &resting(&machine, beta), end);
        assert_eq!(outcome.evidence.name(), "end_time", "{smoothing_speed}");
        // A stable equilibrium is claimed, unless the approach is so slow that its sign is below
        // the accuracy of the differences.
        if smoothing_speed > 1e-5 {
            let balanced = [2.269_8, 4.013_4];
            let outcome = run_finely(machine.clone(), &resting(&machine, balanced), end);
            assert_eq!(outcome.evidence.name(), "settled", "{smoothing_speed}");
        }
        let unstable = equilibria(&viscous(-216.3772, 2, 1.0));
        let unstable = unstable.iter().filter(|rest| rest.stability == Stability::Unstable);
        for rest in unstable {
            let beta = [0, 1].map(|ball| rest.beta_rad.as_ref().expect("angles")[ball]);
            let outcome = run_finely(machine.clone(), &resting(&machine, beta), end);
            assert_eq!(outcome.evidence.name(), "end_time", "{smoothing_speed} {rest:?}");
        }
    }
    for (friction, end) in [
        (FrictionLaw::smooth(1e-8), 1e-4),
        (FrictionLaw::smooth(1e-6), 1e-2),
        (FrictionLaw::viscous(1e7), 1e-3),
    ] {
        let block = Block { friction, ..Block::on_spring() };
        for (place, evidence) in [(0.003, "end_time"), (3e-5, "settled")] {
            let outcome = run_finely(block.clone(), &Start(vec![place, 0.0]), end);
            assert_eq!(outcome.evidence.name(), evidence, "{friction:?} {place}");
        }
    }
}

/// Just before the two equilibria with the balls side by side meet and vanish, their distance is
/// below the search radius. From the far side of the unstable one, the stable one is not claimed.
#[test]
fn beyond_a_nearby_unstable_equilibrium_nothing_is_claimed() {
    let together = |speed: f64| {
        let machine = viscous(speed, 2, 5e-2);
        let found = equilibria(&machine);
        let angle = |kind: &str| {
            let rest = found.iter().find(|rest| rest.kind.name() == kind)?;
            Some((rest.beta_rad.as_ref()?[0], rest.stability))
        };
        Some((angle("a1_plus")?, angle("a1_minus")?))
    };
    let (mut there, mut gone) = (-179.0, -180.0);
    while let Some((stable, unstable)) = together(there)
        && angular_distance(stable.0, unstable.0) > 6e-4
    {
        let middle = 0.5 * (there + gone);
        match together(middle) {
            Some((stable, unstable)) if angular_distance(stable.0, unstable.0) > 3e-4 => {
                there = middle
            }
            _ => gone = middle,
        }
    }
    let (stable, unstable) = together(there).expect("not gone");
    assert_eq!((stable.1, unstable.1), (Stability::Stable, Stability::Unstable));
    let machine = viscous(there, 2, 5e-2);
    let way = (unstable.0 - stable.0 + 1.0).rem_euclid(TAU) - 1.0;
    for (fraction, claimed) in
        [(0.0, true), (-0.02, true), (1.0, false), (1.3, false), (1.5, false)]
    {
        let outcome = run(machine.clone(), &resting(&machine, [stable.0 + fraction * way; 2]), 1.0);
        assert_eq!(outcome.evidence.name() == "settled", claimed, "{fraction}");
    }
}

/// Three or more balls balance in families of positions, and settle at one of them if drag stops
/// the balls along the family.
#[test]
fn runs_settle_in_families_of_equilibria() {
    fn check<const N: usize>() {
        let machine = viscous(-309.15, N, 2e-3);
        for k in 0..2 {
            let outcome = run(machine.clone(), &start::<N>(k), 60.0);
            assert_eq!(outcome.evidence.name(), "settled", "{N} balls, start {k}");
            assert!(outcome.amplitude_m.unwrap() < 1e-7);
            let time = outcome.end_time_s.unwrap();
            let (beta, _) = later::<N>(&machine, &start::<N>(k), 10.0 * time);
            assert!(apart(&beta, &outcome.position.unwrap()) < 1e-3);
        }
        let family = equilibria(&machine);
        let family = family.iter().find(|rest| rest.family_dimension > 0).expect("balanced");
        let beta: [f64; N] = std::array::from_fn(|ball| family.beta_rad.as_ref().unwrap()[ball]);
        for (coefficient, expected) in [(2e-3, "settled"), (0.0, "end_time")] {
            let machine = viscous(-309.15, N, coefficient);
            let outcome = run(machine.clone(), &resting(&machine, beta), 0.5);
            assert_eq!(outcome.evidence.name(), expected, "{N} balls, {coefficient} N s/m");
        }
    }
    check::<3>();
    check::<4>();
}

/// Blocks settle at the time at which the closed form of a damped oscillator becomes slow; steady
/// sliding on a belt settles if friction grows with speed, and not if it decreases.
#[test]
fn blocks_settle() {
    // x'' + 2 ζ x' + x = 0 with ζ = 0.05, from 0.1: the amplitude e^{-ζ t} is slow after 230 units
    // of time. Speed is sampled once a step, a quarter of a period: one of two successive samples
    // is at least 1/√2 of its peak, so that the detection may be early by ln √2 / ζ = 7 units and
    // two steps, 1 s in all.
    let damped = FrictionLaw::viscous(1.0);
    let block = Block { friction: damped, ..Block::on_spring() };
    let outcome = run(block.clone(), &Start(vec![0.01, 0.0]), 200.0);
    assert_eq!(outcome.evidence.name(), "settled");
    let slow = (1e5_f64).ln() / 0.05 / 10.0;
    let found = outcome.time_to_rest_s().expect("settled");
    assert!((slow - 1.0..slow + 0.2).contains(&found), "{found} for {slow}");
    assert!(outcome.end_time_s.unwrap() < 1.6 * slow);
    // A run that ends soon afterwards is examined at its end. Its steps are different.
    for end in [23.5, 27.0, 31.0, 40.0] {
        let outcome = run(block.clone(), &Start(vec![0.01, 0.0]), end);
        assert_eq!(outcome.evidence.name(), "settled", "{end}");
        let found = outcome.time_to_rest_s().expect("settled");
        assert!((slow - 1.0..slow + 0.2).contains(&found), "{found} for {slow}");
    }
    let belt = |friction| Block { friction, ..Block::on_belt() };
    let rising = FrictionLaw::smooth(0.1);
    let falling = FrictionLaw::stribeck(0.3, 0.1);
    let balance = |law: FrictionLaw| match law.name() {
        "smooth" => 0.01 * 0.5,
        _ => 0.01 * (1.0 + 2.0 * (-1.0_f64).exp()),
    };
    let undamped = FrictionLaw::viscous(0.0);
    for (law, place, evidence) in [
        (rising, balance(rising), "settled"),
        (falling, balance(falling), "end_time"),
        (undamped, 0.0, "end_time"),
        (FrictionLaw::COULOMB, 0.01, "end_time"),
    ] {
        assert!(matches!(belt(law).ground, Ground::Belt { speed_m_s: 0.1 }));
        let outcome = run(belt(law), &Start(vec![place, 0.0]), 5.0);
        assert_eq!(outcome.evidence.name(), evidence, "{law:?}");
    }
}

/// Balls that touch settle together, where the closed form for a row of balls has its stable equilibrium.
#[test]
fn balls_that_touch_settle_in_a_row() {
    for (speed, balls) in [(-150.0, 2), (-170.0, 3)] {
        let contact = BallContact { restitution: 0.4, friction_coefficient: 0.0 };
        let machine = Machine { contact: Some(contact), ..viscous(speed, balls, 1e-3) };
        let known = equilibria(&machine);
        let mut stable = known.iter().filter(|rest| rest.stability == Stability::Stable);
        let row = stable.next().unwrap();
        assert!(stable.next().is_none(), "{known:?}");
        let row = row.beta_rad.clone().unwrap();
        let (shift, touching) =
            (0.3, machine.contact_angle_rad(&machine.balls[0], &machine.balls[1]));
        for gap in [1e-3, 0.4] {
            let beta: Vec<f64> =
                (0..balls).map(|ball| row[0] + shift + (touching + gap) * ball as f64).collect();
            let start = Start::of_balancer([0.0; 2], &beta, [0.0; 2], &vec![0.0; balls]);
            let outcome = run(machine.clone(), &start, 60.0);
            assert_eq!(outcome.evidence.name(), "settled", "{outcome:?}");
            let contact = outcome.touching.unwrap();
            assert!(contact.at_end && contact.impacts > 0, "{contact:?}");
            let mut found = outcome.position.unwrap().to_vec();
            let mut expected = row.clone();
            found.sort_by(f64::total_cmp);
            expected.sort_by(f64::total_cmp);
            assert!(apart(&found, &expected) < 1e-3, "{found:?} {expected:?}");
        }
    }
}
