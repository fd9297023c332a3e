//! The accuracy of the exact motion's event times, for any steps around them.

use stickslip::model::{Balancer, Contact, Method, State};
use stickslip::motion::{Direction, Phase, fall_through_zero};

use super::samples::{Sampler, difference, moved, settings, stuck_table, two_balls};
use crate::support::reference::{contacts, step, stick_reserve};
use crate::support::{for_each_kernel, go_on, started, state_of};

/// With the finest tolerance, an event is located where its condition has failed by this.
const HALF_WIDTH: f64 = 5e-13;

fn tight() -> stickslip::motion::Settings {
    settings(Method::Event, 1e-13)
}

/// The break-away of the first ball from rest is located at the time of the closed form of the
/// table's motion.
#[test]
fn break_away_is_located_to_1e_12() {
    let mut located = 0;
    for seed in 0..600 {
        let mut sampler = Sampler::new(seed);
        let balancer = Balancer::<3>::new(&sampler.machine(3)).expect("three balls");
        let state = State { beta_dot: [0.0; 3], ..sampler.state(&balancer) };
        let rest = balancer.rest_point(&state.beta);
        // The smallest reserve of any ball, far from zero at first.
        let reserve = |time: f64| {
            let then = stuck_table(&balancer, &rest, &state, time);
            let forces = balancer.forces(&then, &[Contact::STICK; 3]);
            let all = (0..3).map(|ball| stick_reserve(&balancer, &forces, ball));
            all.fold(f64::INFINITY, f64::min)
        };
        if reserve(0.0) < 1e-5 {
            continue;
        }
        let Some(tick) = (1..4000).find(|tick| reserve(0.005 * f64::from(*tick)) < 0.0) else {
            continue;
        };
        let (before, after) = (0.005 * f64::from(tick - 1), 0.005 * f64::from(tick));
        let bracket = |time: f64| (time, reserve(time));
        let expected = fall_through_zero(reserve, bracket(before), bracket(after), 1e-15);
        // At a grazing break-away the time is ill-conditioned.
        let rate = (reserve(expected + 1e-6) - reserve(expected - 1e-6)) / 2e-6;
        if rate > -1e-3 {
            continue;
        }
        for system in for_each_kernel(balancer) {
            let mut motion = started(&system, tight(), &state);
            while !motion.advance(30.0).expect("continues") {}
            let error = motion.time() - expected;
            // The force's rounding error, the slack of a resting ball, and the part of the condition by which it has
            // failed where the event is located, as a time.
            let slack = 2e-13 * (1.0 + balancer.speed * balancer.speed);
            let allowed = 1e-12 + (HALF_WIDTH + slack) / rate.abs();
            assert!(error.abs() < allowed, "{seed}: {error:e} at {expected}, rate {rate:e}");
            located += 1;
        }
    }
    assert!(located > 60, "{located}");
}

/// The time at which a ball stops agrees with a bisection of steps of a fixed small length.
#[test]
fn stops_are_located_to_1e_12() {
    let mut located = 0;
    for seed in 0..200 {
        let mut sampler = Sampler::new(seed);
        let balancer = two_balls(-216.3772);
        let mut state = sampler.state(&balancer);
        state.beta_dot = [sampler.between(0.01, 0.1), -sampler.between(0.01, 0.1)];
        let phases = [Phase::Slip(Direction::Forward), Phase::Slip(Direction::Backward)];
        let contacts = contacts(&balancer, &phases, &state);
        let f = |s: &State<2>| balancer.derivative(s, &contacts, &balancer.forces(s, &contacts));
        let slowest = |s: &State<2>| s.beta_dot[0].min(-s.beta_dot[1]);
        let ahead = |s: &State<2>, length: f64| step(f, s, length);
        let (mut now, mut ticks) = (state, 0);
        while slowest(&now) > 0.0 && ticks < 600 {
            now = ahead(&now, 0.005);
            ticks += 1;
        }
        if slowest(&now) > 0.0 {
            continue;
        }
        let mut before = state;
        (1..ticks).for_each(|_| before = ahead(&before, 0.005));
        let inside = |length: f64| slowest(&ahead(&before, length));
        let last = fall_through_zero(inside, (0.0, inside(0.0)), (0.005, inside(0.005)), 1e-16);
        let expected = 0.005 * f64::from(ticks - 1) + last;
        let rate = (inside(last + 1e-6) - inside(last - 1e-6)) / 2e-6;
        if rate > -1e-3 {
            continue;
        }
        for system in for_each_kernel(balancer) {
            let mut motion = started(&system, tight(), &state);
            while !motion.advance(30.0).expect("continues") {}
            let error = motion.time() - expected;
            let allowed = 1e-12 + (HALF_WIDTH + 1e-14) / rate.abs();
            assert!(error.abs() < allowed, "{seed}: {error:e}, rate {rate:e}");
            let State { beta_dot, .. } = state_of::<2>(&motion);
            assert!(beta_dot.contains(&0.0), "exactly at rest or turning");
            located += 1;
        }
    }
    assert!(located > 100, "{located}");
}

/// A motion continues in the same way if a step ends exactly on an event or one ulp beside it. Where a speed only grazes
/// zero, an event is located with the square root of the width of its condition, 1e-12.
#[test]
fn steps_may_end_on_an_event() {
    let (mut events, mut stops, mut grazed) = (0, 0, 0);
    for seed in 0..60 {
        let mut sampler = Sampler::new(seed);
        let balancer = two_balls(-216.3772);
        let state = sampler.state(&balancer);
        for system in for_each_kernel(balancer) {
            let straight = moved(&system, tight(), state, 6.0);
            let mut motion = started(&system, tight(), &state);
            while motion.time() < 5.0 {
                if !motion.advance(5.0).expect("continues") {
                    continue;
                }
                events += 1;
                let at = motion.time();
                let beside = [at.next_down(), at, at.next_up(), at - 1e-13, at + 1e-13, at - 1e-10];
                for until in beside.into_iter().filter(|until| *until > 0.0) {
                    let mut stopped = moved(&system, tight(), state, until);
                    assert_eq!(stopped.time(), until);
                    // A second call for the same time must change nothing.
                    assert_eq!(stopped.advance(until), Ok(false));
                    go_on(&mut stopped, 6.0);
                    let apart = difference(&straight, &stopped);
                    assert!(
                        apart < 1e-5,
                        "{seed}: {apart:e} after a stop at {until:?}, event at {at:?}"
                    );
                    stops += 1;
                    grazed += usize::from(apart >= 1e-9);
                    assert_eq!(straight.phases(), stopped.phases());
                }
            }
        }
    }
    assert!(events > 100, "{events}");
    assert!(grazed * 100 <= stops, "{grazed} of {stops}");
}

/// For two balls' events in one step, at the same instant and barely apart, in both orders, the
/// result depends only on the interval between them: to the bit in the tuned kernel, which sums over the balls apart
/// from everything else, and to rounding in the general one.
#[test]
fn two_events_in_one_step_may_come_in_either_order() {
    let mut switches = 0;
    for seed in 0..160 {
        let mut sampler = Sampler::new(seed);
        let balancer = two_balls(-191.6372);
        let mut state = sampler.state(&balancer);
        let speed = sampler.one_of(&[0.0, 0.01, 0.1]);
        (state.beta, state.beta_dot) = ([state.beta[0]; 2], [speed; 2]);
        for (kernel, system) in for_each_kernel(balancer).into_iter().enumerate() {
            let together = moved(&system, tight(), state, 4.0);
            let angles = state_of::<2>(&together).beta;
            assert_eq!(angles[0].to_bits(), angles[1].to_bits());
            assert_eq!(
                together.last_switches()[0].to_bits(),
                together.last_switches()[1].to_bits()
            );
            switches += together.effort().switches;
            for apart in [1e-14, 1e-12, 1e-9] {
                let ends = [0, 1].map(|ball| {
                    let mut shifted = state;
                    shifted.beta_dot[ball] += apart;
                    let end = moved(&system, tight(), shifted, 4.0);
                    let off = difference(&end, &together);
                    assert!(off < 1e-10 + 100.0 * apart, "{seed}: {off:e} from {apart:e}");
                    end
                });
                let [first, second] = ends.each_ref().map(state_of::<2>);
                let pairs =
                    [(first.beta[0], second.beta[1]), (first.beta_dot[1], second.beta_dot[0])];
                for (found, expected) in pairs {
                    let same = match kernel {
                        0 => found.to_bits() == expected.to_bits(),
                        _ => (found - expected).abs() < 1e-12,
                    };
                    assert!(same, "{seed} {apart:e}: {found:?} {expected:?} {system:?}");
                }
            }
        }
    }
    assert!(switches > 200, "{switches}");
}

/// A ball whose speed touches zero tangentially continues in the same way whether or not it stops
/// for an instant, and causes few events.
#[test]
fn a_speed_may_touch_zero() {
    let mut touched = 0;
    for seed in 0..300 {
        let mut sampler = Sampler::new(seed);
        let balancer = two_balls(-216.3772);
        let state = sampler.state(&balancer);
        for system in for_each_kernel(balancer) {
            let end = |speed: f64| {
                let start = State { beta_dot: [speed, -1.0], ..state };
                moved(&system, tight(), start, 2.0)
            };
            let (mut stops, mut passes) = (1e-3, 0.3);
            if end(stops).effort().switches == 0 || end(passes).effort().switches > 0 {
                continue;
            }
            for _ in 0..60 {
                let middle = 0.5 * (stops + passes);
                if end(middle).effort().switches > 0 { stops = middle } else { passes = middle }
            }
            let reference = end(passes);
            // Excludes a ball that stops just at the end.
            if end(stops).last_switches()[0] > 1.9 {
                continue;
            }
            touched += 1;
            for off in [0.0, 1e-15, 1e-12, 1e-9, 1e-6] {
                for speed in [stops - off, passes + off] {
                    let motion = end(speed);
                    let apart = difference(&motion, &reference);
                    assert!(apart < 1e-9 + 20.0 * off, "{seed}: {apart:e} from {off:e}");
                    assert!(motion.effort().switches < 8, "{seed}: {:?}", motion.effort());
                }
            }
        }
    }
    assert!(touched > 20, "{touched}");
}
