//! The motion of the disc in a run: its speed, and the angle by which it has turned since the start.

use super::{GivenMotion, Kick, Machine, Model, ParameterDescriptor, SpeedProfile, SpeedSegment};

/// The motion of a disc over the time of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct DiscMotion {
    /// The segments of the speed, each with the angle by which the disc has turned before.
    pub segments: Vec<(SpeedSegment, f64)>,
}

impl DiscMotion {
    /// Returns the speed at a time since the start, rad/s.
    pub fn speed_rad_s(&self, time_s: f64) -> f64 {
        self.segment_at(time_s)
            .map_or(f64::NAN, |(segment, _)| segment.speed_rad_s(time_s - segment.begins_s))
    }

    /// Returns the angle by which the disc has turned until a time since the start, rad.
    pub fn turned_rad(&self, time_s: f64) -> f64 {
        self.segment_at(time_s).map_or(f64::NAN, |(segment, before_rad)| {
            before_rad + segment.turned_rad(time_s - segment.begins_s)
        })
    }

    /// Returns the largest absolute value of the speed, rad/s. It is at an end of a segment, because no ramp overshoots.
    pub fn fastest_rad_s(&self) -> f64 {
        let begins = self.segments.iter().map(|(segment, _)| segment.terms[0].abs());
        begins.fold(0.0, f64::max)
    }

    /// Returns the segment at a time since the start, with the angle in rad by which the disc has turned before.
    pub fn segment_at(&self, time_s: f64) -> Option<&(SpeedSegment, f64)> {
        let begun = self.segments.partition_point(|(segment, _)| segment.begins_s <= time_s);
        self.segments.get(begun.saturating_sub(1))
    }
}

impl DiscMotion {
    /// Returns the motion with a profile, or with the last speed throughout.
    fn new(profile: Option<&SpeedProfile>, speed_rad_s: f64) -> Self {
        let constant = || {
            let terms = [speed_rad_s, 0.0, 0.0, 0.0];
            vec![SpeedSegment { begins_s: 0.0, lasts_s: f64::INFINITY, terms, is_hold: true }]
        };
        let segments = profile.map_or_else(constant, |profile| profile.segments(speed_rad_s));
        let mut turned_rad = 0.0;
        let with_angle = |segment: SpeedSegment| {
            let before_rad = turned_rad;
            turned_rad += segment.turned_rad(segment.lasts_s);
            (segment, before_rad)
        };
        DiscMotion { segments: segments.into_iter().map(with_angle).collect() }
    }
}

impl Machine {
    /// Returns the motion of the disc.
    pub fn disc_motion(&self) -> DiscMotion {
        DiscMotion::new(self.speed_profile.as_ref(), self.speed_rad_s)
    }
}

impl Model {
    /// Returns how the speed of the disc, or of the part that turns, changes; `None` for a constant speed.
    pub fn speed_profile(&self) -> Option<&SpeedProfile> {
        match self {
            Model::BallBalancer(machine) => machine.speed_profile.as_ref(),
            Model::Own(model) => model.speed_profile.as_ref(),
        }
    }

    /// Returns how the speed of the disc, or of the part that turns, changes.
    pub fn speed_profile_mut(&mut self) -> &mut Option<SpeedProfile> {
        match self {
            Model::BallBalancer(machine) => &mut machine.speed_profile,
            Model::Own(model) => &mut model.speed_profile,
        }
    }

    /// Returns the parameter that is the last speed of a profile; `None` for a model without a part that turns.
    pub fn speed_parameter(&self) -> Option<&'static ParameterDescriptor> {
        match self {
            Model::BallBalancer(_) => {
                self.kind().parameters.iter().find(|parameter| parameter.name == "speed_rad_s")
            }
            Model::Own(model) => {
                model.own_kind.speed_place().map(|place| &self.kind().parameters[place])
            }
        }
    }

    /// Returns the motion of the disc, or of the part that turns; `None` for a model without such a part.
    pub fn disc_motion(&self) -> Option<DiscMotion> {
        match self {
            Model::BallBalancer(machine) => Some(machine.disc_motion()),
            Model::Own(model) => {
                let speed_rad_s = model.values()[model.own_kind.speed_place()?];
                Some(DiscMotion::new(model.speed_profile.as_ref(), speed_rad_s))
            }
        }
    }

    /// Returns the motions that tables give over time.
    pub fn given_motions(&self) -> Vec<&GivenMotion> {
        match self {
            Model::BallBalancer(_) => Vec::new(),
            Model::Own(model) => model.own_kind.motions(),
        }
    }

    fn kicks(&self) -> &[Kick] {
        self.ball_balancer().map_or(&[], |machine| &machine.kicks)
    }

    /// Returns whether a run has stages: the speed changes, the table is kicked, or a table gives a motion.
    pub fn has_stages(&self) -> bool {
        self.speed_profile().is_some()
            || !self.kicks().is_empty()
            || !self.given_motions().is_empty()
    }

    /// Returns the begins of the stages of a run that ends at a time, s, in order.
    pub fn stage_begins_s(&self, end_time_s: f64) -> Vec<f64> {
        let disc = self.disc_motion();
        let knots = disc.iter().flat_map(|disc| disc.segments.iter());
        let knots = knots.map(|(segment, _)| segment.begins_s);
        let kicks = self.kicks().iter().map(|kick| kick.at_s);
        let mut begins: Vec<f64> = [0.0].into_iter().chain(knots).chain(kicks).collect();
        begins.extend(self.given_motions().iter().flat_map(|motion| motion.times_s()));
        begins.retain(|begin| *begin < end_time_s);
        begins.sort_by(f64::total_cmp);
        begins.dedup();
        begins
    }

    /// Returns the begin of the last stage of a run, s; 0 for a model whose runs have one stage.
    pub fn last_stage_begins_s(&self) -> f64 {
        self.stage_begins_s(f64::INFINITY).last().copied().unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use crate::model::{Kick, Machine, Model, ProfilePart, Ramp, RampShape, SpeedProfile};

    /// The angle is the integral of the speed, by Simpson's rule, which is exact for the cubic polynomials here.
    #[test]
    fn the_angle_is_the_integral_of_the_speed() {
        let ramp = |shape, to_rad_s, over_s| ProfilePart::Ramp(Ramp { shape, to_rad_s, over_s });
        let parts = vec![
            ramp(RampShape::Smooth, Some(-100.0), 2.0),
            ProfilePart::Hold(Some(0.5)),
            ramp(RampShape::Linear, None, 1.0),
        ];
        let kicks = vec![Kick { at_s: 4.0, speed_m_s: 0.01, direction_rad: 0.0 }];
        let profile = SpeedProfile { start_speed_rad_s: -10.0, parts };
        let machine = Machine {
            speed_rad_s: -200.0,
            speed_profile: Some(profile),
            kicks,
            ..Machine::default()
        };
        let disc = machine.disc_motion();
        let (mut sum, step) = (0.0, 0.25);
        for k in 0..20 {
            let begin = f64::from(k) * step;
            assert!((disc.turned_rad(begin) - sum).abs() < 1e-9, "{begin} s");
            let [first, middle, last] =
                [0.0, 0.5, 1.0].map(|part| disc.speed_rad_s(begin + part * step));
            sum += step / 6.0 * (first + 4.0 * middle + last);
        }
        assert_eq!([0.0, 2.25, 9.0].map(|time| disc.speed_rad_s(time)), [-10.0, -100.0, -200.0]);
        assert_eq!(disc.fastest_rad_s(), 200.0);
        let model = Model::from(machine);
        assert_eq!(model.last_stage_begins_s(), 4.0);
        let constant = Machine::default();
        assert_eq!(constant.disc_motion().turned_rad(0.5), 0.5 * constant.speed_rad_s);
        assert!(model.has_stages() && !Model::from(constant).has_stages());
    }
}
