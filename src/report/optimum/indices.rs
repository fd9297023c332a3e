//! Figure: Sobol' indices of the variables, as bars.

use super::data::{OptimumData, SensitivityFacts};
use crate::report::chart::{Axis, Colour, Figure, Panel, axis, axis_of_names};
use crate::report::figures::{BARS, bars};

/// Plots the Sobol' indices of the variables as bars, one panel per response.
pub fn indices(data: &OptimumData) -> Option<Figure> {
    let mut responses: Vec<&str> = Vec::new();
    for one in &data.sensitivities {
        if !responses.contains(&one.response.as_str()) {
            responses.push(&one.response);
        }
    }
    let mut panels = Vec::new();
    let mut sentences = Vec::new();
    for response in responses {
        let rows: Vec<&SensitivityFacts> =
            data.sensitivities.iter().filter(|one| one.response == response).collect();
        let names: Vec<String> =
            rows.iter().map(|one| data.variable_in_words(&one.variable)).collect();
        let parts = |[value, low, high]: [Option<f64>; 3]| {
            Some([value?, low.unwrap_or(f64::NAN), high.unwrap_or(f64::NAN)])
        };
        let first = rows.iter().map(|one| parts(one.first_order));
        let mut layers = bars("first order", Colour::Series(0), -BARS[0], first);
        let total = rows.iter().map(|one| parts(one.total));
        layers.extend(bars("total", Colour::Series(1), BARS[0], total));
        if layers.is_empty() {
            continue;
        }
        let known = rows.iter().filter_map(|one| Some((one, one.total[0]?)));
        if let Some((one, value)) = known.max_by(|(_, a), (_, b)| a.total_cmp(b)) {
            sentences.push(format!(
                "{response}: {} has the largest total index, {value:.2}",
                data.variable_in_words(&one.variable)
            ));
        }
        let x = axis_of_names(names, axis("", ""));
        // The axis has all bars and intervals from 0.
        let indices = rows.iter().flat_map(|one| [one.first_order, one.total]);
        let ends = indices.flatten().flatten().filter(|end| end.is_finite());
        let range =
            ends.fold([0.0, 1.0], |[low, high]: [f64; 2], end| [low.min(end), high.max(end)]);
        let y = Axis { range: Some(range), ..axis("part of the variance", "") };
        panels.push(Panel { part: response.to_owned(), ..Panel::new(x, y, layers) });
    }
    let surrogates = data.sensitivities.iter().any(|one| one.source == "surrogates");
    Figure::new(
        "sobol-indices",
        "Sobol' indices",
        format!(
            "The part of the variance of a response, over all values of ranges and choices, that a variable explains \
             alone (first order) and together with all its interactions (total).{}",
            if surrogates {
                " The indices are those of the surrogate models, whose errors are unknown: they have no intervals."
            } else {
                " Lines: 95 % intervals."
            }
        ),
        format!("{}.", sentences.join("; ")),
        panels,
    )
}
