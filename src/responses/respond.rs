//! Computes the runs of a design and its responses.

use std::sync::atomic::AtomicBool;

use super::amplitude::{mean, quantile, standard_deviation, worst};
use super::estimate::{Estimate, RunResult, Sample};
use super::probability::{above, at_rest_by};
use super::rest_time::median_time_to_rest;
use crate::analysis::{LabelCounts, reference_amplitude};
use crate::classification::Label;
use crate::engine::WorkerPool;
use crate::study::{DesignValue, Measure, ParameterValue, Response, Study};
use crate::table::RunRecord;

const NO_REFERENCE: &str =
    "the machine without balls does not vibrate, so that no amplitude is relative to it";

/// The responses of a design at one point of the sweep.
#[derive(Clone, Debug, PartialEq)]
pub struct Answer {
    /// Number of the design, from zero in the order of requests.
    pub design: u64,
    /// One value per variable of the study.
    pub values: Vec<DesignValue>,
    /// Number of the point.
    pub point_id: u64,
    /// One value per swept parameter.
    pub swept: Vec<ParameterValue>,
    /// One estimate per response of the study.
    pub estimates: Vec<Estimate>,
    /// Runs per label.
    pub counts: LabelCounts,
    /// Whether label fractions differ abruptly from those of a nearest other design; `None` if the designs were not
    /// compared.
    pub discontinuous: Option<bool>,
}

/// Computes a design at all points of the sweep. `studies` holds the study with its variables set to `values`, or
/// several such studies with different master seeds, whose runs are pooled. Calls `finished` for each run.
/// Returns `None` if `stop` became true.
pub fn respond(
    workers: &WorkerPool,
    studies: &[Study],
    responses: &[Response],
    (design, values): (u64, &[DesignValue]),
    stop: &AtomicBool,
    finished: &(dyn Fn(Label) + Sync),
) -> Option<Vec<Answer>> {
    let Some(first) = studies.first() else { return Some(Vec::new()) };
    let answer = |(point_id, runs): (u64, Vec<RunRecord>)| {
        let point = first.point(point_id);
        let sample = |relative| Sample {
            cells: point.cells,
            runs: runs.iter().map(|run| observed(run, relative)).collect(),
        };
        let [absolute, relative] = [sample(false), sample(true)];
        let estimate = |response: &Response| {
            let sample = if response.relative { &relative } else { &absolute };
            match response.relative && lacks_reference(&absolute, &relative) {
                true => Estimate::unknown(NO_REFERENCE),
                false => estimate(response.measure, sample),
            }
        };
        let mut counts = LabelCounts::default();
        runs.iter().for_each(|run| counts.add(run.outcome.label()));
        Answer {
            design,
            values: values.to_vec(),
            point_id,
            swept: point.swept.clone(),
            estimates: responses.iter().map(estimate).collect(),
            counts,
            discontinuous: None,
        }
    };
    let mut answers = Vec::new();
    let mut from = 0;
    while from < first.point_count() {
        let points = from..end_of_queue(first, from);
        from = points.end;
        let mut runs: Vec<(u64, Vec<RunRecord>)> =
            points.clone().map(|id| (id, Vec::new())).collect();
        for study in studies {
            for run in workers.sample(study, points.clone(), stop, finished)? {
                let place = run.planned.point_id - points.start;
                if let Some((_, of_point)) = runs.get_mut(place as usize) {
                    of_point.push(run);
                }
            }
        }
        answers.extend(runs.into_iter().map(answer));
    }
    Some(answers)
}

/// The number of runs in one queue, unless a single point has more; it bounds the memory.
const RUNS_PER_QUEUE: u64 = 4096;

/// Returns the end of the points whose runs are computed in one queue, from a point on.
fn end_of_queue(study: &Study, from: u64) -> u64 {
    let runs_of = |point_id| study.point(point_id).sampling.first;
    let (mut end, mut runs) = (from + 1, runs_of(from));
    while end < study.point_count() && runs + runs_of(end) <= RUNS_PER_QUEUE {
        runs += runs_of(end);
        end += 1;
    }
    end
}

/// Returns whether runs have amplitudes, but none that is relative to the machine without balls.
fn lacks_reference(absolute: &Sample, relative: &Sample) -> bool {
    let has_amplitude = |sample: &Sample| sample.runs.iter().any(|run| run.amplitude.is_some());
    has_amplitude(absolute) && !has_amplitude(relative)
}

fn observed(run: &RunRecord, relative: bool) -> RunResult {
    let RunRecord { planned, outcome, .. } = run;
    let reference = || {
        let machine = planned.case.as_ref().ok()?.model.ball_balancer()?;
        reference_amplitude(machine).filter(|amplitude| *amplitude > 0.0)
    };
    let amplitude = outcome.amplitude_m;
    RunResult {
        cell: planned.cell,
        label: outcome.label(),
        amplitude: if relative {
            amplitude.and_then(|own| Some(own / reference()?))
        } else {
            amplitude
        },
        time_to_rest_s: outcome.time_to_rest_s,
        end_time_s: outcome.end_time_s,
    }
}

fn estimate(measure: Measure, sample: &Sample) -> Estimate {
    match measure {
        Measure::Mean => mean(sample),
        Measure::StandardDeviation => standard_deviation(sample),
        Measure::Quantile(fraction) => quantile(sample, fraction),
        Measure::Worst => worst(sample),
        Measure::Above(limit) => above(sample, limit),
        Measure::AtRestBy(time_s) => at_rest_by(sample, time_s),
        Measure::MedianTimeToRest => median_time_to_rest(sample),
    }
}
