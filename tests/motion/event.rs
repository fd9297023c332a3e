//! The exact motion: the difficult cases of event-located integration, each by construction.

use std::f64::consts::TAU;

use stickslip::classification::simulate;
use stickslip::model::{Balancer, Case, Contact, Machine, Method, Simulation, State};
use stickslip::motion::{Direction, Phase, Settings};

use super::samples::{Sampler, difference, moved, settings, two_balls};
use crate::support::reference::stick_reserve;
use crate::support::{for_each_kernel, go_on, rest_margin, shipped_study, started, state_of};

fn tight() -> Settings {
    settings(Method::Event, 1e-12)
}

/// At break-away `|f_w| = μ f_n` holds up to rounding. Whether the force is an ulp below or above,
/// its rate decides; all these motions continue in the same way.
#[test]
fn break_away_within_rounding() {
    let balancer = two_balls(-216.3772);
    let mut seen = [0; 4];
    for seed in 0..400 {
        let mut sampler = Sampler::new(seed);
        let beta = [sampler.between(0.0, TAU), sampler.between(0.0, TAU)];
        let rest = balancer.rest_point(&beta).position;
        let angle = sampler.between(0.0, TAU);
        let velocity = [sampler.between(-0.01, 0.01), sampler.between(-0.01, 0.01)];
        let at = |far: f64| {
            let position = [rest[0] + far * angle.cos(), rest[1] + far * angle.sin()];
            State { position, velocity, beta, beta_dot: [0.0; 2] }
        };
        let forces = |state: &State<2>| balancer.forces(state, &[Contact::STICK; 2]);
        let reserve = |state: &State<2>, ball| stick_reserve(&balancer, &forces(state), ball);
        let (mut held, mut loose) = (0.0, 0.05);
        if reserve(&at(held), 0) <= 0.0 || reserve(&at(loose), 0) >= 0.0 {
            continue;
        }
        while 0.5 * (held + loose) != held && 0.5 * (held + loose) != loose {
            let middle = 0.5 * (held + loose);
            if reserve(&at(middle), 0) > 0.0 { held = middle } else { loose = middle }
        }
        let edge = at(held);
        let stick = [Contact::STICK; 2];
        let mut ahead = edge;
        ahead.add_scaled(1e-5, &balancer.derivative(&edge, &stick, &forces(&edge)));
        let rate = (reserve(&ahead, 0) - reserve(&edge, 0)) / 1e-5;
        if rate.abs() < 1e-3 || reserve(&edge, 1) < 1e-3 {
            continue;
        }
        let direction = Direction::of(forces(&edge).friction[0]);
        seen[usize::from(rate > 0.0) + 2 * usize::from(direction == Direction::Forward)] += 1;
        let expected = if rate > 0.0 { Phase::Stick } else { Phase::Slip(direction) };
        for system in for_each_kernel(balancer) {
            let reference = moved(&system, tight(), edge, 1e-3);
            let beside = [held.next_down(), held, loose, loose.next_up()];
            for far in beside.into_iter().chain([held - 1e-15, loose + 1e-15]) {
                let mut motion = started(&system, tight(), &at(far));
                assert_eq!(motion.phases(), [expected, Phase::Stick], "{seed}: {far:e}");
                go_on(&mut motion, 1e-3);
                assert!(difference(&motion, &reference) < 1e-12, "{seed}");
                let speed = direction * state_of::<2>(&motion).beta_dot[0];
                assert!(if rate > 0.0 { speed == 0.0 } else { speed > 0.0 }, "{seed}: {speed:e}");
            }
            // Outside of rounding the value decides, not the rate.
            let phases = [-1e-11, 1e-11]
                .map(|off| started(&system, tight(), &at(held + off)).phases().to_vec());
            let expected = [[Phase::Stick; 2], [Phase::Slip(direction), Phase::Stick]];
            assert_eq!(phases, expected, "{seed}");
        }
    }
    assert!(seen.iter().all(|&count| count > 10), "{seen:?}");
}

/// Balls side by side near the edge of the equilibrium set creep without chattering, by either method.
#[test]
fn creep_does_not_chatter() {
    let balancer = two_balls(-179.2671);
    let margin = |beta: f64| rest_margin(&balancer, &[beta, beta]);
    let (mut edges, mut creeping) = (0, [0; 2]);
    for k in 0..628 {
        let (mut low, mut high) = (0.01 * f64::from(k), 0.01 * f64::from(k + 1));
        if (margin(low) > 0.0) == (margin(high) > 0.0) {
            continue;
        }
        let inside_first = margin(low) > 0.0;
        while 0.5 * (low + high) != low && 0.5 * (low + high) != high {
            let middle = 0.5 * (low + high);
            if (margin(middle) > 0.0) == inside_first { low = middle } else { high = middle }
        }
        edges += 1;
        for offset in [0.0, 1e-12, -1e-12, 1e-9, -1e-9, 1e-6, -1e-6] {
            let beta = [low + offset; 2];
            let position = balancer.rest_point(&beta).position;
            let state = State { position, velocity: [0.0; 2], beta, beta_dot: [0.0; 2] };
            let switch = Settings { band: 1e-4, ..settings(Method::Switch, 1e-9) };
            let ways = [(settings(Method::Event, 1e-8), 3000.0, 1000), (switch, 1000.0, 3000)];
            for ((settings, until, most), creeping) in ways.into_iter().zip(&mut creeping) {
                for system in for_each_kernel(balancer) {
                    let motion = moved(&system, settings, state, until);
                    let effort = motion.effort();
                    let few = effort.switches < most && effort.steps < 30_000;
                    assert!(few, "{offset:e}: {effort:?}");
                    let then = state_of::<2>(&motion);
                    assert_eq!(then.beta[0].to_bits(), then.beta[1].to_bits());
                    // From the other edges they leave permanently once they are outside.
                    *creeping += i32::from((motion.unwrapped()[0] - beta[0]).abs() < 0.1);
                }
            }
        }
    }
    println!("{edges} edges, {creeping:?} motions that stay");
    assert!(edges >= 2 && creeping.iter().all(|stay| *stay >= 14), "{edges} {creeping:?}");
}

/// The shipped study's creeping runs are labelled as such, after a bounded number of events.
#[test]
fn creeping_runs_of_the_shipped_study_are_labelled() {
    let study = shipped_study("preferred-equilibria.yaml");
    for run in [2121, 2244, 2250] {
        let case = study.planned_run(run).case.expect("a valid case");
        let simulation = Simulation { method: Method::Event, ..case.simulation };
        let outcome = simulate(&Case { simulation, ..case });
        assert_eq!(outcome.evidence.name(), "creep", "run {run}");
        assert!(outcome.effort.switches < 3000, "run {run}: {:?}", outcome.effort);
    }
}

/// A table swing just large enough to pull a ball loose at its peaks moves the ball, the less the
/// smaller the excess, and the ball stops soon.
#[test]
fn a_ball_barely_pulled_loose_hardly_moves() {
    let mut tried = 0;
    for seed in 0..30 {
        let mut sampler = Sampler::new(seed);
        let machine = Machine { damping_n_s_m: 0.05, ..Machine::default() };
        let balancer = Balancer::<2>::new(&machine).expect("two balls");
        let beta = [2.27 + sampler.between(-0.2, 0.2), 4.01 + sampler.between(-0.2, 0.2)];
        let rest = balancer.rest_point(&beta).position;
        let angle = sampler.between(0.0, TAU);
        let start = |far: f64| {
            let position = [rest[0] + far * angle.cos(), rest[1] + far * angle.sin()];
            State { position, velocity: [0.0; 2], beta, beta_dot: [0.0; 2] }
        };
        for system in for_each_kernel(balancer) {
            let end = |far: f64| moved(&system, tight(), start(far), 20.0);
            let (mut held, mut loose) = (0.0, 0.03);
            for _ in 0..60 {
                let middle = 0.5 * (held + loose);
                if end(middle).effort().switches == 0 { held = middle } else { loose = middle }
            }
            // The first pull must come later than the start.
            if end(loose).last_switches().iter().all(|&time| time < 0.1) {
                continue;
            }
            tried += 1;
            for over in [0.0, 1e-15, 1e-13, 1e-11, 1e-9, 1e-7, 1e-5] {
                let motion = end(loose * (1.0 + over));
                let way = (0..2).map(|ball| (motion.unwrapped()[ball] - beta[ball]).abs());
                let way = way.fold(0.0, f64::max);
                // The time during which the force exceeds the limit is proportional to the root of the
                // excess.
                assert!(way < 1e-15 + over, "{seed}: {way:e} for {over:e}");
                assert!(motion.effort().switches < 40, "{seed}: {:?}", motion.effort());
            }
        }
    }
    assert!(tried > 20, "{tried}");
}

/// From exactly zero speed or a tiny speed, a ball that friction holds stays or stops immediately;
/// one that it does not hold follows the force, for either sign of the tiny speed.
#[test]
fn starts_near_zero_speed_follow_the_force() {
    let balancer = two_balls(-216.3772);
    let (mut stays, mut goes) = (0, 0);
    for seed in 0..200 {
        let mut sampler = Sampler::new(seed);
        let state = State { beta_dot: [0.0; 2], ..sampler.state(&balancer) };
        let stuck = balancer.forces(&state, &[Contact::STICK; 2]);
        let clear = |ball| stick_reserve(&balancer, &stuck, ball).abs() > 1e-5;
        if !(clear(0) && clear(1)) {
            continue;
        }
        for system in for_each_kernel(balancer) {
            let start = started(&system, tight(), &state);
            for ball in 0..2 {
                let held = stick_reserve(&balancer, &stuck, ball) > 0.0;
                let direction = Direction::of(stuck.friction[ball]);
                let expected = if held { Phase::Stick } else { Phase::Slip(direction) };
                assert_eq!(start.phases()[ball], expected);
                if held { stays += 1 } else { goes += 1 }
            }
            let reference = moved(&system, tight(), state, 1.0);
            for hair in [1e-300, 1e-18, 1e-12] {
                for signs in [[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]] {
                    let beside = State { beta_dot: signs.map(|sign| sign * hair), ..state };
                    let mut motion = started(&system, tight(), &beside);
                    go_on(&mut motion, 1e-6);
                    assert_eq!(motion.phases(), start.phases(), "{seed}: {beside:?}");
                    go_on(&mut motion, 1.0);
                    let apart = difference(&motion, &reference);
                    assert!(apart < 1e-11 + 10.0 * hair, "{seed}: {apart:e} from {hair:e}");
                }
            }
        }
    }
    assert!(stays > 100 && goes > 100, "{stays} {goes}");
}

/// A ball that reverses turns at one instant, without resting; when the speed of a ball that sets
/// off rises through zero, no event occurs.
#[test]
fn reversal_is_one_switch() {
    let mut reversed = 0;
    for seed in 0..200 {
        let mut sampler = Sampler::new(seed);
        let balancer = two_balls(-216.3772);
        let mut state = sampler.state(&balancer);
        state.beta_dot = [0.02, -1.0];
        for system in for_each_kernel(balancer) {
            let mut motion = started(&system, tight(), &state);
            while !motion.advance(3.0).expect("continues") && motion.time() < 3.0 {}
            if motion.phases()[0] != Phase::Slip(Direction::Backward) {
                continue;
            }
            reversed += 1;
            assert_eq!((motion.effort().switches, state_of::<2>(&motion).beta_dot[0]), (1, 0.0));
            assert!(motion.now().forces[0].acceleration < 0.0);
            let time = motion.time();
            // The next step starts from speed zero: a condition that rises through zero is not an
            // event.
            assert_eq!(motion.advance(time + 1e-3), Ok(false));
            assert_eq!((motion.time(), motion.effort().switches), (time + 1e-3, 1));
            assert!(state_of::<2>(&motion).beta_dot[0] < 0.0);
        }
    }
    assert!(reversed > 60, "{reversed}");
}
