//! Estimates and limits as text, every number with its unit.

use super::goal::Goal;
use crate::analysis::Estimate;
use crate::numbers::{four_digits, trimmed};
use crate::study::{Limit, Study, Unit};

/// Returns a value with its unit, such as `2.310 µm`.
pub(super) fn value_in_words(value: f64, unit: &Unit) -> String {
    let Unit { symbol, .. } = unit;
    let blank = if symbol.is_empty() { "" } else { " " };
    format!("{}{blank}{symbol}", four_digits(unit.of(value)))
}

/// Returns an estimate in words, such as `2.310 µm (2.100 to 2.500)`.
pub(super) fn estimate_in_words(estimate: &Estimate, unit: &Unit) -> String {
    let Some(value) = estimate.value else {
        let reason = estimate.reason.as_deref().unwrap_or("not known");
        return format!("none: {reason}");
    };
    let end =
        |end: Option<f64>| end.map_or_else(|| "?".to_owned(), |end| four_digits(unit.of(end)));
    format!("{} ({} to {})", value_in_words(value, unit), end(estimate.low), end(estimate.high))
}

/// Returns the limits that estimates of the goal's quantities do not meet, such as
/// `quiet is 0.8500 (0.8300 to 0.8700), allowed: at least 0.9`.
pub fn unmet_limits(study: &Study, goal: &Goal, estimates: &[Estimate]) -> Vec<String> {
    let unmet = |(quantity, limit): &(usize, Limit)| {
        let estimate = estimates.get(*quantity)?;
        let is_met = |value| if limit.least { value >= limit.value } else { value <= limit.value };
        if estimate.value.is_some_and(is_met) {
            return None;
        }
        let response = study.responses().get(limit.response)?;
        let unit = study.units().of_response(response.unit());
        let found = estimate_in_words(estimate, &unit);
        let relation = if limit.least { "at least" } else { "at most" };
        let bound = format!("{} {}", trimmed(unit.of(limit.value)), unit.symbol);
        Some(format!("{} is {found}, allowed: {relation} {}", response.name, bound.trim_end()))
    };
    goal.limits.iter().filter_map(unmet).collect()
}
