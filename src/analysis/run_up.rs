//! Which accelerations of the disc the balls can follow, without simulation.
//!
//! A ball that sticks to the ring of a table at rest needs the friction `(1 - 2 J d) |α| <= μ ω²` (the tangential and the
//! normal force of the equations of motion with `ẍ = ÿ = x = y = 0`). The vibration of the table adds to that, so that a
//! ball may slip earlier.

use serde::Serialize;

use crate::model::{Ball, Machine, SPHERE_INERTIA, SpeedSegment};

/// Parts of a segment in which the condition is evaluated.
const PARTS: u32 = 1000;

/// A change of speed, and the part of it that the balls cannot follow.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct RunUp {
    /// Begin and end, s.
    pub time_s: [f64; 2],
    /// The speeds at both, rad/s.
    pub speed_rad_s: [f64; 2],
    /// The largest acceleration, rad/s².
    pub acceleration_rad_s2: f64,
    /// The acceleration that the ball with the least friction follows at the begin and at the end, rad/s².
    pub followed_rad_s2: [f64; 2],
    /// The fraction of the time in which the disc accelerates more than that.
    pub slipping_fraction: f64,
}

/// Returns the changes of speed of a machine, in the order of time; none at constant speed.
pub fn run_ups(machine: &Machine) -> Vec<RunUp> {
    let disc = machine.disc_motion();
    let driven = disc.segments.iter().filter(|(segment, _)| !segment.is_hold);
    driven.map(|(segment, _)| run_up(machine, segment)).collect()
}

/// Returns the acceleration that a ball can follow at a speed, rad/s².
fn followed(machine: &Machine, ball: &Ball, speed_rad_s: f64) -> f64 {
    let lever = 1.0 - 2.0 * SPHERE_INERTIA * ball.diameter_m / machine.ring_radius_m;
    ball.friction_coefficient * speed_rad_s * speed_rad_s / lever
}

fn run_up(machine: &Machine, segment: &SpeedSegment) -> RunUp {
    let least = |speed_rad_s: f64| {
        let each = machine.balls.iter().map(|ball| followed(machine, ball, speed_rad_s));
        each.fold(f64::INFINITY, f64::min)
    };
    let ends = [0.0, segment.lasts_s].map(|after_s| segment.speed_rad_s(after_s));
    let (mut largest, mut slipping) = (0.0_f64, 0);
    for part in 0..PARTS {
        let after_s = (f64::from(part) + 0.5) / f64::from(PARTS) * segment.lasts_s;
        let acceleration = segment.acceleration_rad_s2(after_s).abs();
        largest = largest.max(acceleration);
        slipping += u32::from(acceleration > least(segment.speed_rad_s(after_s)));
    }
    RunUp {
        time_s: [segment.begins_s, segment.begins_s + segment.lasts_s],
        speed_rad_s: ends,
        acceleration_rad_s2: largest,
        followed_rad_s2: ends.map(least),
        slipping_fraction: f64::from(slipping) / f64::from(PARTS),
    }
}
