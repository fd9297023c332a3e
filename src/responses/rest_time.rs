//! The median time to rest.

use super::estimate::{Estimate, Sample};
use super::order_statistics::{Cumulative, standard_error};
use super::probability::times;
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
    Estimate::within(value, error, [low, high], too_few)
}

/// Returns the fraction at rest after a step, and the number of runs that would give it Greenwood's variance.
fn cumulative(step: &SurvivalStep) -> Cumulative {
    let (moving, rest) = (step.moving, 1.0 - step.moving);
    // Without moving runs the number does not matter.
    let effective = |error: f64| moving * rest / (error * error);
    let runs = step.standard_error().map_or(step.at_risk as f64, effective);
    Cumulative { value: step.time_s, proportion: rest, runs }
}

#[cfg(test)]
mod tests {
    use super::median_time_to_rest;
    use crate::classification::Label;
    use crate::responses::{Sample, Seen};

    fn sample(rests: u32, cycles: u32) -> Sample {
        let rest = |time: u32| Seen {
            cell: 0,
            label: Label::Equilibrium,
            amplitude: None,
            time_to_rest_s: Some(f64::from(time)),
            end_time_s: None,
        };
        let cycle = Seen { label: Label::LimitCycle, time_to_rest_s: None, ..rest(0) };
        let runs = (1..=rests).map(rest).chain((0..cycles).map(|_| cycle)).collect();
        Sample { cells: None, runs }
    }

    #[test]
    fn by_hand() {
        let found = median_time_to_rest(&sample(100, 0));
        assert_eq!(found.value, Some(50.0));
        assert!(found.low < Some(45.0) && found.high > Some(55.0) && found.reason.is_none());
        // 60 of 100 at rest: the median is the 50th of all; cycles never rest.
        assert_eq!(median_time_to_rest(&sample(60, 40)).value, Some(50.0));
        let few = median_time_to_rest(&sample(20, 80));
        assert_eq!(
            (few.value, few.reason.as_deref()),
            (None, Some("less than half of the runs come to rest"))
        );
        let none = median_time_to_rest(&sample(0, 5));
        assert_eq!((none.value, none.reason.as_deref()), (None, Some("no run came to rest")));
    }
}
