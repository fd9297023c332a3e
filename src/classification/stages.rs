//! The stages of a run: the present one, and what has happened in those before.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::lane_step::LaneStep;
use super::output_watch::OutputOutcome;
use crate::model::{Stage, Units};
use crate::motion::all_stick;
use crate::motion::lockstep::LaneGroup;

/// What happened in a stage of a run, in SI units.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct StageOutcome {
    /// Begin and end of the stage, s.
    pub time_s: [f64; 2],
    /// The speed of the disc at the begin and at the end, rad/s.
    pub speed_rad_s: [f64; 2],
    /// Whether it is the last stage of the run.
    pub is_last: bool,
    /// Whether the table is kicked at the begin.
    pub is_kicked: bool,
    /// The number of balls that the kick lifts off the ring, which the model does not follow.
    pub lifted_off: u32,
    /// Angle of each ball at the end, rad, in [0, 2π).
    pub position: Vec<f64>,
    /// Speed of each ball relative to the ring at the end, rad/s.
    pub ball_speed_rad_s: Vec<f64>,
    /// The outputs at the end, for a system that has some.
    pub outputs: Vec<f64>,
    /// Whether the contacts stick for good at the speed of the stage; `None` while the speed changes, and without a certificate.
    pub is_at_rest: Option<bool>,
    /// The distance of the disc's centre from its place at rest at the end, m.
    pub amplitude_m: f64,
    /// The largest such distance in the stage, m, and when it occurs, s.
    pub peak: PeakAmplitude,
}

/// The largest amplitude of the vibration.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Serialize)]
pub struct PeakAmplitude {
    /// The amplitude, m.
    pub amplitude_m: f64,
    /// Its time since the start of the run, s.
    pub time_s: f64,
}

/// Within a step, a maximum is located if a square near it is at least this part of the largest one so far: between two
/// of eight instants the square grows by less than that.
const NEAR: f64 = 0.8;

/// The largest amplitude so far.
#[derive(Clone, Copy, Debug, Default)]
struct Peak {
    /// Its square.
    pub(super) square: f64,
    /// Its time, non-dimensional.
    pub(super) time: f64,
}

impl Peak {
    /// Takes in the latest step.
    pub(super) fn take_in(&mut self, step: &LaneStep) {
        let (began, length) = (step.began(), step.time() - step.began());
        for (part, square) in step.group.largest_squares_within(step.lane, self.square, NEAR) {
            *self = self.or(Peak { square, time: began + part * length });
        }
    }

    /// Returns the larger of two.
    pub(super) fn or(self, other: Peak) -> Peak {
        if other.square > self.square { other } else { self }
    }
}

/// The stages of a run.
#[derive(Clone, Debug)]
pub(super) struct Stages {
    all: Arc<[Stage]>,
    present: usize,
    /// The largest amplitude in the present stage, and in those before.
    peak: Peak,
    peak_before: Peak,
    lifted: u32,
    ended: Vec<StageOutcome>,
}

impl Stages {
    /// Returns the stages of a run at its start.
    pub(super) fn new(all: Vec<Stage>, lifted: u32) -> Self {
        let [peak, peak_before] = [Peak::default(); 2];
        Stages { all: all.into(), present: 0, peak, peak_before, lifted, ended: Vec::new() }
    }

    /// Returns the present stage.
    pub(super) fn present(&self) -> &Stage {
        &self.all[self.present]
    }

    /// Returns whether the present stage is the last.
    pub(super) fn is_last(&self) -> bool {
        self.present + 1 == self.all.len()
    }

    /// Returns whether the run has stages that count: a stage that continues the one before does not.
    pub(super) fn counts(&self) -> bool {
        self.all.iter().skip(1).any(|stage| !stage.continues)
    }

    /// Takes in the latest step, in which the amplitude may be larger than so far.
    pub(super) fn take_in(&mut self, step: &LaneStep) {
        self.peak.take_in(step);
    }

    /// Requests a report of each step in which the amplitude may be larger than so far.
    pub(super) fn watch(&self, group: &mut dyn LaneGroup, lane: usize) {
        if self.counts() {
            group.watch_amplitude(lane, self.peak.square);
        }
    }

    /// Goes on to the next stage, after what happened in the present one. `lifted` is the number of balls that the kick at
    /// the begin of the next one lifts off.
    pub(super) fn next(&mut self, ended: Option<StageOutcome>, lifted: u32) {
        self.present += 1;
        if let Some(ended) = ended {
            self.ended.push(ended);
            self.peak_before = self.peak_before.or(self.peak);
            self.peak = Peak::default();
            self.lifted = lifted;
        }
    }

    /// Returns the next stage.
    pub(super) fn upcoming(&self) -> Option<&Stage> {
        self.all.get(self.present + 1)
    }

    /// Returns the largest amplitude so far; `None` for a run with one stage.
    pub(super) fn peak(&self, units: &Units) -> Option<PeakAmplitude> {
        self.counts().then(|| in_si(self.peak_before.or(self.peak), units))
    }

    /// Returns what has happened in all stages until the latest step, the present one included; nothing for a run with one
    /// stage.
    pub(super) fn outcomes(&self, step: &LaneStep, units: &Units) -> Vec<StageOutcome> {
        let mut all = self.ended.clone();
        all.extend(self.counts().then(|| self.outcome(step, units)));
        all
    }

    /// Returns what has happened in the present stage until the latest step.
    pub(super) fn outcome(&self, step: &LaneStep, units: &Units) -> StageOutcome {
        let stage = self.present();
        let mut until_now = self.all[..=self.present].iter().rev();
        let first = until_now.find(|stage| !stage.continues).unwrap_or(stage);
        let [[begin, _], [_, end]] =
            [first, stage].map(|stage| stage.speeds_rad_s.unwrap_or_default());
        let LaneStep { group, lane, view } = *step;
        let state = group.state(lane);
        let phases = group.phases(lane);
        let speeds = (0..view.contacts.len()).map(|ball| view.speed(&state, ball));
        let speeds: Vec<f64> = speeds.collect();
        let forms = view.rest_forms().filter(|_| !stage.is_driven);
        let outputs = view.system().outputs(&state).into_iter().zip(&units.outputs);
        StageOutcome {
            time_s: [first.begins_s, step.time() / units.natural_rad_s],
            speed_rad_s: [begin, end],
            is_last: self.is_last(),
            is_kicked: stage.is_kicked,
            lifted_off: self.lifted,
            position: units.of_contacts(&view.wrapped(&state), |unit| unit.position),
            ball_speed_rad_s: units.of_contacts(&speeds, |unit| unit.sliding_speed),
            outputs: outputs
                .map(|(value, units)| OutputOutcome::at(value).in_units(units).end)
                .collect(),
            is_at_rest: forms.map(|forms| all_stick(phases) && forms.rests(&state)),
            amplitude_m: view.square(&state).sqrt() * units.length_m,
            peak: in_si(self.peak, units),
        }
    }
}

fn in_si(peak: Peak, units: &Units) -> PeakAmplitude {
    let (amplitude, time) = (peak.square.sqrt(), peak.time);
    PeakAmplitude { amplitude_m: amplitude * units.length_m, time_s: time / units.natural_rad_s }
}
