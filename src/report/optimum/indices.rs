//! Figure: Sobol' indices of the variables, as bars.

use super::data::{OptimumData, SensitivityFacts};
use crate::report::chart::{Axis, Colour, Figure, Panel, axis, axis_of_names};
use crate::report::figures::{BARS, bars};

/// Plots the Sobol' indices of the variables as bars, one panel per response.
pub fn indices(data: &OptimumData) -> Option<Figure> {
    let mut responses: Vec<&str> = Vec::new();
    for row in &data.sensitivities {
        if !responses.contains(&row.response.as_str()) {
            responses.push(&row.response);
        }
    }
    let mut panels = Vec::new();
    let mut sentences = Vec::new();
    for response in responses {
        let rows: Vec<&SensitivityFacts> =
            data.sensitivities.iter().filter(|row| row.response == response).collect();
        let names: Vec<String> =
            rows.iter().map(|row| data.variable_in_words(&row.variable)).collect();
        let parts = |[value, low, high]: [Option<f64>; 3]| {
            Some([value?, low.unwrap_or(f64::NAN), high.unwrap_or(f64::NAN)])
        };
        let first = rows.iter().map(|row| parts(row.first_order));
        let mut layers = bars("first order", Colour::Series(0), -BARS[0], first);
        let total = rows.iter().map(|row| parts(row.total));
        layers.extend(bars("total", Colour::Series(1), BARS[0], total));
        if layers.is_empty() {
            continue;
        }
        let known = rows.iter().filter_map(|row| Some((row, row.total[0]?)));
        if let Some((row, value)) = known.max_by(|(_, a), (_, b)| a.total_cmp(b)) {
            sentences.push(format!(
                "{response}: {} has the largest total index, {value:.2}",
                data.variable_in_words(&row.variable)
            ));
        }
        let x = axis_of_names(names, axis("", ""));
        // The axis has all bars and intervals from 0.
        let indices = rows.iter().flat_map(|row| [row.first_order, row.total]);
        let ends = indices.flatten().flatten().filter(|end| end.is_finite());
        let range =
            ends.fold([0.0, 1.0], |[low, high]: [f64; 2], end| [low.min(end), high.max(end)]);
        let y = Axis { range: Some(range), ..axis("part of the variance", "") };
        panels.push(Panel { part: response.to_owned(), ..Panel::new(x, y, layers) });
    }
    let surrogates = data.sensitivities.iter().any(|row| row.source == "surrogates");
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
