//! Combines the estimates at the points of a sweep into one.

use crate::responses::Estimate;
use crate::study::OverPoints;

/// Returns the worst estimate or the mean; unknown if one of the estimates is.
///
/// The interval of the worst estimate is conservative: its upper end is above the largest value if that value's own
/// upper end is, and its lower end fails with at most the sum of the points' 2.5 % (vice versa if small values are
/// worse). Points share start states and draws, so that their errors are correlated: the standard error of the mean
/// is at most the mean of theirs.
pub(super) fn over_points(
    estimates: &[&Estimate],
    how: OverPoints,
    larger_is_worse: bool,
) -> Estimate {
    let known: Option<Vec<f64>> = estimates.iter().map(|estimate| estimate.value).collect();
    let first_reason = estimates.iter().find_map(|estimate| estimate.reason.clone());
    let Some(values) = known.filter(|values| !values.is_empty()) else {
        let unknown = estimates.iter().find(|estimate| estimate.value.is_none());
        let reason = unknown.and_then(|estimate| estimate.reason.clone()).or(first_reason);
        return Estimate { reason, ..Estimate::default() };
    };
    if let [only] = estimates {
        return (*only).clone();
    }
    let lows = || estimates.iter().map(|estimate| estimate.low);
    let highs = || estimates.iter().map(|estimate| estimate.high);
    let mean = |numbers: Vec<f64>| numbers.iter().sum::<f64>() / numbers.len() as f64;
    let all = |ends: Vec<Option<f64>>| ends.into_iter().collect::<Option<Vec<f64>>>();
    let (value, standard_error, low, high) = match how {
        OverPoints::Mean => (
            mean(values),
            all(estimates.iter().map(|estimate| estimate.standard_error).collect()).map(mean),
            all(lows().collect()).map(mean),
            all(highs().collect()).map(mean),
        ),
        OverPoints::Worst => {
            let worse =
                |one: f64, other: f64| if larger_is_worse { one > other } else { one < other };
            let mut place = 0;
            for (index, value) in values.iter().enumerate() {
                if worse(*value, values[place]) {
                    place = index;
                }
            }
            let extreme = |ends: Vec<f64>| {
                ends.into_iter().reduce(if larger_is_worse { f64::max } else { f64::min })
            };
            // A missing end is infinite on its own side.
            let (low, high) = if larger_is_worse {
                (extreme(lows().flatten().collect()), all(highs().collect()).and_then(extreme))
            } else {
                (all(lows().collect()).and_then(extreme), extreme(highs().flatten().collect()))
            };
            (values[place], estimates[place].standard_error, low, high)
        }
    };
    Estimate { value: Some(value), standard_error, low, high, reason: first_reason }
}

#[cfg(test)]
mod tests {
    use super::over_points;
    use crate::responses::Estimate;
    use crate::study::OverPoints::{Mean, Worst};

    fn estimate(value: f64, error: f64) -> Estimate {
        Estimate {
            value: Some(value),
            standard_error: Some(error),
            low: Some(value - 2.0 * error),
            high: Some(value + 2.0 * error),
            reason: None,
        }
    }

    #[test]
    fn worst_and_mean() {
        let [a, b] = [estimate(1.0, 0.5), estimate(3.0, 0.25)];
        let worst = over_points(&[&a, &b], Worst, true);
        assert_eq!((worst.value, worst.low, worst.high), (Some(3.0), Some(2.5), Some(3.5)));
        assert_eq!(worst.standard_error, Some(0.25));
        let least = over_points(&[&a, &b], Worst, false);
        assert_eq!((least.value, least.low, least.high), (Some(1.0), Some(0.0), Some(2.0)));
        let mean = over_points(&[&a, &b], Mean, true);
        assert_eq!((mean.value, mean.low, mean.high), (Some(2.0), Some(1.25), Some(2.75)));
        assert_eq!(mean.standard_error, Some(0.375));
    }

    #[test]
    fn what_is_missing_at_one_point_is_missing() {
        let unknown = Estimate::unknown("all runs failed");
        let found = over_points(&[&estimate(1.0, 0.1), &unknown], Worst, true);
        assert_eq!((found.value, found.reason.as_deref()), (None, Some("all runs failed")));
        let unbounded = Estimate { high: None, ..estimate(1.0, 0.1) };
        let found = over_points(&[&estimate(3.0, 0.1), &unbounded], Worst, true);
        assert_eq!((found.value, found.high), (Some(3.0), None));
        let single = over_points(&[&unbounded], Mean, true);
        assert_eq!(single, unbounded);
    }
}
