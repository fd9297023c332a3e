//! The responses of a point: samples of its runs, and the estimates from them.

use super::run_record::RunRecord;
use crate::analysis::{
    Estimate, RunResult, Sample, above, at_rest_by, mean, median_time_to_rest, quantile,
    standard_deviation, worst,
};
use crate::study::{AmplitudeKind, Measure, Response};

const NO_REFERENCE: &str =
    "the machine without balls does not vibrate, so that no amplitude is relative to it";

/// The runs of a point, once for each kind of amplitude that a response measures.
#[derive(Clone, Debug)]
pub struct ResponseSamples<'a> {
    responses: &'a [Response],
    of: Vec<(AmplitudeKind, Sample)>,
    /// Whether any run has a residual amplitude.
    has_amplitude: bool,
}

impl<'a> ResponseSamples<'a> {
    /// Creates empty samples; `cells` is the number of cells of a stratified design.
    pub fn new(responses: &'a [Response], cells: Option<u64>) -> Self {
        let is_measured = |kind| responses.iter().any(|response| response.amplitude == kind);
        let measured = AmplitudeKind::ALL.into_iter().filter(|kind| is_measured(*kind));
        let empty = |kind| (kind, Sample { cells, runs: Vec::new() });
        ResponseSamples { responses, of: measured.map(empty).collect(), has_amplitude: false }
    }

    /// Adds a run.
    pub fn add(&mut self, run: &RunRecord) {
        let RunRecord { planned, outcome, .. } = run;
        self.has_amplitude |= outcome.amplitude_m.is_some();
        for (kind, sample) in &mut self.of {
            sample.runs.push(RunResult {
                cell: planned.cell,
                label: outcome.label(),
                amplitude: match kind {
                    AmplitudeKind::Residual => outcome.amplitude_m,
                    AmplitudeKind::RelativeResidual => run.relative_amplitude(),
                    AmplitudeKind::Peak => outcome.peak.map(|peak| peak.amplitude_m),
                },
                time_to_rest_s: outcome.time_to_rest_s,
                end_time_s: outcome.observed_s(),
            });
        }
    }

    /// Returns one estimate per response.
    pub fn estimates(&self) -> Vec<Estimate> {
        self.responses.iter().map(|response| self.estimate(response)).collect()
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
        match response.measure {
            Measure::Mean => mean(sample),
            Measure::StandardDeviation => standard_deviation(sample),
            Measure::Quantile(fraction) => quantile(sample, fraction),
            Measure::Worst => worst(sample),
            Measure::Above(limit) => above(sample, limit),
            Measure::AtRestBy(time_s) => at_rest_by(sample, time_s),
            Measure::MedianTimeToRest => median_time_to_rest(sample),
        }
    }
}
