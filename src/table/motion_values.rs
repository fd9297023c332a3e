//! The values of a recorded motion in SI units and in words.

use crate::classification::{ContactSample, GapSample, MotionSample};
use crate::model::{DiscMotion, Units};
use crate::motion::{Direction, Phase};

impl Units {
    /// Converts the speed at which a gap opens: rad/s for balls, m/s for bodies on a line.
    pub fn opening_speed(&self, gap: &GapSample) -> f64 {
        let unit = self.contacts.first();
        gap.opening_speed * unit.map_or(f64::NAN, |unit| unit.sliding_speed)
    }
}

impl Units {
    /// Converts a time to s.
    pub fn seconds(&self, time: f64) -> f64 {
        time / self.natural_rad_s
    }

    /// Returns position and velocity of the disc's centre in the inertial frame, m and m/s, for this motion of the disc. At
    /// time 0, the axes of the disc and of the inertial frame coincide.
    pub fn in_space(&self, disc: &DiscMotion, sample: &MotionSample) -> Option<[f64; 4]> {
        let [x, y, x_dot, y_dot] = sample.table?;
        let time_s = self.seconds(sample.time);
        let omega = disc.speed_rad_s(time_s) / self.natural_rad_s;
        let (sine, cosine) = disc.turned_rad(time_s).sin_cos();
        let (u, v) = (x_dot - omega * y, y_dot + omega * x);
        let speed = self.length_m * self.natural_rad_s;
        Some([
            self.length_m * (cosine * x - sine * y),
            self.length_m * (sine * x + cosine * y),
            speed * (cosine * u - sine * v),
            speed * (sine * u + cosine * v),
        ])
    }

    /// Returns the sliding speed of a contact: rad/s for a ball, m/s for a block.
    pub fn sliding_speed(&self, contact: usize, sample: &ContactSample) -> f64 {
        self.contacts.get(contact).map_or(f64::NAN, |unit| unit.sliding_speed * sample.speed)
    }

    /// Converts a force on a contact to N.
    pub fn newtons(&self, contact: usize, force: f64) -> Option<f64> {
        self.contacts.get(contact).map(|unit| unit.force_n * force)
    }
}

/// Returns the name of a phase.
pub fn phase_name(phase: Phase) -> &'static str {
    match phase {
        Phase::Stick => "stick",
        Phase::Slip(Direction::Forward) => "slip_forward",
        Phase::Slip(_) => "slip_backward",
        Phase::Transition(Direction::Forward) => "transition_forward",
        Phase::Transition(_) => "transition_backward",
        Phase::Free => "free",
        Phase::Apart => "apart",
        Phase::Open => "open",
        Phase::Closed => "closed",
    }
}
