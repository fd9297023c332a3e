//! Accelerations that the balls can follow, against closed forms.

use stickslip::analysis::run_ups;
use stickslip::model::{Ball, Machine, ProfilePart, Ramp, RampShape, SpeedProfile};

/// On a linear ramp with the acceleration `α` the balls slip until `|ω| = sqrt((1 - 2Jd) α / μ)`; a smooth ramp has 1.5 times
/// the acceleration in its middle.
#[test]
fn balls_slip_where_the_ramp_is_faster_than_friction() {
    let (from, over_s, friction_coefficient) = (-31.0, 2.0, 2.75e-3);
    let ball = Ball { friction_coefficient, ..Ball::default() };
    let ramp = |shape| ProfilePart::Ramp(Ramp { shape, to_rad_s: None, over_s });
    let machine = |shape| Machine {
        balls: vec![ball, Ball { friction_coefficient: 1.0, ..ball }],
        speed_profile: Some(SpeedProfile { start_speed_rad_s: from, parts: vec![ramp(shape)] }),
        ..Machine::default()
    };
    let linear = machine(RampShape::Linear);
    let found = run_ups(&linear);
    assert_eq!(found.len(), 1);
    let change = (linear.speed_rad_s - from).abs();
    let acceleration = change / over_s;
    let lever = 1.0 - 0.2 * ball.diameter_m / linear.ring_radius_m;
    let follows = |speed: f64| friction_coefficient * speed * speed / lever;
    let slips_until = (lever * acceleration / friction_coefficient).sqrt();
    let expected = (slips_until - from.abs()) / change;
    assert!((0.2..0.9).contains(&expected), "{expected}");
    assert!((found[0].slipping_fraction - expected).abs() < 2e-3, "{found:?} {expected}");
    assert!((found[0].acceleration_rad_s2 / acceleration - 1.0).abs() < 1e-12);
    assert!((found[0].followed_rad_s2[0] / follows(from) - 1.0).abs() < 1e-12);
    assert!((found[0].followed_rad_s2[1] / follows(linear.speed_rad_s) - 1.0).abs() < 1e-12);
    assert_eq!((found[0].time_s, found[0].speed_rad_s[0]), ([0.0, over_s], from));
    let smooth = run_ups(&machine(RampShape::Smooth));
    assert!((smooth[0].acceleration_rad_s2 / (1.5 * acceleration) - 1.0).abs() < 1e-5);
    assert_eq!(run_ups(&Machine::default()), []);
}
