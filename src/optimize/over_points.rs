//! Combines the estimates at the points of a sweep into one.

use crate::analysis::Estimate;
use crate::study::OverPoints;

/// Returns the worst estimate or the mean; unknown if one of the estimates is.
///
/// The interval of the worst estimate is conservative. If large values are worse, its ends are the largest lower and
/// the largest upper end of all points. The true worst value exceeds the upper end only if it exceeds the upper end of
/// its own point, and lies below the lower end with a probability of at most the sum of the points' 2.5 %. Points share
/// start states and draws, so that their errors are correlated; the standard error of their mean is at most the mean
/// of their standard errors.
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
    let all_known = |ends: Vec<Option<f64>>| ends.into_iter().collect::<Option<Vec<f64>>>();
    let (value, standard_error, low, high) = match how {
        OverPoints::Mean => (
            mean(values),
            all_known(estimates.iter().map(|estimate| estimate.standard_error).collect()).map(mean),
            all_known(lows().collect()).map(mean),
            all_known(highs().collect()).map(mean),
        ),
        OverPoints::Worst => {
            let worse =
                |left: f64, right: f64| if larger_is_worse { left > right } else { left < right };
            let mut worst = 0;
            for (index, value) in values.iter().enumerate() {
                if worse(*value, values[worst]) {
                    worst = index;
                }
            }
            let extreme = |ends: Vec<f64>| {
                ends.into_iter().reduce(if larger_is_worse { f64::max } else { f64::min })
            };
            // A missing end is infinite on its own side.
            let (low, high) = if larger_is_worse {
                (
                    extreme(lows().flatten().collect()),
                    all_known(highs().collect()).and_then(extreme),
                )
            } else {
                (
                    all_known(lows().collect()).and_then(extreme),
                    extreme(highs().flatten().collect()),
                )
            };
            (values[worst], estimates[worst].standard_error, low, high)
        }
    };
    Estimate { value: Some(value), standard_error, low, high, reason: first_reason }
}
