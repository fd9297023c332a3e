//! What a reader of an optimum should know: bounds of ranges, limits, and the comparison with the machine without balls.

use super::data::OptimumData;
use crate::report::figures::significant;
use crate::study::Measure;

/// The distance to a bound, relative to the range, below which an optimum lies on the bound: designs are rounded to six
/// digits.
const ON_BOUND: f64 = 1e-5;

/// Returns sentences about the best design; empty if nothing is remarkable.
pub fn notes(data: &OptimumData) -> Vec<String> {
    let mut notes = Vec::new();
    let designs = data.evaluations.len();
    if data.optimum.is_none() {
        notes.push(format!(
            "The search is not finished: {designs} of {} designs are evaluated. The same command continues it.",
            data.optimization.designs
        ));
    }
    if data.design("best").is_some_and(|best| best["limits_met"] == false) {
        notes.push("The best design does not meet all limits in its final runs.".to_owned());
    }
    notes.extend(on_bounds(data));
    notes.extend(no_better_than_without_balls(data));
    notes
}

/// Names the variables whose best value lies on a bound of its range.
fn on_bounds(data: &OptimumData) -> Vec<String> {
    let Some(best) = data.design("best") else { return Vec::new() };
    let sentence = |variable: &crate::study::Variable| {
        let [from, to] = variable.range().filter(|[from, to]| from < to)?;
        let value = best["values"][variable.name()].as_f64()?;
        let near = |end: f64| (value - end).abs() <= ON_BOUND * (to - from);
        let which = match (near(from), near(to)) {
            (true, _) => "lower",
            (_, true) => "upper",
            _ => return None,
        };
        let unit = match variable.unit() {
            None | Some("1") => String::new(),
            Some(unit) => format!(" {unit}"),
        };
        let [value, from, to] = [value, from, to].map(significant);
        Some(format!(
            "{} = {value}{unit} lies on the {which} bound of its range ({from} to {to}{unit}): a better design may lie \
             beyond it.",
            variable.name()
        ))
    };
    data.study.variables().iter().filter_map(sentence).collect()
}

/// Says whether a response that is relative to the amplitude without balls shows no improvement at some point.
fn no_better_than_without_balls(data: &OptimumData) -> Vec<String> {
    let several = data.study.point_count() > 1;
    let mut notes = Vec::new();
    for (index, response) in data.study.responses().iter().enumerate() {
        // An amplitude is no better from 1 on. A probability of more than that amplitude is no better from 1/2 on.
        let (limit, what) = match response.measure {
            _ if !response.relative => continue,
            Measure::Mean => (1.0, "mean amplitude"),
            Measure::Quantile(_) => (1.0, "quantile of the amplitude"),
            Measure::Worst => (1.0, "largest amplitude"),
            Measure::Above(1.0) => (0.5, "probability of a larger amplitude"),
            _ => continue,
        };
        for row in data.finalists.iter().filter(|row| row.role == "best") {
            let Some(estimate) = row.estimates.get(index) else { continue };
            let Some(value) = estimate.value else { continue };
            let place = if several { format!(" at point {}", row.point_id) } else { String::new() };
            let interval = match (estimate.low, estimate.high) {
                (Some(low), Some(high)) => format!(" ({low:.3} to {high:.3})"),
                _ => String::new(),
            };
            let verdict = if value >= limit {
                "is no better than the machine without balls"
            } else if estimate.high.is_none_or(|high| high >= limit) {
                "is not clearly better than the machine without balls"
            } else {
                continue;
            };
            notes.push(format!(
                "The best design {verdict}{place}: {}, its {what} relative to that machine, is {value:.3}{interval}.",
                response.name
            ));
        }
    }
    notes
}
