//! Creep under a periodic force, against its closed form: a ball in a drum that turns about a horizontal axis.

use std::f64::consts::PI;

use stickslip::classification::{Label, Outcome, simulate};
use stickslip::model::{Case, Method, OutputValue, Simulation};

use super::outputs::cases;

const RADIUS_M: f64 = 0.0428;
const GRAVITY_M_S2: f64 = 9.81;
const FRICTION: f64 = 1e-3;
const SPEED_RAD_S: f64 = 5000.0 * PI / 30.0;

/// Returns the outcomes of balls at rest at any angles of the drum. Besides gravity, a constant force along the race acts on
/// each. With gravity, this force exceeds friction by `excess_m_s2` in each turn.
fn in_a_drum(excess_m_s2: f64, sign: f64) -> Vec<Outcome> {
    let held = FRICTION * RADIUS_M * SPEED_RAD_S.powi(2);
    let pull = sign * (excess_m_s2 + held - GRAVITY_M_S2 * FRICTION.hypot(1.0));
    let system = format!(
        "parameters:\n  m: 1 g\n  r: {RADIUS_M:?} m\n  w: {SPEED_RAD_S:?} rad/s\n  g: {GRAVITY_M_S2:?} m/s^2\n  \
         pull: {pull:?} m/s^2\n\
         coordinates: {{b: {{unit: rad, start: [0, 2 * pi], start_rate: 0, periodic: true}}}}\n\
         mass: {{b: {{b: 1.4 * m * r^2}}}}\n\
         force: {{b: -m * r * (g * cos(w * t + b) + pull)}}\n\
         contacts:\n  race:\n    normal: m * r * (r * (w + b')^2 - g * sin(w * t + b))\n    sliding: b'\n    \
         friction: {{coulomb: {{coefficient: {FRICTION:?}}}}}\n\
         period: 2 * pi / w\n"
    );
    let by_events = |case: Case| {
        let simulation = Simulation { method: Method::Event, ..case.simulation };
        simulate(&Case { simulation, ..case })
    };
    cases(&system, 8, 2.0).into_iter().map(by_events).collect()
}

/// The ball slips for three times the half width of the time in which friction does not hold it. To leading order in the excess
/// `e`, it moves by `4.5 e² / (1.4 R A Ω²)` in each turn, where `A` is the amplitude of gravity.
#[test]
fn a_ball_in_a_drum_creeps_by_the_closed_form() {
    for (excess, tolerance) in [(0.01, 4e-3), (0.03, 1e-2), (0.1, 3e-2)] {
        for sign in [1.0, -1.0] {
            let excess_m_s2 = excess * GRAVITY_M_S2;
            let exact =
                4.5 * excess_m_s2.powi(2) / (1.4 * RADIUS_M * GRAVITY_M_S2 * SPEED_RAD_S.powi(2));
            for outcome in in_a_drum(excess_m_s2, sign) {
                assert_eq!(outcome.evidence.name(), "periodic_creep", "{excess}: {outcome:?}");
                assert_eq!(outcome.label(), Label::Creep);
                let creep = outcome.outputs[0].value(OutputValue::Creep).expect("known");
                let ratio = -sign * creep / exact;
                assert!((ratio - 1.0).abs() < tolerance, "{excess}: {creep}, ratio {ratio}");
                let period_s = outcome.evidence.period_s().expect("known");
                assert!((period_s * SPEED_RAD_S / (2.0 * PI) - 1.0).abs() < 1e-9, "{period_s}");
            }
        }
    }
}

/// Where friction holds the ball in the whole turn, it rests. A ball that slides all the time does not creep.
#[test]
fn balls_that_friction_holds_or_does_not_stop_do_not_creep() {
    for outcome in in_a_drum(-1e-3, 1.0) {
        assert_eq!(outcome.evidence.name(), "periodic_rest", "{outcome:?}");
        assert_eq!(outcome.outputs[0].value(OutputValue::Creep), Some(0.0));
    }
    for outcome in in_a_drum(3.0 * GRAVITY_M_S2, -1.0) {
        assert!(!matches!(outcome.label(), Label::Creep | Label::Failed), "{outcome:?}");
    }
}
