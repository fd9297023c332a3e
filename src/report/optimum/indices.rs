//! Figure: Sobol' indices of the variables, as bars.

use super::data::{OptimumData, SensitivityFacts};
use crate::report::chart::{Axis, AxisKind, Colour, Figure, Layer, Mark, Panel, Tooltips};
use crate::report::figures::axis;

/// Half the distance between the two bars of a variable, and the width of each, on the abscissa.
const BARS: [f64; 2] = [0.19, 0.34];

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
        let mut layers =
            bars("first order", Colour::Series(0), -BARS[0], &rows, |one| one.first_order);
        layers.extend(bars("total", Colour::Series(1), BARS[0], &rows, |one| one.total));
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
        let x = Axis {
            range: Some([-0.5, names.len() as f64 - 0.5]),
            kind: AxisKind::Names(names),
            ..axis("", "")
        };
        // The axis has all bars and intervals from 0.
        let indices = rows.iter().flat_map(|one| [one.first_order, one.total]);
        let ends = indices.flatten().flatten().filter(|end| end.is_finite());
        let range =
            ends.fold([0.0, 1.0], |[low, high]: [f64; 2], end| [low.min(end), high.max(end)]);
        let y = Axis { range: Some(range), ..axis("part of the variance", "") };
        panels.push(Panel { part: response.to_owned(), ..Panel::new(x, y, layers) });
    }
    if panels.is_empty() {
        return None;
    }
    let surrogates = data.sensitivities.iter().any(|one| one.source == "surrogates");
    Some(Figure {
        id: "sobol-indices".to_owned(),
        title: "Sobol' indices".to_owned(),
        caption: format!(
            "The part of the variance of a response, over all values of ranges and choices, that a variable explains \
             alone (first order) and together with all its interactions (total).{}",
            if surrogates {
                " The indices are those of the surrogate models, whose errors are unknown: they have no intervals."
            } else {
                " Lines: 95 % intervals."
            }
        ),
        alternative: format!("{}.", sentences.join("; ")),
        one_at_a_time: panels.len() > 1,
        panels,
    })
}

/// Returns bars with their intervals, at whole numbers shifted by `shift`; empty if there is none.
fn bars(
    name: &str,
    colour: Colour,
    shift: f64,
    rows: &[&SensitivityFacts],
    of: fn(&SensitivityFacts) -> [Option<f64>; 3],
) -> Vec<Layer> {
    let known = rows.iter().enumerate().filter_map(|(place, one)| {
        let [value, low, high] = of(one);
        let end = |end: Option<f64>| end.unwrap_or(f64::NAN);
        Some((place as f64 + shift, [value?, end(low), end(high)]))
    });
    let (x, values): (Vec<f64>, Vec<[f64; 3]>) = known.unzip();
    let [y, low, high] =
        [0, 1, 2].map(|part| values.iter().map(|value| value[part]).collect::<Vec<f64>>());
    if x.is_empty() {
        return Vec::new();
    }
    let has_interval = low.iter().any(|low| low.is_finite());
    let tooltips = Tooltips::numbers([("from", low.clone()), ("to", high.clone())]);
    let bars = Mark::Bars { x: x.clone(), y, width: BARS[1], tooltips };
    let intervals = has_interval.then_some(Mark::Intervals { x, low, high });
    let intervals = intervals.map(|mark| Layer::new(name, Colour::Ink, mark));
    std::iter::once(Layer::new(name, colour, bars)).chain(intervals).collect()
}
