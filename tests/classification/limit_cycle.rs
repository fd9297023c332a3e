//! Claimed limit cycles persist.

use stickslip::classification::{Label, simulate};
use stickslip::model::{Balancer, Method, State};
use stickslip::motion::Settings;

use super::simulate_all::simulate_all;
use crate::support::{cases_of, go_on, parse, shared, start_of, started, state_of};

/// At -247.3 rad/s runs approach the cycle in a spiral of nearly five turns, so that they appear to
/// close after five turns long before they appear to close after one. For any start, method and
/// tolerance (which changes the steps), the claimed cycle has one turn.
#[test]
fn a_period_is_not_taken_for_its_multiple() {
    let text = "
schema: 1
name: cycles
seed: 3
model: {kind: ball_balancer, parameters: {speed_rad_s: -247.3}}
initial_conditions: {design: {latin_hypercube: {samples: 32}}}
simulation: {end_time_s: 66}
";
    let mut cases = cases_of(&parse(text));
    let ways = [
        (Method::Switch, 1e-8),
        (Method::Event, 1e-8),
        (Method::Switch, 1e-6),
        (Method::Switch, 1e-5),
        (Method::Event, 1e-3),
    ];
    for (method, relative_tolerance) in ways {
        for case in &mut cases {
            case.simulation.method = method;
            case.simulation.tolerance.relative = relative_tolerance;
        }
        let mut claimed = simulate_all(&cases);
        claimed.retain(|outcome| outcome.label() == Label::LimitCycle);
        assert!(claimed.len() >= 5, "{method:?}: {} cycles", claimed.len());
        for outcome in claimed {
            let cycle = outcome.evidence.cycle().expect("a cycle");
            let runner = usize::from(cycle.turns[0] == 0);
            assert_eq!((cycle.turns[runner], cycle.turns[1 - runner]), (1, 0));
            assert_eq!(outcome.balls_running, Some(1));
            let speed = outcome.mean_speed.expect("speeds")[runner];
            assert!((speed - 70.170_887).abs() < 2e-5, "{speed}");
            let period = outcome.evidence.period_s().expect("a period");
            assert!((period * speed - std::f64::consts::TAU).abs() < 1e-9, "{period}");
            // The other ball slips forward and back and sticks in between, within a degree.
            assert_eq!(cycle.configurations.len(), 4);
            let place = outcome.position.expect("angles")[1 - runner];
            assert!((place - 3.1545).abs() < 0.02, "{place}");
        }
    }
}

/// A second ball with more friction rests anywhere in an interval: such cycles form a family with
/// one neutral direction. The ball rests permanently: its position is constant bit for bit in ten
/// times the time. With slightly more friction than the minimum, it slips occasionally, less and
/// less often, until it rests.
#[test]
fn a_ball_that_rests_beside_a_running_one_rests() {
    ["2.0e-2", "3.5e-3"].into_iter().for_each(resting_beside_a_running_one);
}

fn resting_beside_a_running_one(friction: &str) {
    let text = format!(
        "
schema: 1
name: cycles
seed: 5
model:
  kind: ball_balancer
  parameters:
    speed_rad_s: -247.3
    balls: [{{friction_coefficient: 1.0e-3}}, {{friction_coefficient: {friction}}}]
initial_conditions: {{design: {{latin_hypercube: {{samples: 64}}}}}}
"
    );
    let mut places = Vec::new();
    for case in cases_of(&parse(text)) {
        let outcome = simulate(&case);
        let Some(cycle) = outcome.evidence.cycle().filter(|_| outcome.label() == Label::LimitCycle)
        else {
            continue;
        };
        assert_eq!((cycle.turns.as_slice(), cycle.neutral_directions), (&[1, 0][..], 1));
        assert!(outcome.evidence.friction_margin().expect("a margin") > 0.0);
        let place = outcome.position.expect("angles")[1];
        let machine = case.model.ball_balancer().expect("a balancer");
        let balancer = Balancer::<2>::new(machine).expect("two balls");
        let settings = Settings::new(&case.simulation, u64::MAX);
        let start: State<2> = start_of(&case.start);
        let mut motion = started(&shared(balancer), settings, &start);
        go_on(&mut motion, 165.0 * machine.natural_frequency_rad_s());
        assert_eq!(state_of::<2>(&motion).beta[1].to_bits(), place.to_bits(), "it has moved");
        places.push(place);
    }
    assert!(places.len() >= 8, "{} cycles", places.len());
    let least = places.iter().copied().fold(f64::INFINITY, f64::min);
    let greatest = places.iter().copied().fold(0.0, f64::max);
    println!("{} cycles, the other ball at rest from {least} to {greatest} rad", places.len());
    assert!(greatest - least > 1.0, "a family, not a point: {least} to {greatest}");
}
