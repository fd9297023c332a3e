//! The result of a search, as JSON and in words, every number with its unit.

use std::fmt::Write;

use serde_json::{Value, json};

use super::evaluations::Evaluation;
use super::finalists::{Finalist, FinalistRole, of_role};
use super::goal::{Goal, best, values};
use super::notes::{notes, on_bounds};
use super::search::{Search, SearchEnd};
use super::sensitivity::Sensitivity;
use crate::analysis::{Estimate, estimate_difference, estimate_ratio};
use crate::numbers::{four_digits, trimmed};
use crate::printed_table::text_table;
use crate::responses::design_json;
use crate::study::{DesignValue, Limit, Objective, Response, Study, Unit};

/// Returns the contents of `optimum.json`.
pub fn optimum_json(
    search: &Search,
    end: SearchEnd,
    evaluations: &[Evaluation],
    finalists: &[Finalist],
    sensitivities: &[Sensitivity],
) -> Value {
    let study = search.study;
    let finals = |role| of_role(finalists, role).map(|finalist| final_json(search, finalist));
    let compared = compared(search, finalists).map(|objectives| {
        let json = |(response, [difference, ratio]): &(&Response, [Estimate; 2])| {
            json!({"response": response.name, "difference": difference, "ratio": ratio})
        };
        objectives.iter().map(json).collect::<Vec<Value>>()
    });
    json!({
        "study": study.name(),
        "study_hash": study.hash(),
        "search": {
            "ended": end.in_words(),
            "designs": evaluations.len(),
        },
        "best": finals(FinalistRole::Best),
        "compare_with": finals(FinalistRole::CompareWith),
        "best_over_compare_with": compared,
        "notes": best_notes(study, finalists),
        "sensitivities": sensitivities,
    })
}

/// Returns the notes on the best design; empty if there is none.
fn best_notes(study: &Study, finalists: &[Finalist]) -> Vec<String> {
    of_role(finalists, FinalistRole::Best).map_or_else(Vec::new, |best| notes(study, best))
}

/// Returns difference and ratio of the best design and the reference for each objective; `None` without one of these designs.
fn compared<'a>(
    search: &Search<'a>,
    finalists: &[Finalist],
) -> Option<Vec<(&'a Response, [Estimate; 2])>> {
    let [best, other] =
        [FinalistRole::Best, FinalistRole::CompareWith].map(|role| of_role(finalists, role));
    let (best, other, study) = (best?, other?, search.study);
    let of = |(quantity, objective): &(usize, Objective)| {
        let (best, other) = (best.estimates.get(*quantity)?, other.estimates.get(*quantity)?);
        let both = [estimate_difference(best, other, 0.0), estimate_ratio(best, other)];
        Some((study.responses().get(objective.response)?, both))
    };
    Some(search.goal.objectives.iter().filter_map(of).collect())
}

fn final_json(search: &Search, finalist: &Finalist) -> Value {
    let Search { study, ref goal, .. } = *search;
    let estimates = goal.quantities.iter().zip(&finalist.estimates);
    let responses: serde_json::Map<String, Value> = estimates
        .map(|(quantity, estimate)| {
            (study.responses()[quantity.response].name.clone(), json!(estimate))
        })
        .collect();
    json!({
        "design": finalist.design,
        "values": design_json(study, &finalist.values),
        "responses": responses,
        "relative_amplitudes": finalist.relative_amplitudes,
        "on_bounds": on_bounds(study, &finalist.values)
            .into_iter()
            .map(|bound| json!({"variable": bound.variable.name(), "bound": bound.which}))
            .collect::<Vec<_>>(),
        "limits_met": finalist.met,
        "unmet_limits": unmet_limits(study, goal, &finalist.estimates),
        "runs": finalist.runs(),
        "failed": finalist.failed_runs(),
    })
}

/// Returns design values in words.
fn design_in_words(study: &Study, values: &[DesignValue]) -> String {
    let each = study.variables().iter().zip(values);
    let each = each.map(|(variable, value)| match variable.shown_unit() {
        "" => format!("{} = {}", variable.name(), variable.describe(*value)),
        _ => variable.in_words(*value).replacen(' ', " = ", 1),
    });
    each.collect::<Vec<_>>().join(", ")
}

/// Returns the progress line about the last design of a search.
pub fn search_line(search: &Search, evaluations: &[Evaluation]) -> String {
    let Search { study, optimization, ref goal, .. } = *search;
    let Some(last) = evaluations.last() else { return String::new() };
    let number = evaluations.len();
    let mut line = format!(
        "{number} of {}: design {} ({}): ",
        optimization.designs,
        number - 1,
        last.origin.name()
    );
    let estimates = estimates_in_words(search, &goal.estimates(&last.answers));
    line += &estimates.iter().map(|words| words.join(" ")).collect::<Vec<_>>().join(", ");
    if goal.objectives.len() == 1 {
        let all = goal.values_of_designs(evaluations);
        let best = best(all.iter().map(|values| goal.rank(values)));
        if let Some(index) = best {
            let (grade, _) = goal.rank(&all[index]);
            let (quantity, objective) = goal.objectives[0];
            let unit = study.units().of_response(study.responses()[objective.response].unit());
            let value = all[index][quantity]
                .map_or_else(|| "no value".to_owned(), |value| value_in_words(value, &unit));
            let what = if grade == 0 { "best so far" } else { "limits not met yet; nearest" };
            // Writing to a string cannot fail.
            let _ = write!(line, "; {what}: {value} (design {index})");
        }
    }
    line
}

/// Returns the names of the responses of the goal's quantities, and their estimates in words.
fn estimates_in_words(search: &Search, estimates: &[Estimate]) -> Vec<[String; 2]> {
    let Search { study, ref goal, .. } = *search;
    let each = goal.quantities.iter().zip(estimates).map(|(quantity, estimate)| {
        let response = &study.responses()[quantity.response];
        let unit = study.units().of_response(response.unit());
        [response.name.clone(), estimate_in_words(estimate, &unit)]
    });
    each.collect()
}

/// Returns the result as text.
pub fn result_in_words(search: &Search, finalists: &[Finalist]) -> String {
    let study = search.study;
    let mut text = String::new();
    let mut describe = |title: &str, finalist: &Finalist| {
        let number =
            finalist.design.map_or_else(String::new, |design| format!(" (design {design})"));
        let _ = writeln!(text, "{title}{number}: {}", design_in_words(study, &finalist.values));
        let rows = estimates_in_words(search, &finalist.estimates).into_iter();
        let rows = rows.map(|[name, estimate]| vec![format!("  {name}"), estimate]);
        text += &text_table(&rows.collect::<Vec<_>>(), &[0, 1]);
        let failed = match finalist.failed_runs() {
            0 => String::new(),
            failed => format!(", {failed} of them failed"),
        };
        let _ = writeln!(text, "  {} further runs{failed}", finalist.runs());
        for limit in unmet_limits(study, &search.goal, &finalist.estimates) {
            let _ = writeln!(text, "  a limit is not met: {limit}");
        }
        if let Some((least, most)) = range(&finalist.relative_amplitudes) {
            let range = if least == most { least } else { format!("{least} to {most}") };
            let _ = writeln!(text, "  mean amplitude divided by that without balls: {range}");
        }
    };
    if let Some(best) = of_role(finalists, FinalistRole::Best) {
        describe("best design", best);
    }
    for finalist in finalists.iter().filter(|finalist| finalist.on_front == Some(true)) {
        describe("on the Pareto front", finalist);
    }
    if let Some(other) = of_role(finalists, FinalistRole::CompareWith) {
        describe("compared with", other);
    }
    for (response, [difference, ratio]) in compared(search, finalists).into_iter().flatten() {
        let [unit, plain] = [response.unit(), "1"].map(|unit| study.units().of_response(unit));
        let (difference, ratio) =
            (estimate_in_words(&difference, &unit), estimate_in_words(&ratio, &plain));
        let _ = writeln!(text, "{}: difference {difference}", response.name);
        let _ = writeln!(text, "{}: ratio {ratio}", response.name);
    }
    for note in best_notes(study, finalists) {
        let _ = writeln!(text, "note: {note}");
    }
    text
}

/// Returns the limits that the best design does not meet, unless a design meets all limits. If there are no final runs, it is
/// the design of the search that is nearest to the limits.
pub fn unmet(
    search: &Search,
    evaluations: &[Evaluation],
    finalists: &[Finalist],
) -> Option<Vec<String>> {
    let Search { study, ref goal, .. } = *search;
    let is_best_met = of_role(finalists, FinalistRole::Best).is_some_and(|best| best.met);
    if is_best_met || finalists.iter().any(|finalist| finalist.on_front == Some(true)) {
        return None;
    }
    let found = finalists.iter().filter(|finalist| finalist.role != FinalistRole::CompareWith);
    let found =
        found.filter(|finalist| finalist.role == FinalistRole::Best || finalist.on_front.is_some());
    let mut all: Vec<Vec<Estimate>> = found.map(|finalist| finalist.estimates.clone()).collect();
    if all.is_empty() {
        all = evaluations.iter().map(|evaluation| goal.estimates(&evaluation.answers)).collect();
    }
    let nearest = best(all.iter().map(|estimates| goal.rank(&values(estimates))));
    let nearest = nearest.and_then(|index| all.get(index));
    Some(nearest.map_or_else(Vec::new, |estimates| unmet_limits(study, goal, estimates)))
}

/// Returns the smallest and the largest known value.
fn range(estimates: &[Estimate]) -> Option<(String, String)> {
    let values = || estimates.iter().filter_map(|estimate| estimate.value);
    Some((four_digits(values().reduce(f64::min)?), four_digits(values().reduce(f64::max)?)))
}

/// Returns a value with its unit, such as `2.310 µm`.
fn value_in_words(value: f64, unit: &Unit) -> String {
    let Unit { symbol, .. } = unit;
    let blank = if symbol.is_empty() { "" } else { " " };
    format!("{}{blank}{symbol}", four_digits(unit.of(value)))
}

/// Returns an estimate in words, such as `2.310 µm (2.100 to 2.500)`.
fn estimate_in_words(estimate: &Estimate, unit: &Unit) -> String {
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
