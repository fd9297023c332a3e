//! The result of a search, as JSON and in words.

use std::fmt::Write;

use serde_json::{Value, json};

use super::difference::{difference, ratio};
use super::evaluation::Evaluation;
use super::finalists::{Finalist, Finalists, Role};
use super::goal::{Goal, values};
use super::search::{Search, SearchEnd};
use super::sensitivity::Sensitivity;
use crate::classification::Label;
use crate::responses::Estimate;
use crate::study::{DesignValue, Study};
use crate::text_table::text_table;

/// Returns the contents of `optimum.json`.
pub fn optimum_json(
    search: &Search,
    end: &SearchEnd,
    evaluations: &[Evaluation],
    finalists: &Finalists,
    sensitivities: &[Sensitivity],
) -> Value {
    let Search { study, optimization, .. } = *search;
    let goal = Goal::new(study, optimization);
    let one = |role| finalists.of(role).map(|one| final_json(study, &goal, one));
    let compared = || {
        let (best, other) = (finalists.of(Role::Best)?, finalists.of(Role::CompareWith)?);
        let of = |(place, objective): &(usize, crate::study::Objective)| {
            let (best, other) = (best.estimates.get(*place)?, other.estimates.get(*place)?);
            Some(json!({
                "response": study.responses().get(objective.response)?.name,
                "difference": estimate_json(&difference(best, other)),
                "ratio": estimate_json(&ratio(best, other)),
            }))
        };
        Some(goal.objectives().iter().filter_map(of).collect::<Vec<Value>>())
    };
    json!({
        "study": study.name(),
        "study_hash": study.hash(),
        "search": {
            "ended": match end {
                SearchEnd::Finished => "all requested designs have been evaluated",
                SearchEnd::NoMoreDesigns => "all possible designs have been evaluated",
                SearchEnd::Stopped => "stopped",
                SearchEnd::Constant(_) => "an objective is constant",
            },
            "designs": evaluations.len(),
        },
        "best": one(Role::Best),
        "compare_with": one(Role::CompareWith),
        "best_over_compare_with": compared(),
        "sensitivities": sensitivities.iter().map(sensitivity_json).collect::<Vec<_>>(),
    })
}

fn sensitivity_json(one: &Sensitivity) -> Value {
    let indices = one.indices.as_ref();
    let [first, total] = [
        indices.map(|own| (own.first_order, own.first_order_interval)),
        indices.map(|own| (own.total, own.total_interval)),
    ];
    let json = |index: Option<(f64, Option<[f64; 2]>)>| {
        index.map(|(value, interval)| {
            let [low, high] = [0, 1].map(|end| interval.map(|ends| ends[end]));
            json!({"value": value, "low": low, "high": high})
        })
    };
    json!({
        "response": one.response,
        "variable": one.variable,
        "source": one.from.name(),
        "first_order": json(first),
        "total": json(total),
        "reason": one.reason,
    })
}

fn final_json(study: &Study, goal: &Goal, one: &Finalist) -> Value {
    let estimates = goal.quantities().iter().zip(&one.estimates);
    let responses: serde_json::Map<String, Value> = estimates
        .filter_map(|(quantity, estimate)| {
            let name = study.responses().get(quantity.response)?.name.clone();
            Some((name, estimate_json(estimate)))
        })
        .collect();
    json!({
        "design": one.design,
        "values": design_json(study, &one.values),
        "responses": responses,
        "limits_met": one.met,
        "runs": one.answers.iter().map(|answer| answer.counts.total()).sum::<u64>(),
        "failed": one.answers.iter().map(|answer| answer.counts.of(Label::Failed)).sum::<u64>(),
    })
}

fn design_json(study: &Study, values: &[DesignValue]) -> Value {
    let entry = |(variable, value): (&crate::study::Variable, &DesignValue)| {
        let value = match value {
            DesignValue::Number(number) => json!(number),
            DesignValue::Choice(_) => json!(variable.describe(*value)),
        };
        (variable.name().to_owned(), value)
    };
    study.variables().iter().zip(values).map(entry).collect::<serde_json::Map<_, _>>().into()
}

fn estimate_json(estimate: &Estimate) -> Value {
    json!({
        "value": estimate.value,
        "standard_error": estimate.standard_error,
        "low": estimate.low,
        "high": estimate.high,
        "reason": estimate.reason,
    })
}

/// Returns a number with four significant digits.
pub(crate) fn short(number: f64) -> String {
    let size = number.abs();
    if number == 0.0 || (1e-3..1e5).contains(&size) {
        let digits = if number == 0.0 { 0 } else { (3 - size.log10().floor() as i32).max(0) };
        return format!("{number:.*}", digits as usize);
    }
    format!("{number:.3e}")
}

/// Returns an estimate in words, such as `2.310e-6 m (2.100e-6 to 2.500e-6)`.
pub(crate) fn in_words(estimate: &Estimate, unit: &str) -> String {
    let Some(value) = estimate.value else {
        let reason = estimate.reason.as_deref().unwrap_or("not known");
        return format!("none: {reason}");
    };
    let unit = if unit == "1" { String::new() } else { format!(" {unit}") };
    let end = |end: Option<f64>| end.map_or_else(|| "?".to_owned(), short);
    format!("{}{unit} ({} to {})", short(value), end(estimate.low), end(estimate.high))
}

/// Returns design values in words.
pub(crate) fn design_in_words(study: &Study, values: &[DesignValue]) -> String {
    let each = study.variables().iter().zip(values);
    let each = each
        .map(|(variable, value)| format!("{} = {}", variable.name(), variable.describe(*value)));
    each.collect::<Vec<_>>().join(", ")
}

/// Returns the progress line about the last design of a search.
pub fn search_line(search: &Search, evaluations: &[Evaluation]) -> String {
    let Search { study, optimization, .. } = *search;
    let goal = Goal::new(study, optimization);
    let Some(last) = evaluations.last() else { return String::new() };
    let number = evaluations.len();
    let mut line = format!(
        "{number} of {}: design {} ({}): ",
        optimization.designs,
        number - 1,
        last.origin.name()
    );
    line.push_str(&estimates_in_words(study, &goal, &goal.estimates(&last.answers)));
    if goal.objectives().len() == 1 {
        let all: Vec<Vec<Option<f64>>> =
            evaluations.iter().map(|one| values(&goal.estimates(&one.answers))).collect();
        let best = super::finalists::best(all.iter().map(|own| goal.rank(own)));
        if let Some(index) = best {
            let (grade, _) = goal.rank(&all[index]);
            let value = goal.objectives().first().and_then(|(place, _)| all[index][*place]);
            let value = value.map_or_else(|| "no value".to_owned(), short);
            let what = if grade == 0 { "best so far" } else { "limits not met yet; nearest" };
            // Writing to a string cannot fail.
            let _ = write!(line, "; {what}: {value} (design {index})");
        }
    }
    line
}

fn estimates_in_words(study: &Study, goal: &Goal, estimates: &[Estimate]) -> String {
    let each = goal.quantities().iter().zip(estimates).filter_map(|(quantity, estimate)| {
        let response = study.responses().get(quantity.response)?;
        Some(format!("{} {}", response.name, in_words(estimate, response.unit())))
    });
    each.collect::<Vec<_>>().join(", ")
}

/// Returns the result as text.
pub fn result_in_words(search: &Search, finalists: &Finalists) -> String {
    let Search { study, optimization, .. } = *search;
    let goal = Goal::new(study, optimization);
    let mut text = String::new();
    let mut describe = |title: &str, one: &Finalist| {
        let runs: u64 = one.answers.iter().map(|answer| answer.counts.total()).sum();
        let number = one.design.map_or_else(String::new, |design| format!(" (design {design})"));
        let _ = writeln!(text, "{title}{number}: {}", design_in_words(study, &one.values));
        let estimates = goal.quantities().iter().zip(&one.estimates);
        let rows = estimates.filter_map(|(quantity, estimate)| {
            let response = study.responses().get(quantity.response)?;
            Some(vec![format!("  {}", response.name), in_words(estimate, response.unit())])
        });
        text += &text_table(&rows.collect::<Vec<_>>(), &[0, 1]);
        let met = if one.met { "" } else { "; a limit is not met" };
        let failed: u64 = one.answers.iter().map(|answer| answer.counts.of(Label::Failed)).sum();
        let failed = if failed > 0 { format!(", {failed} of them failed") } else { String::new() };
        let _ = writeln!(text, "  {runs} runs of its own{failed}{met}");
    };
    if let Some(best) = finalists.of(Role::Best) {
        describe("best design", best);
    }
    for one in finalists.all.iter().filter(|one| one.on_front == Some(true)) {
        describe("on the Pareto front", one);
    }
    if let Some(other) = finalists.of(Role::CompareWith) {
        describe("compared with", other);
    }
    if let Some((best, other)) = finalists.of(Role::Best).zip(finalists.of(Role::CompareWith)) {
        for (place, objective) in goal.objectives() {
            let both = best.estimates.get(*place).zip(other.estimates.get(*place));
            let response = study.responses().get(objective.response);
            if let Some(((best, other), response)) = both.zip(response) {
                let difference = in_words(&difference(best, other), response.unit());
                let ratio = in_words(&ratio(best, other), "1");
                let _ = writeln!(text, "{}: difference {difference}", response.name);
                let _ = writeln!(text, "{}: ratio {ratio}", response.name);
            }
        }
    }
    text
}
