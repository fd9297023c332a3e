//! Claimed limit cycles attract the run: both methods claim the same cycles, and the further motion
//! passes ever more exactly one period later.

use rayon::prelude::*;
use stickslip::classification::Outcome;
use stickslip::model::{Case, Method, Simulation};
use stickslip::motion::{Motion, Settings};

use super::simulate_all::simulate_all;
use crate::support::shipped_study;

/// The runs with a tenth of the friction in the thesis's study.
fn cases() -> Vec<Case> {
    let study = shipped_study("preferred-equilibria.yaml");
    let all = (0..study.run_count()).filter_map(|run| study.planned_run(run).case.ok());
    let slippery = |case: &Case| {
        let machine = case.model.ball_balancer().expect("a balancer");
        machine.balls.iter().all(|ball| ball.friction_coefficient == 2.75e-4)
    };
    all.filter(slippery).collect()
}

fn with(case: &Case, method: Method) -> Case {
    Case { simulation: Simulation { method, ..case.simulation }, ..case.clone() }
}

/// Returns the differences between passages one period apart, in the table's state, the running
/// ball's speed, and time over the period, immediately after the claim and at the end.
fn drawn(case: &Case, outcome: &Outcome) -> ([f64; 2], f64) {
    let machine = case.model.ball_balancer().expect("a balancer");
    let natural = machine.natural_frequency_rad_s();
    let system = case.model.system().expect("two balls");
    let settings = Settings::new(&case.simulation, u64::MAX);
    let start = case.model.start_state(&case.start).expect("two balls");
    let mut motion = Motion::new(&system, settings, &start).expect("starts");
    let period = outcome.evidence.period_s().expect("a cycle") * natural;
    let speeds = outcome.mean_speed.as_ref().expect("a cycle");
    let runs = usize::from(speeds[1].abs() > speeds[0].abs());
    let turns = (speeds[runs].abs() / natural * period / std::f64::consts::TAU).round() as usize;
    let claimed = outcome.end_time_s.expect("ended") * natural;
    let end = claimed + 60.0 * natural;
    let mut passages = Vec::new();
    while motion.time() < end {
        motion.advance(end).expect("continues");
        if motion.time() > claimed - 1.5 * period
            && let Some((time, state)) = motion.passage(runs)
        {
            let [x, y, x_dot, y_dot] = [0, 1, 2, 3].map(|component| state[component]);
            passages.push((time, [x, y, x_dot, y_dot, state[6 + runs]]));
        }
    }
    let apart = |later: usize| {
        let (before, after) = (&passages[later - turns].1, &passages[later].1);
        before.iter().zip(after).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    };
    let last = passages.len() - 1;
    let taken = passages[last].0 - passages[last - turns].0;
    ([apart(turns), apart(last)], taken / period - 1.0)
}

#[test]
fn claimed_cycles_attract_the_run_and_methods_agree() {
    let cases = cases();
    assert_eq!(cases.len(), 256);
    let claims = [Method::Switch, Method::Event].map(|method| {
        let cases: Vec<Case> = cases.iter().map(|case| with(case, method)).collect();
        let outcomes = simulate_all(&cases);
        let claim = |(case, outcome): (Case, Outcome)| {
            (outcome.evidence.name() == "closed_orbit").then_some((case, outcome))
        };
        cases.into_iter().zip(outcomes).map(claim).collect::<Vec<_>>()
    });
    let [switch, event] = &claims;
    let mut claimed = 0;
    for (index, both) in switch.iter().zip(event).enumerate() {
        match both {
            (Some((_, switch)), Some((_, event))) => {
                claimed += 1;
                assert_eq!(switch.balls_running, event.balls_running, "run {index}");
                let ratio = switch.evidence.period_s().expect("a cycle")
                    / event.evidence.period_s().expect("a cycle");
                assert!((ratio - 1.0).abs() < 1e-4, "run {index}: {ratio}");
            }
            (None, None) => {}
            _ => panic!("run {index} by one method only"),
        }
    }
    assert_eq!(claimed, 70);
    let some: Vec<_> = claims.iter().flatten().flatten().step_by(3).collect();
    some.par_iter().for_each(|(case, outcome)| {
        let ([first, last], late) = drawn(case, outcome);
        assert!(first < 1e-3 && last < 1e-9, "{first} to {last}");
        assert!(late.abs() < 1e-5, "{late}");
    });
}
