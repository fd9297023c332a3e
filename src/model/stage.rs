//! The stages of a run: between two knots of the speed profile or two kicks, the motion is that of one system.

use std::f64::consts::TAU;
use std::sync::Arc;

use super::given_motion::shifted;
use super::invalid_parameter::{InvalidParameter, invalid};
use super::parameter_name::member_name;
use super::{
    Components, DiscMotion, Machine, Model, OwnModel, SPEED_TERMS, Simulation, SpeedSegment,
    StageMotion, Start, System,
};

/// A stage of a run.
#[derive(Clone, Debug)]
pub struct Stage {
    /// Its begin, s.
    pub begins_s: f64,
    /// Its end, s; that of the run for the last stage.
    pub ends_s: f64,
    /// The speed of the disc at its begin and at its end, rad/s; `None` for a model without a disc.
    pub speeds_rad_s: Option<[f64; 2]>,
    /// Whether the table is kicked at its begin.
    pub is_kicked: bool,
    /// Whether it begins at a row of a motion that goes on: results show it together with the stage before.
    pub continues: bool,
    /// The system in this stage.
    pub system: Arc<dyn System>,
    /// Whether the speed changes.
    pub is_driven: bool,
    /// The last component of the state, if that is a non-dimensional time. A balancer whose speed changes has the time since the begin
    /// of the segment of the profile, and another model whose equations change with time that since the begin of the stage.
    time: Option<f64>,
    /// Whether the last component of a start state is a time.
    starts_with_time: bool,
    /// The jump of the table's velocity at its begin, non-dimensional, in the turning frame.
    jump: [f64; 2],
}

impl Stage {
    /// Returns the state at the begin of the stage from that at the end of the stage `before`, or from a start state, and the
    /// number of balls that a kick lifts off the ring.
    pub fn entered(&self, before: Option<&Stage>, state: &[f64]) -> (Components, u32) {
        let mut state = Components::from(state);
        if before.map_or(self.starts_with_time, |before| before.time.is_some()) {
            state.pop();
        }
        let lifted =
            if self.is_kicked { self.system.jump_of_balls(&mut state, self.jump) } else { 0 };
        state.extend(self.time);
        (state, lifted)
    }
}

impl Model {
    /// Returns the stages of a run that ends at a time; `None` for an unsupported number of balls. The speed is constant in
    /// the last stage.
    pub fn stages(&self, start: &Start, end_time_s: f64) -> Option<Vec<Stage>> {
        let (disc, begins) = (self.disc_motion(), self.stage_begins_s(end_time_s));
        if !self.has_stages() {
            let only = Stage {
                begins_s: 0.0,
                ends_s: end_time_s,
                speeds_rad_s: self.ball_balancer().map(|machine| [machine.speed_rad_s; 2]),
                is_kicked: false,
                continues: false,
                system: self.system_for(start)?,
                is_driven: false,
                time: None,
                starts_with_time: false,
                jump: [0.0; 2],
            };
            let later = match self {
                Model::Own(model) => model.own_kind.lasting_system(model, end_time_s),
                Model::BallBalancer(_) => None,
            };
            let Some((begins_s, system)) = later else { return Some(vec![only]) };
            let last = Stage { begins_s, continues: true, system, ..only.clone() };
            let first = Stage {
                ends_s: begins_s,
                is_driven: true,
                time: Some(0.0),
                starts_with_time: true,
                ..only
            };
            return Some(vec![first, last]);
        }
        let ends = begins.iter().copied().skip(1).chain([end_time_s]);
        let times = begins.iter().copied().zip(ends).map(|(begin, end)| [begin, end]);
        match self {
            Model::BallBalancer(machine) => {
                let angles = start.0.get(2..2 + machine.balls.len())?;
                let disc = disc?;
                // Each stage copies the machine, but not a profile of many rows.
                let machine = Machine { speed_profile: None, ..machine.clone() };
                times.map(|times| machine.stage(angles, &disc, times)).collect()
            }
            Model::Own(model) => times.map(|times| model.stage(disc.as_ref(), times)).collect(),
        }
    }
}

impl OwnModel {
    fn stage(&self, disc: Option<&DiscMotion>, [begins_s, ends_s]: [f64; 2]) -> Option<Stage> {
        let segment = disc.and_then(|disc| disc.segment_at(begins_s));
        let turning = segment.map(|(segment, before_rad)| {
            let since_begin_s = begins_s - segment.begins_s;
            let speed = SpeedSegment {
                begins_s,
                lasts_s: segment.lasts_s - since_begin_s,
                terms: shifted(segment.terms, since_begin_s),
                ..*segment
            };
            (before_rad + segment.turned_rad(since_begin_s), speed)
        });
        let speeds_rad_s = turning
            .as_ref()
            .map(|(_, speed)| [0.0, ends_s - begins_s].map(|time_s| speed.speed_rad_s(time_s)));
        let speed_changes = turning.as_ref().is_some_and(|(_, speed)| !speed.is_hold);
        let motions = self.own_kind.motions();
        let moves = motions.iter().any(|motion| motion.terms_from(begins_s).len() > 1);
        let is_knot = segment.is_some_and(|(segment, _)| segment.begins_s == begins_s);
        let ends = motions.iter().any(|motion| motion.times_s().last() == Some(begins_s));
        let (system, has_clock) =
            self.own_kind.system_in_stage(self, &StageMotion { begins_s, turning });
        Some(Stage {
            begins_s,
            ends_s,
            speeds_rad_s,
            is_kicked: false,
            continues: begins_s > 0.0 && !is_knot && !ends,
            system,
            is_driven: speed_changes || moves,
            time: has_clock.then_some(0.0),
            starts_with_time: disc.is_some(),
            jump: [0.0; 2],
        })
    }
}

impl Model {
    /// Returns the end time of a run, s, if the speed profile has an end.
    pub fn end_time_s(&self) -> Option<f64> {
        self.speed_profile()?.end_time_s()
    }

    /// Checks that runs that may be continued to a later end are in their last stage at the earlier one.
    ///
    /// # Errors
    /// The end time, if the last stage begins later.
    pub fn validate_extension(&self, simulation: &Simulation) -> Result<(), InvalidParameter> {
        let (begins_s, end_s) = (self.last_stage_begins_s(), simulation.end_time_s);
        if simulation.extend.is_none() || begins_s < end_s {
            return Ok(());
        }
        let found =
            format!("{end_s} s with `extend`, before the last stage begins at {begins_s} s");
        Err(invalid("end_time_s", &found, "a later end time, or no `extend`"))
    }

    /// Checks that all kicks come before the end of a run.
    ///
    /// # Errors
    /// The time of the first kick that comes later.
    pub fn validate_kicks(&self, end_time_s: f64) -> Result<(), InvalidParameter> {
        let kicks = self.ball_balancer().into_iter().flat_map(|machine| &machine.kicks);
        match (1..).zip(kicks).find(|(_, kick)| kick.at_s >= end_time_s) {
            None => Ok(()),
            Some((number, kick)) => {
                let name = member_name("kick_at_s", "s", number);
                let allowed = "a time before the end of the run";
                Err(invalid(&name, &kick.at_s.to_string(), allowed))
            }
        }
    }
}

impl Machine {
    fn stage(
        &self,
        angles: &[f64],
        disc: &DiscMotion,
        [begins_s, ends_s]: [f64; 2],
    ) -> Option<Stage> {
        let (segment, _) = disc.segment_at(begins_s)?;
        let natural = self.natural_frequency_rad_s();
        let since_begin_s = begins_s - segment.begins_s;
        let speed_at = |time_s: f64| segment.speed_rad_s(time_s - segment.begins_s);
        let speeds_rad_s = [begins_s, ends_s].map(speed_at);
        let driven = || {
            let [begin, end] = speeds_rad_s;
            let fastest = if begin.abs() > end.abs() { begin } else { end };
            let mut unit = 1.0;
            let terms: [f64; SPEED_TERMS] = segment.terms.map(|term| {
                unit *= natural;
                term / unit
            });
            self.at_speed(fastest).driven(angles, terms)
        };
        let system = if segment.is_hold {
            Model::from(self.at_speed(segment.terms[0])).system_in_order(angles)
        } else {
            driven()
        };
        let kicks: Vec<_> = self.kicks.iter().filter(|kick| kick.at_s == begins_s).collect();
        let turned = disc.turned_rad(begins_s) % TAU;
        let unit = self.ring_radius_m * natural;
        let jump = kicks.iter().fold([0.0; 2], |[x, y], kick| {
            let (sine, cosine) = libm::sincos(kick.direction_rad - turned);
            let speed = kick.speed_m_s / unit;
            [x + speed * cosine, y + speed * sine]
        });
        Some(Stage {
            begins_s,
            ends_s,
            speeds_rad_s: Some(speeds_rad_s),
            is_kicked: !kicks.is_empty(),
            continues: false,
            system: system?,
            is_driven: !segment.is_hold,
            time: (!segment.is_hold).then_some(since_begin_s * natural),
            starts_with_time: false,
            jump,
        })
    }

    /// Returns this machine at constant speed.
    fn at_speed(&self, speed_rad_s: f64) -> Machine {
        Machine { speed_rad_s, speed_profile: None, kicks: Vec::new(), ..self.clone() }
    }
}
