//! Rest of a system whose equations are not affine while its contact sticks: a block that may leave the ground, with a damped
//! pendulum on it.

use stickslip::classification::{Label, simulate};
use stickslip::model::{Case, Method, Simulation};
use stickslip::motion::{Motion, all_stick};

use super::outputs::cases;
use crate::support::{TestRng, go_on, settings};

/// The block has mass 1 and the pendulum mass 0.5 and length 1; gravity is 1. The start has the positions, then their rates.
fn case(friction: f64, damping: f64, [x, y, a, u, v, w]: [f64; 6], method: Method) -> Case {
    let system = format!(
        "parameters: {{mu: {friction:?}, d: {damping:?}}}
coordinates:
  x: {{start: {x:?}, start_rate: {u:?}}}
  y: {{start: {y:?}, start_rate: {v:?}}}
  a: {{start: {a:?}, start_rate: {w:?}}}
mass: {{x: {{x: 1.5, a: 0.5 * cos(a)}}, y: {{y: 1.5, a: 0.5 * sin(a)}}, a: {{a: 0.5}}}}
force:
  x: 0.5 * a'^2 * sin(a)
  y: -0.5 * a'^2 * cos(a) - 1.5
  a: -0.5 * sin(a) - d * a'
contacts: {{ground: {{gap: y, sliding: x', friction: {{coulomb: {{coefficient: mu}}}}}}}}"
    );
    let case = cases(&system, 1, 1000.0).remove(0);
    Case { simulation: Simulation { method, ..case.simulation }, ..case }
}

/// Whatever its start, the block comes to rest, and does not move again when it is followed on. Much friction holds it while the
/// pendulum still swings far; the proof then comes when the swing is small enough for the bounds.
#[test]
fn a_block_with_a_damped_pendulum_comes_to_rest_for_good() {
    let mut draws = TestRng::new(48);
    for number in 0..40 {
        let method = [Method::Event, Method::Switch][number % 2];
        let friction = [0.05, 0.2, 0.6][number % 3];
        let mut within = |most: f64| most * (2.0 * draws.uniform() - 1.0);
        let start =
            [within(1.0), within(0.2).abs(), within(3.0), within(0.5), within(0.5), within(1.5)];
        let case = case(friction, 0.1, start, method);
        let outcome = simulate(&case);
        assert_eq!(outcome.evidence.name(), "rest_contracting", "{start:?} {outcome:?}");
        assert_eq!(outcome.label(), Label::Equilibrium);
        let margin = outcome.evidence.friction_margin().expect("known");
        assert!((margin - 1.0).abs() < 1e-6, "the pendulum hangs down at rest: {margin}");
        let since = outcome.time_to_rest_s().expect("known");
        let system = case.model.system().expect("a system");
        let state = case.model.start_state(&case.start).expect("a state");
        let mut motion =
            Motion::new(&system, settings(method, 1e-8), &state).expect("starts above the ground");
        let natural = case.model.natural_frequency_rad_s();
        go_on(&mut motion, 1000.0 * natural);
        let stopped = motion.last_switches()[0] / natural;
        assert!(all_stick(motion.phases()) && stopped <= since + 1e-6, "{stopped} {since}");
    }
}

/// Without damping the pendulum swings for ever, while the block sticks: the motion repeats, which proves no rest.
#[test]
fn a_pendulum_without_damping_swings_for_ever() {
    let outcome = simulate(&case(0.6, 0.0, [0.0, 0.0, 0.3, 0.0, 0.0, 0.0], Method::Event));
    assert_eq!(outcome.label(), Label::Periodic, "{outcome:?}");
}
