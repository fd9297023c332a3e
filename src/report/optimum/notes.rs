//! What a reader of an optimum should know: bounds of ranges, limits, and the comparison with the machine without balls.

use serde_json::Value;

use super::data::OptimumData;
use crate::analysis::Measure;
use crate::numbers::counted;
use crate::study::AmplitudeKind;

/// Returns sentences about the best design; empty if nothing is remarkable.
pub fn notes(data: &OptimumData) -> Vec<String> {
    let mut notes = Vec::new();
    if data.optimum.is_none() {
        notes.push(unfinished(data));
    }
    if let Some(best) = data.design("best").filter(|best| best["limits_met"] == false) {
        let unmet = best["unmet_limits"].as_array().into_iter().flatten();
        let unmet: Vec<&str> = unmet.filter_map(Value::as_str).collect();
        let unmet =
            if unmet.is_empty() { String::new() } else { format!(": {}", unmet.join("; ")) };
        notes.push(format!("The best design does not meet all limits in its final runs{unmet}."));
    }
    let of_best = data.optimum.as_ref().and_then(|optimum| optimum["notes"].as_array());
    let of_best = of_best.into_iter().flatten().filter_map(Value::as_str);
    notes.extend(of_best.map(str::to_owned));
    notes.extend(compared_with_no_balls(data));
    notes
}

/// Says what an unfinished search lacks.
fn unfinished(data: &OptimumData) -> String {
    let (done, all) = (data.evaluations.len() as u64, data.optimization.designs);
    let continues = "The same command continues it.";
    if done >= all {
        let designs = counted(all, "design");
        return format!(
            "The search is not finished: all {designs} are evaluated, and the final runs are missing. {continues}"
        );
    }
    format!(
        "The search is not finished: {done} of {} are evaluated, and the final runs are missing. {continues}",
        counted(all, "design")
    )
}

/// Says whether the amplitudes of the best design, relative to those without balls, show no improvement at some point.
fn compared_with_no_balls(data: &OptimumData) -> Vec<String> {
    let mut notes = Vec::new();
    let several = data.study.point_count() > 1;
    for (index, response) in data.study.responses().iter().enumerate() {
        // An amplitude is no better from 1 on. A probability of more than that amplitude is no better from 1/2 on.
        let (limit, what) = match response.measure {
            _ if response.amplitude != AmplitudeKind::RelativeResidual => continue,
            Measure::Quantile(_) => (1.0, "quantile of the amplitude"),
            Measure::Worst => (1.0, "largest amplitude"),
            Measure::Above(1.0) => (0.5, "probability of a larger amplitude"),
            _ => continue,
        };
        for (point_id, estimates) in &data.best {
            let Some(estimate) = estimates.get(index) else { continue };
            let Some(value) = estimate.value else { continue };
            let place = if several { format!(" at point {point_id}") } else { String::new() };
            let interval = match (estimate.low, estimate.high) {
                (Some(low), Some(high)) => format!(" ({low:.3} to {high:.3})"),
                _ => String::new(),
            };
            let verdict = if estimate.low.is_some_and(|low| low > limit) {
                "is worse than the machine without balls"
            } else if estimate.high.unwrap_or(value) >= limit {
                "cannot be distinguished from the machine without balls"
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
