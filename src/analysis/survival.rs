//! Kaplan-Meier estimate of the fraction of runs still moving over time, with its confidence
//! interval. Runs that were stopped before they came to rest are censored observations.

use super::interval::Z_95;
use crate::classification::Label;

/// Kind of a time at which a run came to rest, in [`super::ValueCounts`].
const REST: usize = 0;
/// Kind of a time at which a run was stopped while moving, in [`super::ValueCounts`].
pub(super) const STOPPED: usize = 1;

/// Returns the time at which a run came to rest or was stopped, s, with its kind. A run that repeats
/// never comes to rest: it is stopped at an infinite time. `None` if no time is known.
pub(crate) fn rest_or_stop_time(
    label: Label,
    time_to_rest_s: Option<f64>,
    end_time_s: Option<f64>,
) -> Option<(f64, usize)> {
    match (time_to_rest_s, end_time_s) {
        (Some(time), _) => Some((time, REST)),
        (None, _) if matches!(label, Label::LimitCycle | Label::Periodic) => {
            Some((f64::INFINITY, STOPPED))
        }
        (None, end) => end.map(|end| (end, STOPPED)),
    }
}

/// A time at which runs came to rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurvivalStep {
    /// The time, s.
    pub time_s: f64,
    /// Runs at risk (moving and observed) just before.
    pub at_risk: u64,
    /// Runs that came to rest at this time.
    pub rests: u64,
    /// Runs stopped while moving, at this time or later but before the next step.
    pub stopped: u64,
    /// Fraction of runs still moving immediately after.
    pub moving: f64,
    /// 95 % interval of the fraction `moving`.
    pub interval: (f64, f64),
    /// Greenwood's sum, the variance of `moving` over its square; infinite if no run moves.
    greenwood: f64,
}

impl SurvivalStep {
    /// Returns Greenwood's standard error of `moving`, or `None` if no run moves.
    ///
    /// Source: M. Greenwood, The natural duration of cancer, Reports on Public Health and Medical
    /// Subjects 33, HMSO 1926.
    pub fn standard_error(&self) -> Option<f64> {
        self.greenwood.is_finite().then(|| self.moving * self.greenwood.sqrt())
    }
}

/// The Kaplan-Meier estimate of the fraction of runs still moving.
///
/// Source: E. L. Kaplan, P. Meier, J. Am. Stat. Assoc. 53 (1958) 457,
/// doi:10.1080/01621459.1958.10501452.
#[derive(Clone, Debug, PartialEq)]
pub struct SurvivalCurve {
    /// Number of all runs.
    pub runs: u64,
    /// Runs stopped before any came to rest.
    pub stopped_before: u64,
    /// Runs still moving after the last of `steps`: times at which they were stopped, ascending,
    /// with counts.
    pub stopped_after: Vec<(f64, u64)>,
    /// Times at which runs came to rest, ascending.
    pub steps: Vec<SurvivalStep>,
}

impl SurvivalCurve {
    /// Computes the curve from `[runs that came to rest, runs that were stopped]` at ascending
    /// times, s. A run that has been shown never to come to rest has an infinite stopping time. At
    /// equal times, rests precede stops.
    pub fn new(groups: impl Iterator<Item = (f64, [u64; 2])> + Clone) -> Self {
        let runs = groups.clone().map(|(_, [rests, stopped])| rests + stopped).sum();
        let (stopped_after, steps) = (Vec::new(), Vec::new());
        let mut curve = SurvivalCurve { runs, stopped_before: 0, stopped_after, steps };
        let (mut at_risk, mut moving, mut greenwood) = (runs, 1.0, 0.0);
        for (time_s, [rests, stopped]) in groups {
            if rests > 0 {
                let (here, left) = (at_risk as f64, (at_risk - rests) as f64);
                // The number of uncensored runs that would estimate this fraction equally well.
                let effective = here / moving;
                moving *= left / here;
                greenwood += rests as f64 / (here * left);
                let interval = interval(moving, greenwood, effective);
                curve.stopped_after.clear();
                curve.steps.push(SurvivalStep {
                    time_s,
                    at_risk,
                    rests,
                    stopped: 0,
                    moving,
                    interval,
                    greenwood,
                });
            }
            if stopped > 0 {
                curve.stopped_after.push((time_s, stopped));
            }
            match curve.steps.last_mut() {
                Some(step) => step.stopped += stopped,
                None => curve.stopped_before += stopped,
            }
            at_risk -= rests + stopped;
        }
        curve
    }

    /// Returns the 95 % interval of the fraction still moving while no run has come to rest.
    pub fn interval_before(&self) -> (f64, f64) {
        interval(1.0, 0.0, self.runs as f64)
    }

    /// Returns the time by which this fraction of runs has come to rest, s, or `None` if it is not
    /// reached.
    pub fn time_to_rest_quantile(&self, fraction: f64) -> Option<f64> {
        self.first_time(fraction, |step| step.moving)
    }

    /// Returns the 95 % interval of the time by which this fraction of runs has come to rest, s:
    /// the times at which the fraction lies in the curve's interval. An end is `None` if it is not
    /// reached.
    ///
    /// Source: R. Brookmeyer, J. Crowley, Biometrics 38 (1982) 29, doi:10.2307/2530286, with the
    /// interval of [`SurvivalStep::interval`].
    pub fn time_to_rest_interval(&self, fraction: f64) -> [Option<f64>; 2] {
        [
            self.first_time(fraction, |step| step.interval.0),
            self.first_time(fraction, |step| step.interval.1),
        ]
    }

    fn first_time(&self, fraction: f64, moving: impl Fn(&SurvivalStep) -> f64) -> Option<f64> {
        // A rounding error in the product must not delay a fraction like 0.95 of 256 runs.
        let enough = 1.0 - fraction + 1e-12;
        self.steps.iter().find(|step| moving(step) <= enough).map(|step| step.time_s)
    }
}

/// Returns the 95 % interval of a fraction still moving: Greenwood's variance on the scale of
/// log(-log), which keeps the interval within 0 and 1.
///
/// At 0 and 1, where that scale is singular, it is the exact binomial interval (C. J. Clopper, E.
/// S. Pearson, Biometrika 26 (1934) 404, doi:10.1093/biomet/26.4.404) for none or all of the
/// effective number of runs. The effective number is the number of runs at risk divided by the
/// estimated fraction that they represent (F. J. Dorey, E. L. Korn, Stat. Med. 6 (1987) 679,
/// doi:10.1002/sim.4780060605); without censoring it is the number of runs.
///
/// Source: J. D. Kalbfleisch, R. L. Prentice, The Statistical Analysis of Failure Time Data, 2nd
/// ed., Wiley 2002, section 1.4, doi:10.1002/9781118032985.
fn interval(moving: f64, greenwood: f64, effective: f64) -> (f64, f64) {
    let extreme = || libm::exp(libm::log(0.025) / effective);
    if moving >= 1.0 {
        return (if effective > 0.0 { extreme() } else { 0.0 }, 1.0);
    }
    if moving <= 0.0 {
        return (0.0, 1.0 - extreme());
    }
    let logarithm = libm::log(moving);
    let factor = libm::exp(Z_95 * greenwood.sqrt() / -logarithm);
    (libm::exp(logarithm * factor), libm::exp(logarithm / factor))
}
