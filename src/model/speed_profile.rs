//! The speed of the disc over time: ramps, plateaus and tables, one after another.

use serde::Serialize;

use super::invalid_parameter::{InvalidParameter, invalid, not_negative, positive};
use super::parameter_name::member_name;

/// The number of coefficients of the speed: those of a cubic polynomial.
pub const SPEED_TERMS: usize = 4;

/// How the speed of the disc changes. The last speed is the `speed_rad_s` of the machine.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SpeedProfile {
    /// The speed at the start, rad/s. It has the sign of all other speeds: a profile never crosses zero.
    pub start_speed_rad_s: f64,
    /// The parts, in the order of time.
    pub parts: Vec<ProfilePart>,
}

/// A part of a speed profile.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub enum ProfilePart {
    /// The speed changes from that of the part before.
    Ramp(Ramp),
    /// The speed is constant for a time, s; `None` until the end of the run, as the last part.
    Hold(Option<f64>),
    /// The speed is linear between the rows of a table: time since the begin of the part in s, speed in rad/s. The first
    /// row has the time 0.
    Table(Vec<[f64; 2]>),
}

/// A change from one speed to another.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Ramp {
    /// How the speed changes.
    pub shape: RampShape,
    /// The speed at the end, rad/s; `None` for the last change of speed, which leads to the speed of the machine.
    pub to_rad_s: Option<f64>,
    /// The duration, s.
    pub over_s: f64,
}

/// The shape of a ramp.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub enum RampShape {
    /// The acceleration is constant.
    Linear,
    /// The acceleration is continuous, and zero at both ends: the speed is a cubic polynomial of time.
    Smooth,
}

/// A part of the time in which the speed is one polynomial.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpeedSegment {
    /// Its begin, s.
    pub begins_s: f64,
    /// Its duration, s; infinite if it lasts until the end of the run.
    pub lasts_s: f64,
    /// The coefficients of the speed in rad/s as a polynomial of the time since the begin in s.
    pub terms: [f64; SPEED_TERMS],
    /// Whether the speed is constant by its part, so that only rest or motion at that speed counts.
    pub is_hold: bool,
}

impl SpeedSegment {
    /// Returns the speed a time after the begin, rad/s.
    pub fn speed_rad_s(&self, after_s: f64) -> f64 {
        self.terms.iter().rev().fold(0.0, |sum, term| sum * after_s + term)
    }

    /// Returns the acceleration a time after the begin, rad/s².
    pub fn acceleration_rad_s2(&self, after_s: f64) -> f64 {
        let [_, first, second, third] = self.terms;
        first + after_s * (2.0 * second + 3.0 * third * after_s)
    }

    /// Returns the angle by which the disc turns in a time from the begin, rad.
    pub fn turned_rad(&self, after_s: f64) -> f64 {
        let terms = self.terms.iter().zip([1.0, 2.0, 3.0, 4.0]).rev();
        terms.fold(0.0, |sum, (term, power)| sum * after_s + term / power) * after_s
    }
}

impl SpeedProfile {
    /// Returns the segments of positive duration up to the end of the run; the last one has a constant speed.
    pub fn segments(&self, last_speed_rad_s: f64) -> Vec<SpeedSegment> {
        let mut segments = Vec::new();
        let (mut time, mut speed) = (0.0, self.start_speed_rad_s);
        let mut add = |lasts_s: f64, terms: [f64; SPEED_TERMS], is_hold: bool| {
            if lasts_s > 0.0 {
                segments.push(SpeedSegment { begins_s: time, lasts_s, terms, is_hold });
                time += lasts_s;
            }
        };
        for (place, part) in self.parts.iter().enumerate() {
            match part {
                ProfilePart::Ramp(Ramp { shape, to_rad_s, over_s }) => {
                    let to = to_rad_s.unwrap_or(last_speed_rad_s);
                    let (change, over) = (to - speed, *over_s);
                    let terms = match shape {
                        RampShape::Linear => [speed, change / over, 0.0, 0.0],
                        RampShape::Smooth => {
                            let square = over * over;
                            [speed, 0.0, 3.0 * change / square, -2.0 * change / (square * over)]
                        }
                    };
                    add(over, terms, false);
                    speed = to;
                }
                ProfilePart::Hold(lasts_s) => {
                    let lasts_s = lasts_s.filter(|_| place + 1 < self.parts.len());
                    add(lasts_s.unwrap_or(f64::INFINITY), [speed, 0.0, 0.0, 0.0], true);
                }
                ProfilePart::Table(rows) => {
                    for two in rows.windows(2) {
                        let [[from_s, from], [to_s, to]] = [two[0], two[1]];
                        let slope = (to - from) / (to_s - from_s);
                        add(to_s - from_s, [from, slope, 0.0, 0.0], false);
                    }
                    speed = rows.last().map_or(speed, |row| row[1]);
                }
            }
        }
        if !matches!(self.parts.last(), Some(ProfilePart::Hold(_))) {
            add(f64::INFINITY, [speed, 0.0, 0.0, 0.0], true);
        }
        segments
    }

    /// Returns the time at which the run ends, s, if the last part is a plateau with a duration.
    pub fn end_time_s(&self) -> Option<f64> {
        let Some(ProfilePart::Hold(Some(_))) = self.parts.last() else { return None };
        let lasts_s = |part: &ProfilePart| match part {
            ProfilePart::Ramp(ramp) => ramp.over_s,
            ProfilePart::Hold(lasts_s) => lasts_s.unwrap_or(0.0),
            ProfilePart::Table(rows) => rows.last().map_or(0.0, |row| row[0]),
        };
        Some(self.parts.iter().map(lasts_s).sum())
    }

    /// Checks that all values have a physical meaning.
    pub(super) fn validate(
        &self,
        (last_name, last_speed_rad_s): (&str, f64),
    ) -> Result<(), InvalidParameter> {
        let start = self.start_speed_rad_s;
        let has_sign = |name: &str, speed: f64| {
            let allowed =
                "a speed that is not zero, with the sign of all other speeds of the profile";
            let sound = speed.is_finite() && speed * start > 0.0;
            if sound { Ok(()) } else { Err(invalid(name, &speed.to_string(), allowed)) }
        };
        has_sign("start_speed_rad_s", start)?;
        let (mut speed, mut ramps, mut holds) = (start, 0, 0);
        for (place, part) in self.parts.iter().enumerate() {
            match part {
                ProfilePart::Ramp(Ramp { to_rad_s, over_s, .. }) => {
                    ramps += 1;
                    positive(&member_name("ramp_over_s", "s", ramps), *over_s)?;
                    if let Some(to) = to_rad_s {
                        has_sign(&member_name("ramp_to_rad_s", "rad/s", ramps), *to)?;
                    }
                    speed = to_rad_s.unwrap_or(last_speed_rad_s);
                }
                ProfilePart::Hold(lasts_s) => {
                    holds += 1;
                    let name = member_name("hold_s", "s", holds);
                    if place + 1 < self.parts.len() {
                        not_negative(&name, lasts_s.unwrap_or(f64::NAN))?;
                    } else {
                        positive(&name, lasts_s.unwrap_or(1.0))?;
                    }
                }
                ProfilePart::Table(rows) => {
                    let first = rows.first().map_or(f64::NAN, |row| row[1]);
                    if first.to_bits() != speed.to_bits() {
                        let allowed = "the speed at the end of the part before the table";
                        return Err(invalid("speed_profile", &first.to_string(), allowed));
                    }
                    for [_, speed] in rows {
                        has_sign("speed_profile", *speed)?;
                    }
                    speed = rows.last().map_or(speed, |row| row[1]);
                }
            }
        }
        has_sign(last_name, last_speed_rad_s)?;
        if speed.to_bits() != last_speed_rad_s.to_bits() {
            let found = last_speed_rad_s.to_string();
            return Err(invalid(last_name, &found, "the last speed of the speed profile"));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Speeds are continuous, and the angle is the integral of the speed.
    #[test]
    fn segments_follow_one_another() {
        let ramp = |shape, to_rad_s, over_s| ProfilePart::Ramp(Ramp { shape, to_rad_s, over_s });
        let profile = SpeedProfile {
            start_speed_rad_s: -10.0,
            parts: vec![
                ramp(RampShape::Smooth, Some(-100.0), 2.0),
                ProfilePart::Hold(Some(0.5)),
                ProfilePart::Table(vec![[0.0, -100.0], [1.0, -120.0], [1.5, -90.0]]),
                ramp(RampShape::Linear, None, 3.0),
            ],
        };
        assert_eq!(profile.validate(("speed_rad_s", -200.0)), Ok(()));
        let segments = profile.segments(-200.0);
        let begins: Vec<f64> = segments.iter().map(|segment| segment.begins_s).collect();
        assert_eq!(begins, [0.0, 2.0, 2.5, 3.5, 4.0, 7.0]);
        for two in segments.windows(2) {
            let end = two[0].speed_rad_s(two[0].lasts_s);
            assert!((end - two[1].speed_rad_s(0.0)).abs() < 1e-12, "{two:?}");
            let parts = 10_000;
            let width = two[0].lasts_s / f64::from(parts);
            let middle = |k: i32| two[0].speed_rad_s((f64::from(k) + 0.5) * width) * width;
            let sum: f64 = (0..parts).map(middle).sum();
            assert!((sum - two[0].turned_rad(two[0].lasts_s)).abs() < 1e-5, "{two:?}");
        }
        let last = segments.last().expect("a last segment");
        assert_eq!((last.terms, last.lasts_s), ([-200.0, 0.0, 0.0, 0.0], f64::INFINITY));
    }

    #[test]
    fn speeds_of_both_signs_are_refused() {
        let to = |to_rad_s| SpeedProfile {
            start_speed_rad_s: -10.0,
            parts: vec![ProfilePart::Ramp(Ramp {
                shape: RampShape::Linear,
                to_rad_s,
                over_s: 1.0,
            })],
        };
        assert_eq!(
            to(Some(5.0)).validate(("speed_rad_s", -200.0)).expect_err("crosses zero").name,
            "ramp_to_1_rad_s"
        );
        assert_eq!(
            to(None).validate(("speed_rad_s", 200.0)).expect_err("crosses zero").name,
            "speed_rad_s"
        );
        assert_eq!(
            to(Some(-20.0)).validate(("speed_rad_s", -200.0)).expect_err("jumps").name,
            "speed_rad_s"
        );
    }
}
