//! The median time to rest.

use super::estimate::{Estimate, Sample};
use super::probability::times;
use super::sample_quantile::{CumulativeFraction, standard_error};
use crate::analysis::{SurvivalCurve, SurvivalStep};

/// Estimates the time by which half of the runs have come to rest, s (Kaplan-Meier, with the interval of Brookmeyer
/// and Crowley, see [`SurvivalCurve`], and the bootstrap's standard error). Failed runs are excluded.
pub fn median_time_to_rest(sample: &Sample) -> Estimate {
    let curve = SurvivalCurve::new(times(sample).groups());
    if curve.steps.is_empty() {
        return Estimate::unknown("no run came to rest");
    }
    let [low, high] = curve.time_to_rest_interval(0.5);
    let Some(value) = curve.time_to_rest_quantile(0.5) else {
        return Estimate {
            low,
            high,
            ..Estimate::unknown("less than half of the runs come to rest")
        };
    };
    let error = standard_error(curve.steps.iter().map(cumulative), 0.5);
    let too_few = "too few runs at rest for both ends of the interval";
    Estimate::with_interval(value, error, [low, high], too_few)
}

/// Returns the fraction at rest after a step, and the number of independent runs for which the binomial variance equals
/// Greenwood's variance.
fn cumulative(step: &SurvivalStep) -> CumulativeFraction {
    let (moving, rest) = (step.moving, 1.0 - step.moving);
    // Without moving runs the number does not matter.
    let effective = |error: f64| moving * rest / (error * error);
    let runs = step.standard_error().map_or(step.at_risk as f64, effective);
    CumulativeFraction { value: step.time_s, proportion: rest, runs }
}
