//! The motion of a run that is computed again: speed of the disc, amplitude and speeds of the balls over time.

use crate::classification::{Instants, MotionSample, RunRecorder, simulate_recorded};
use crate::model::{Case, DiscMotion};
use crate::study::Study;

/// The number of intervals into which the time before the last stage and that of the last stage are each divided. A curve
/// has one value in each.
const INTERVALS: usize = 160;
/// Instants per period of the fastest oscillation, and the smallest and the largest number of instants in an interval.
const INSTANTS_PER_PERIOD: f64 = 8.0;
const INSTANTS: (f64, f64) = (6.0, 64.0);

/// The motion of a run in intervals.
#[derive(Clone, Debug, PartialEq)]
pub struct SampledMotion {
    /// The middle of each interval, s.
    pub time_s: Vec<f64>,
    /// The largest distance of the table from its place at rest in each interval, m.
    pub amplitude_m: Vec<f64>,
    /// The mean speed of each ball relative to the ring in each interval, rad/s.
    pub ball_speed_rad_s: Vec<Vec<f64>>,
    /// The motion of the disc.
    pub disc: DiscMotion,
    /// The begin of the last stage, s.
    pub last_stage_s: f64,
    /// The times of the kicks, s.
    pub kicks_s: Vec<f64>,
}

impl SampledMotion {
    /// Returns whether the speed of the disc changes in the middle of an interval.
    pub fn is_ramp(&self, interval: usize) -> bool {
        let Some(time_s) = self.time_s.get(interval) else { return false };
        self.disc.segment_at(*time_s).is_some_and(|(segment, _)| {
            let [_, changes @ ..] = segment.terms;
            changes.iter().any(|change| *change != 0.0)
        })
    }
}

/// Computes a run again up to a time, s; `None` for a run that does not start, or of a model without balls.
pub fn motion(study: &Study, run_id: u64, end_s: f64) -> Option<SampledMotion> {
    let case: Case = study.planned_run(run_id).case.ok()?;
    let machine = case.model.ball_balancer()?;
    if !(end_s > 0.0 && end_s.is_finite()) {
        return None;
    }
    let disc = machine.disc_motion();
    let units = case.model.units();
    let rate_rad_s = disc.fastest_rad_s() + units.natural_rad_s;
    let last_stage_s = case.model.last_stage_begins_s();
    let parts = match 0.0 < last_stage_s && last_stage_s < end_s {
        true => vec![[0.0, last_stage_s], [last_stage_s, end_s]],
        false => vec![[0.0, end_s]],
    };
    let intervals: Vec<TimeInterval> =
        parts.into_iter().flat_map(|ends| divided(ends, rate_rad_s)).collect();
    let instants = intervals.iter().flat_map(TimeInterval::instants_s);
    let times: Vec<f64> = instants.map(|time| time * units.natural_rad_s).collect();
    let most = times.len();
    let mut recorder = RunRecorder::new(Instants::At(times), most);
    simulate_recorded(&case, &mut recorder);
    let samples = recorder.finish().samples;
    let mut samples = samples.iter();
    let mut motion = SampledMotion {
        time_s: Vec::new(),
        amplitude_m: Vec::new(),
        ball_speed_rad_s: vec![Vec::new(); machine.balls.len()],
        disc,
        last_stage_s,
        kicks_s: machine.kicks.iter().map(|kick| kick.at_s).collect(),
    };
    for interval in intervals {
        let samples: Vec<&MotionSample> = samples.by_ref().take(interval.instants).collect();
        if samples.is_empty() {
            break;
        }
        motion.time_s.push(0.5 * (interval.ends_s[0] + interval.ends_s[1]));
        let tables = samples.iter().filter_map(|sample| sample.table);
        let largest = tables.map(|[x, y, ..]| x.hypot(y)).fold(0.0, f64::max);
        motion.amplitude_m.push(largest * units.length_m);
        for (ball, speeds) in motion.ball_speed_rad_s.iter_mut().enumerate() {
            let of_ball = samples.iter().filter_map(|sample| sample.contacts.get(ball));
            let sum: f64 = of_ball.map(|contact| units.sliding_speed(ball, contact)).sum();
            speeds.push(sum / samples.len() as f64);
        }
    }
    Some(motion)
}

/// A part of the time of a run, with a number of equidistant instants in it.
#[derive(Clone, Copy, Debug)]
struct TimeInterval {
    ends_s: [f64; 2],
    instants: usize,
}

impl TimeInterval {
    fn instants_s(&self) -> impl Iterator<Item = f64> {
        let TimeInterval { ends_s: [from, to], instants } = *self;
        let part = move |place: usize| (place as f64 + 0.5) / instants as f64;
        (0..instants).map(move |place| from + (to - from) * part(place))
    }
}

/// Divides a time into intervals, with enough instants for oscillations of this angular frequency.
fn divided([from_s, to_s]: [f64; 2], rate_rad_s: f64) -> impl Iterator<Item = TimeInterval> {
    let length_s = (to_s - from_s) / INTERVALS as f64;
    let periods = length_s * rate_rad_s / std::f64::consts::TAU;
    let instants = (periods * INSTANTS_PER_PERIOD).clamp(INSTANTS.0, INSTANTS.1).ceil() as usize;
    (0..INTERVALS).map(move |place| {
        let [begin_s, end_s] = [place, place + 1].map(|place| from_s + length_s * place as f64);
        TimeInterval { ends_s: [begin_s, end_s], instants }
    })
}
