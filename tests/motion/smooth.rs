//! Smooth phases: steps and states within them against an independent integration.

use stickslip::model::{Method, State};
use stickslip::motion::{Direction, Phase, Settings};

use super::samples::two_balls;
use crate::support::reference::{derivative, step};
use crate::support::{for_each_kernel, settings, started, state_of};

/// Both balls slip forwards for some time.
const START: State<2> = State {
    position: [0.03, -0.02],
    velocity: [0.01, 0.04],
    beta: [1.0, 4.0],
    beta_dot: [0.9, 0.8],
};

/// Returns the state after a time in equal steps of the independent integration, both balls in slip.
fn integrated(start: &State<2>, time: f64, count: u32) -> State<2> {
    let balancer = two_balls(-216.3772);
    let f = |state: &State<2>| derivative(&balancer, &[Phase::Slip(Direction::Forward); 2], state);
    (0..count).fold(*start, |state, _| step(f, &state, time / f64::from(count)))
}

fn distance(a: &State<2>, b: &State<2>) -> f64 {
    let pairs = a.components().into_iter().zip(b.components());
    pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// The independent integration, on which other tests rest, has its order.
#[test]
fn the_independent_integration_has_order_eight() {
    let exact = integrated(&START, 8.0, 400);
    let [coarse, fine] = [8, 16].map(|count| distance(&integrated(&START, 8.0, count), &exact));
    let order = (coarse / fine).log2();
    assert!((7.3..9.5).contains(&order), "order {order}, errors {coarse:e} {fine:e}");
    assert!(fine < 1e-7, "{fine:e}");
}

/// In a step of any length, the state at its end and within it is that of the independent integration, and there is none outside
/// of it; the error of a step falls with its tolerance.
#[test]
fn steps_are_those_of_the_independent_integration() {
    for system in for_each_kernel(two_balls(-216.3772)) {
        for (relative, allowed) in [(1e-5, 1e-6), (1e-8, 1e-9), (1e-11, 2e-12), (1e-13, 1e-13)] {
            let settings = Settings { band: 1e-4, ..settings(Method::Switch, relative) };
            let mut motion = started(&system, settings, &START);
            let (mut steps, mut worst) = (0, 0.0_f64);
            while motion.time() < 8.0 {
                let before: State<2> = state_of(&motion);
                assert_eq!(motion.advance(8.0), Ok(false), "one smooth stretch");
                let (began, ended) = (motion.last_step_began(), motion.time());
                for part in [0.2, 0.5, 0.9, 1.0] {
                    let time = if part < 1.0 { began + part * (ended - began) } else { ended };
                    let found = motion.within_last_step(time).expect("within");
                    let found = State::of_components(&found).expect("two balls");
                    let apart = distance(&found, &integrated(&before, time - began, 40));
                    worst = worst.max(apart);
                }
                let outside = [began - 1e-9, ended + 1e-9];
                assert_eq!(outside.map(|time| motion.within_last_step(time)), [None, None]);
                steps += 1;
            }
            println!("{relative:e}: {steps} steps, largest error {worst:e}");
            assert!(worst < allowed, "{relative:e}: {worst:e}");
            assert!(steps > 4, "{steps}");
        }
    }
}
