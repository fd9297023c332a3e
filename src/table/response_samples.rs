//! The responses of a point: samples of its runs, and the estimates from them.

use super::run_record::RunRecord;
use crate::analysis::{Estimate, RunResult, Sample, reference_amplitude};
use crate::study::{AmplitudeKind, Response};

const NO_REFERENCE: &str =
    "the machine without balls does not vibrate, so that no amplitude is relative to it";

/// The runs of a point, once for each kind of amplitude that a response measures.
#[derive(Clone, Debug)]
pub struct ResponseSamples<'a> {
    responses: &'a [Response],
    of: Vec<(AmplitudeKind, Sample)>,
    /// Whether any run has a residual amplitude.
    has_amplitude: bool,
    /// The runs with the amplitudes of their own machines without balls.
    without_balls: Sample,
}

impl<'a> ResponseSamples<'a> {
    /// Creates empty samples; `cells` is the number of cells of a stratified design.
    pub fn new(responses: &'a [Response], cells: Option<u64>) -> Self {
        let mut measured: Vec<AmplitudeKind> = Vec::new();
        for response in responses {
            if !measured.contains(&response.amplitude) {
                measured.push(response.amplitude);
            }
        }
        let empty = |kind| (kind, Sample { cells, runs: Vec::new() });
        ResponseSamples {
            responses,
            of: measured.into_iter().map(empty).collect(),
            has_amplitude: false,
            without_balls: Sample { cells, runs: Vec::new() },
        }
    }

    /// Adds a run.
    pub fn add(&mut self, run: &RunRecord) {
        let RunRecord { planned, outcome, .. } = run;
        self.has_amplitude |= outcome.amplitude_m.is_some();
        let machine = planned.case.as_ref().ok().and_then(|case| case.model.ball_balancer());
        for (kind, sample) in &mut self.of {
            let result = RunResult {
                cell: planned.cell,
                label: outcome.label(),
                amplitude: match kind {
                    AmplitudeKind::Residual => outcome.amplitude_m,
                    AmplitudeKind::RelativeResidual => run.relative_amplitude(),
                    AmplitudeKind::Peak => outcome.peak.map(|peak| peak.amplitude_m),
                    AmplitudeKind::Output(place, value) => {
                        outcome.outputs.get(*place).and_then(|output| output.value(*value))
                    }
                },
                time_to_rest_s: outcome.time_to_rest_s(),
                end_time_s: outcome.observed_s(),
            };
            if let (AmplitudeKind::Residual, Some(machine)) = (&*kind, machine) {
                let amplitude = outcome.amplitude_m.and_then(|_| reference_amplitude(machine));
                self.without_balls.runs.push(RunResult { amplitude, ..result });
            }
            sample.runs.push(result);
        }
    }

    /// Returns one estimate per response.
    pub fn estimates(&self) -> Vec<Estimate> {
        self.responses.iter().map(|response| self.estimate(response)).collect()
    }

    /// Returns the value of each response of a residual amplitude, in m, for the machines of the runs without balls.
    pub fn values_without_balls(&self) -> Vec<Option<f64>> {
        let value = |response: &Response| {
            let has_value =
                response.has_value_without_balls() && !self.without_balls.runs.is_empty();
            has_value.then(|| response.measure.estimate(&self.without_balls).value).flatten()
        };
        self.responses.iter().map(value).collect()
    }

    fn estimate(&self, response: &Response) -> Estimate {
        let Some((kind, sample)) = self.of.iter().find(|(kind, _)| *kind == response.amplitude)
        else {
            return Estimate::default();
        };
        let has_amplitude = sample.runs.iter().any(|run| run.amplitude.is_some());
        if *kind == AmplitudeKind::RelativeResidual && self.has_amplitude && !has_amplitude {
            return Estimate::unknown(NO_REFERENCE);
        }
        response.measure.estimate(sample)
    }
}
