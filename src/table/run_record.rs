//! A run with its outcome, and the responses of the runs of a point: samples, and the estimates from them.

use crate::analysis::{
    Estimate, ObservedRun, RunResult, Sample, reference_amplitude, relative_amplitude,
};
use crate::classification::{Evidence, Outcome};
use crate::study::{AmplitudeKind, PlannedRun, Response};

/// A run with its outcome.
#[derive(Clone, Debug, PartialEq)]
pub struct RunRecord {
    /// The run as planned.
    pub planned: PlannedRun,
    /// How it ended.
    pub outcome: Outcome,
    /// Evidence of the audit, if the run was recomputed.
    pub audit: Option<Evidence>,
}

impl RunRecord {
    /// Returns the run as the statistics use it.
    pub fn observed(&self) -> ObservedRun<'_> {
        ObservedRun {
            cell: self.planned.cell,
            case: self.planned.case.as_ref().ok(),
            outcome: &self.outcome,
            audit: self.audit.as_ref().map(Evidence::label),
        }
    }

    /// Returns the amplitude divided by that of the run's own machine without balls, see [`relative_amplitude`].
    pub fn relative_amplitude(&self) -> Option<f64> {
        let machine = self.planned.case.as_ref().ok()?.model.ball_balancer()?;
        relative_amplitude(machine, self.outcome.amplitude_m?)
    }
}

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
