//! The outputs of a system: their least, greatest and mean values over a part of the time.

use std::f64::consts::TAU;

use serde::{Deserialize, Serialize};

use super::lane_step::LaneStep;
use super::window::{NODES, WEIGHTS};
use crate::model::{Components, OutputUnits, OutputValue, wrap_to_pi};
use crate::motion::SLOW;

/// The number of times at which an extreme value between known values is approached by a parabola.
const MOST_APPROACHES: usize = 4;

/// The change of an output in a period, over 1 and its value, above which it drifts.
const DRIFT: f64 = 1e-6;

/// An output of a run, in SI units.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct OutputOutcome {
    /// The value at the end.
    pub end: f64,
    /// The values over the cycle or the last tenth of the time, or at rest; `None` for an output that drifts.
    pub range: Option<OutputRange>,
    /// The displacement in the period of a run on a closed orbit or of one that creeps, an angle without whole turns.
    pub creep: Option<f64>,
}

/// The values of an output over a part of the time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct OutputRange {
    /// The mean over time.
    pub mean: f64,
    /// The least and the greatest value.
    pub extremes: [f64; 2],
}

impl OutputOutcome {
    /// Returns one of its values.
    pub fn value(&self, value: OutputValue) -> Option<f64> {
        let OutputRange { mean, extremes: [low, high] } = match value {
            OutputValue::End => return Some(self.end),
            OutputValue::Creep => return self.creep,
            _ => self.range?,
        };
        Some(match value {
            OutputValue::Least => low,
            OutputValue::Greatest => high,
            OutputValue::Amplitude => 0.5 * (high - low),
            _ => mean,
        })
    }

    /// Returns an output with this value at the end; its other values are unknown.
    pub(super) fn at(end: f64) -> Self {
        OutputOutcome { end, range: None, creep: None }
    }

    /// Returns an output that has this value for good, or drifts at this rate.
    pub(super) fn constant(end: f64, rate: f64) -> Self {
        let range = OutputRange { mean: end, extremes: [end; 2] };
        OutputOutcome { range: (rate.abs() <= SLOW).then_some(range), ..Self::at(end) }
    }

    /// Returns an output in SI units; angles begin within a turn of 0.
    pub(super) fn in_units(self, units: &OutputUnits) -> Self {
        let turns = |value: f64| if units.angular { (value / TAU).floor() * TAU } else { 0.0 };
        let range = self.range.map(|OutputRange { mean, extremes }| OutputRange {
            mean: (mean - turns(mean)) * units.size,
            extremes: extremes.map(|value| (value - turns(mean)) * units.size),
        });
        let creep = self.creep.map(|creep| if units.angular { wrap_to_pi(creep) } else { creep });
        OutputOutcome {
            end: (self.end - turns(self.end)) * units.size,
            range,
            creep: creep.map(|creep| creep * units.size),
        }
    }
}

/// Outputs from a time on.
#[derive(Clone, Debug)]
pub(super) struct OutputWatch {
    start: f64,
    /// The time covered.
    span: f64,
    outputs: Vec<WatchedOutput>,
}

/// What is known of an output.
#[derive(Clone, Copy, Debug)]
struct WatchedOutput {
    /// The values at the start and at the end.
    ends: [f64; 2],
    integral: f64,
    extremes: [f64; 2],
}

impl OutputWatch {
    pub(super) fn from(start: f64) -> Self {
        OutputWatch { start, span: 0.0, outputs: Vec::new() }
    }

    /// Returns the outputs; nothing before the start. An output of a motion that `repeats` after this time drifts if its value
    /// does not repeat.
    pub(super) fn measured(&self, repeats: bool) -> Vec<OutputOutcome> {
        let measured = |output: &WatchedOutput| {
            let WatchedOutput { ends: [start, end], integral, extremes } = *output;
            let drifts = repeats && (end - start).abs() > DRIFT * (1.0 + start.abs());
            let range = OutputRange { mean: integral / self.span, extremes };
            OutputOutcome {
                end,
                range: (!drifts).then_some(range),
                creep: repeats.then_some(end - start),
            }
        };
        self.outputs.iter().map(measured).collect()
    }

    /// Returns the outputs over a period after which they have been displaced.
    pub(super) fn displaced(&self) -> Vec<OutputOutcome> {
        let pairs = self.measured(false).into_iter().zip(self.measured(true));
        pairs.map(|(all, period)| OutputOutcome { creep: period.creep, ..all }).collect()
    }

    /// Adds the part of the latest step of a run that is after the start.
    pub(super) fn take_in(&mut self, step: &LaneStep) {
        if !step.view.has_outputs || step.time() <= self.start {
            return;
        }
        let from = self.start.max(step.began());
        if step.time() > from {
            let at_nodes = |times| step.outputs_at(times);
            self.add([from, step.time()], at_nodes, |number, time| step.output_at(number, time));
        }
    }

    /// Adds a time in which the motion is smooth; `at_nodes` returns the outputs at seven times, and `output` one of them at a
    /// time.
    pub(super) fn add(
        &mut self,
        [from, to]: [f64; 2],
        at_nodes: impl FnOnce([f64; 7]) -> [Components; 7],
        output: impl Fn(usize, f64) -> f64,
    ) {
        let length = to - from;
        let inside = NODES.map(|node| from + node * length);
        let [first, second, third, fourth, fifth] = inside;
        let times = [from, first, second, third, fourth, fifth, to];
        let values = at_nodes(times);
        if self.outputs.is_empty() {
            let begun = |first: &f64| WatchedOutput {
                ends: [*first; 2],
                integral: 0.0,
                extremes: [*first; 2],
            };
            self.outputs = values[0].iter().map(begun).collect();
        }
        self.span += length;
        for (which, watched) in self.outputs.iter_mut().enumerate() {
            let WatchedOutput { ends: [_, end], integral, extremes: [low, high] } = watched;
            *end = values[values.len() - 1][which];
            let inside = values[1..=NODES.len()].iter().zip(WEIGHTS);
            *integral += length * inside.map(|(row, weight)| weight * row[which]).sum::<f64>();
            for row in &values {
                (*low, *high) = (low.min(row[which]), high.max(row[which]));
            }
            let at = |place: usize, sign: f64| (times[place], sign * values[place][which]);
            for (sign, extreme) in [(-1.0, low), (1.0, high)] {
                for first in 0..times.len() - 2 {
                    let three = [0, 1, 2].map(|next| at(first + next, sign));
                    let value = |time: f64| sign * output(which, time);
                    if let Some(top) = maximum(three, sign * *extreme, value) {
                        *extreme = sign * top;
                    }
                }
            }
        }
    }
}

/// Returns the maximum of a smooth function near three of its points, if it is above a value.
pub(super) fn maximum(
    mut three: [(f64, f64); 3],
    above: f64,
    value: impl Fn(f64) -> f64,
) -> Option<f64> {
    let mut best = None;
    for _ in 0..MOST_APPROACHES {
        let [(t0, f0), (t1, f1), (t2, f2)] = three;
        let [rise, fall] = [(f1 - f0) / (t1 - t0), (f2 - f1) / (t2 - t1)];
        let curvature = (fall - rise) / (t2 - t0);
        let top = 0.5 * (t0 + t1) - 0.5 * rise / curvature;
        let expected = f0 + (top - t0) * (rise + curvature * (top - t1));
        let is_inside = curvature < 0.0 && top > t0 && top < t2 && top != t1;
        if !is_inside || expected <= best.unwrap_or(above) {
            break;
        }
        let found = (top, value(top));
        if found.1 > best.unwrap_or(above) {
            best = Some(found.1);
        }
        three = match (top < t1, found.1 >= f1) {
            (true, true) => [three[0], found, three[1]],
            (true, false) => [found, three[1], three[2]],
            (false, true) => [three[1], found, three[2]],
            (false, false) => [three[0], three[1], found],
        };
    }
    best
}

#[cfg(test)]
mod tests {
    use smallvec::smallvec;

    use super::OutputWatch;

    /// Extremes and means of functions over long steps, in which the fastest function turns five times.
    #[test]
    fn extremes_between_instants_are_found() {
        let mut watch = OutputWatch::from(0.0);
        let at = |time: f64| smallvec![time.sin(), 3.0 + (2.0 * time + 0.3).cos(), time];
        for step in 0..7 {
            let begin = 2.6 * f64::from(step);
            watch.add([begin, begin + 2.6], |times| times.map(at), |which, time| at(time)[which]);
        }
        let end = 2.6 * 7.0;
        let ranges: Vec<_> =
            watch.measured(false).iter().filter_map(|output| output.range).collect();
        let [sine, cosine, line] = ranges[..] else { panic!("three outputs") };
        assert_eq!(watch.measured(true)[2].range, None, "a drift");
        for (found, wanted) in [
            (sine.extremes[0], -1.0),
            (sine.extremes[1], 1.0),
            (sine.mean, (1.0 - f64::cos(end)) / end),
            (cosine.extremes[0], 2.0),
            (cosine.extremes[1], 4.0),
            (cosine.mean, 3.0 + (f64::sin(2.0 * end + 0.3) - f64::sin(0.3)) / (2.0 * end)),
            (line.extremes[0], 0.0),
            (line.extremes[1], end),
            (line.mean, 0.5 * end),
        ] {
            assert!((found - wanted).abs() < 1e-5, "{found} is not {wanted}");
        }
    }
}
