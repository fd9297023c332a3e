//! Limit cycles: those that are claimed go on for ever, and the thesis's own are not stable.

use std::path::Path;

use rayon::prelude::*;
use stickslip::ending::{Evidence, Label, certified, simulate};
use stickslip::model::{Balancer, Case, Machine, Method, Simulation, Start};
use stickslip::motion::{Motion, Settings, Tolerance};
use stickslip::study::Study;

/// Thesis table 5.1 and figure 5.15: balls exactly side by side still run after 55 s, with mean
/// speeds of 72.3 and 133.5 rad/s. The orbit is closed, but on the symmetric subspace only.
#[test]
fn thesis_orbits_with_balls_side_by_side() {
    let from = |x, y, beta, x_dot, y_dot, beta_dot| {
        Start::of_balancer([x, y], &[beta; 2], [x_dot, y_dot], &[beta_dot; 2])
    };
    let thesis = [
        (-247.3, 72.3, from(-0.0109, -0.0047, 3.3088, 0.0020, -0.0041, 0.4224)),
        (-309.15, 133.5, from(-0.01, 0.01, 1.5, -0.01, -0.01, 0.75)),
    ];
    for (speed_rad_s, mean_speed, start) in thesis {
        let outcome = simulate(&Case {
            model: Machine { speed_rad_s, ..Machine::default() }.into(),
            start,
            simulation: Simulation { end_time_s: 55.0, ..Simulation::default() },
        });
        let speeds = outcome.mean_speed.clone().expect("running balls have speeds");
        println!("{speed_rad_s} rad/s: balls at {speeds:?} rad/s, {}", outcome.evidence.name());
        assert!((outcome.end_time_s.expect("ran") - 55.0).abs() < 1e-9);
        assert_eq!(outcome.balls_running, Some(2));
        assert_eq!(speeds[0].to_bits(), speeds[1].to_bits(), "exactly side by side");
        assert!((speeds[0] / mean_speed - 1.0).abs() < 0.01, "{speeds:?}");
        assert_eq!(outcome.label(), Label::Undecided);
        if speed_rad_s == -247.3 {
            assert_eq!(outcome.evidence, Evidence::UnstableOrbit);
        }
    }
}

/// Runs that are labelled as limit cycles, computed on without that evidence to ten times the end
/// time: none comes to rest, and the running ball keeps the cycle's mean speed.
#[test]
fn claimed_cycles_go_on() {
    let text = "
schema: 1
name: cycles
seed: 11
model: {kind: ball_balancer}
sweep:
  - zip: {speed_rad_s: [-216.3772, -247.3], friction_coefficient: [2.75e-4, 2.75e-3]}
initial_conditions: {design: {latin_hypercube: {samples: 64}}}
";
    let study = Study::parse(Path::new("cycles.yaml"), text.to_owned()).expect("a study");
    let cases: Vec<Case> =
        (0..study.run_count()).map(|run| study.planned_run(run).case.expect("sound")).collect();
    let claimed: Vec<_> = cases
        .par_iter()
        .map(|case| (case, simulate(case)))
        .filter(|(_, outcome)| outcome.label() == Label::LimitCycle)
        .collect();
    assert!(claimed.len() >= 5, "{} cycles", claimed.len());
    claimed.par_iter().for_each(|(case, outcome)| {
        let machine = case.model.ball_balancer().expect("a balancer");
        let balancer = Balancer::<2>::new(machine).expect("two balls");
        let natural = machine.natural_frequency_rad_s();
        let start = case.start.of_balls().expect("two balls");
        let settings = Settings {
            method: Method::Switch,
            band: case.simulation.band,
            tolerance: Tolerance { relative: 1e-8, absolute: 1e-10 },
            effort_limit: u64::MAX,
        };
        let end = 165.0 * natural;
        let mut motion = Motion::new(&balancer, settings, start).expect("starts");
        let mut earlier = None;
        while motion.time() < end {
            if motion.all_stick() {
                let rest = balancer.rest_point(&motion.state().beta);
                assert!(!certified(&balancer, &rest, motion.state()), "came to rest");
            }
            motion.advance(end).expect("goes on");
            if earlier.is_none() && motion.time() > 0.9 * end {
                earlier = Some((motion.time(), [0, 1].map(|ball| motion.unwrapped_angle(ball))));
            }
        }
        let (time, angles) = earlier.expect("it went on");
        let speeds = outcome.mean_speed.as_ref().expect("a cycle has speeds");
        for ball in 0..2 {
            let turned = motion.unwrapped_angle(ball) - angles[ball];
            let speed = turned / (end - time) * natural;
            assert!((speed - speeds[ball]).abs() < 0.5, "{speed} and {}", speeds[ball]);
        }
    });
}
