//! Figures of a search: objectives by design and over each variable, the Pareto front, and the Sobol' indices.

use super::data::OptimumData;
use super::designs::{
    EvaluatedDesign, Looks, MET, NOT_MET, design_dots, evaluated, objective_axis,
};
use super::parallel::parallel_coordinates;
use crate::numbers::significant;
use crate::optimize::{Sensitivity, SobolIndex};
use crate::report::chart::{
    Axis, Colour, Figure, Layer, Mark, Panel, Symbol, Tooltips, axis, axis_of_names,
};
use crate::report::figures::{BARS, PlottedEstimate, bars};
use crate::study::{Objective, SensitivityFrom, Variable};

/// Returns all figures of a search, in reading order.
pub fn of_search(data: &OptimumData) -> Vec<Figure> {
    [
        convergence(data),
        front(data),
        over_variables(data),
        parallel_coordinates(data),
        indices(data),
    ]
    .into_iter()
    .flatten()
    .collect()
}

/// Plots each objective by design and, for one objective, the best one so far among those that meet all limits.
fn convergence(data: &OptimumData) -> Option<Figure> {
    let designs = evaluated(data);
    let mut panels = Vec::new();
    let mut sentences = Vec::new();
    let mut unknown = 0;
    let single = data.goal.objectives.len() == 1;
    for (place, (_, objective)) in data.goal.objectives.iter().enumerate() {
        let (y, _) = objective_axis(data, objective);
        let value = |design: &EvaluatedDesign<'_>| design.objectives[place];
        let mut layers = Vec::new();
        let (mut steps, mut best): (Vec<[f64; 2]>, Option<f64>) = (Vec::new(), None);
        for design in designs.iter().filter(|design| design.met) {
            let Some(value) = value(design) else { continue };
            let better =
                |before: f64| if objective.maximize { value > before } else { value < before };
            if best.is_none_or(better) {
                best = Some(value);
                steps.push([design.design as f64, value]);
            }
        }
        if let (Some(best), Some([first, _])) = (best, steps.first().copied()) {
            steps.push([designs.len().saturating_sub(1) as f64, best]);
            if single {
                let mark = Mark::Steps { points: steps };
                layers.push(Layer::new("best so far", Colour::Ink, mark));
            }
            sentences.push(format!(
                "{}: the best of the search is {} {}; the first design that meets all limits is number {first}",
                y.name,
                significant(best),
                y.unit
            ));
        } else {
            sentences.push(format!("{}: no design meets all limits", y.name));
        }
        let looks =
            [(MET, Colour::Series(0), Symbol::Disc), (NOT_MET, Colour::Series(1), Symbol::Cross)];
        let place = |design: &EvaluatedDesign<'_>| Some([design.design as f64, value(design)?]);
        layers.extend(design_dots(data, &designs, looks, false, place));
        unknown = unknown.max(designs.iter().filter(|design| value(design).is_none()).count());
        let part = if single { String::new() } else { y.name.clone() };
        panels.push(Panel { part, ..Panel::new(axis("design", ""), y, layers) });
    }
    if designs.is_empty() || panels.is_empty() {
        return None;
    }
    let missing = match unknown {
        0 => String::new(),
        1 => " One design has no value.".to_owned(),
        more => format!(" {more} designs have no value."),
    };
    let points = if data.study.point_count() > 1 { ", over all points of the sweep" } else { "" };
    Figure::new(
        "convergence",
        "Convergence of the search",
        format!(
            "The objective of each design in the order of the search{points}. The search starts with {} \
             space-filling designs; surrogate models choose the others. The values of the search are noisy, so that its \
             best value is biased; the final runs are not.{missing}",
            data.optimization.start_designs
        ),
        format!("{}.", sentences.join("; ").trim_end()),
        panels,
    )
}

/// Plots one objective over the other, with the final runs of the Pareto front.
fn front(data: &OptimumData) -> Option<Figure> {
    let [(_, first), (_, second)] = &data.goal.objectives[..] else { return None };
    let (x_axis, x_factor) = objective_axis(data, first);
    let (y_axis, y_factor) = objective_axis(data, second);
    let designs = evaluated(data);
    let place = |design: &EvaluatedDesign<'_>| match design.objectives[..] {
        [Some(x), Some(y)] => Some([x, y]),
        _ => None,
    };
    let looks = [(NOT_MET, Colour::Faint, Symbol::Cross), (MET, Colour::Series(0), Symbol::Disc)];
    let mut layers = design_dots(data, &designs, looks, true, place);
    let finals = data.front.iter().filter_map(|point| match &point.objectives[..] {
        [x, y] => {
            let scaled = |value: Option<f64>| value.map_or(f64::NAN, |value| y_factor * value);
            let (low, high) = (scaled(y.low), scaled(y.high));
            let (x, value) = (x_factor * x.value?, y_factor * y.value?);
            let design = point.design.map_or(f64::NAN, |number| number as f64);
            Some((design, PlottedEstimate { x, value, low, high }))
        }
        _ => None,
    });
    let (numbers, finals): (Vec<f64>, Vec<PlottedEstimate>) = finals.unzip();
    if !finals.is_empty() {
        let look = ("Pareto front, final runs", Colour::Series(1), Symbol::Diamond);
        let tooltips = Tooltips::numbers([("design", numbers)]);
        layers.extend(PlottedEstimate::layers(look, None, &finals, tooltips));
    }
    if layers.is_empty() {
        return None;
    }
    let remain = data.front.iter().filter(|point| point.on_front && point.met).count();
    let better = |objective: &Objective| if objective.maximize { "larger" } else { "smaller" };
    Figure::new(
        "pareto",
        "Pareto front",
        format!(
            "Both objectives of each design; {} {} and {} {} are better. Diamonds: the designs on the Pareto front of \
             the search, with the values of their final runs and the 95 % intervals of {}.",
            better(first),
            x_axis.name,
            better(second),
            y_axis.name,
            y_axis.name
        ),
        format!(
            "{} designs are on the Pareto front of the search; {remain} of them are also on the front of the final \
             runs and meet all limits there.",
            data.front.len()
        ),
        vec![Panel::new(x_axis, y_axis, layers)],
    )
}

const LOOKS: Looks =
    [(NOT_MET, Colour::Series(1), Symbol::Cross), (MET, Colour::Series(0), Symbol::Disc)];

/// Plots a panel for each objective and variable, with a dot for each design of the search.
fn over_variables(data: &OptimumData) -> Option<Figure> {
    let designs = evaluated(data);
    let mut panels = Vec::new();
    for (place, (_, objective)) in data.goal.objectives.iter().enumerate() {
        let (y, _) = objective_axis(data, objective);
        for (index, variable) in data.study.variables().iter().enumerate() {
            let at = |design: &EvaluatedDesign<'_>| {
                Some([design.number(index, variable)?, design.objectives[place]?])
            };
            let layers = design_dots(data, &designs, LOOKS, true, at);
            if layers.is_empty() {
                continue;
            }
            let title = match data.goal.objectives.len() {
                1 => String::new(),
                _ => y.name.clone(),
            };
            let part = variable.short_name().replace('_', " ");
            panels.push(Panel {
                title,
                part,
                ..Panel::new(variable_axis(variable), y.clone(), layers)
            });
        }
    }
    let variables = data.study.variables().len();
    Figure::new(
        "variables",
        "Objective over each variable",
        "Each dot is a design of the search. The other variables vary from dot to dot.",
        format!("{} designs over {variables} variables.", designs.len()),
        panels,
    )
}

fn variable_axis(variable: &Variable) -> Axis {
    let name = variable.short_name().replace('_', " ");
    let axis = axis(&name, variable.shown_unit());
    match variable.choices() {
        None => axis,
        Some(choices) => {
            let names: Vec<String> = choices.map(|choice| choice.replace('_', " ")).collect();
            axis_of_names(names, axis)
        }
    }
}

/// Plots the Sobol' indices of the variables as bars, one panel per response.
fn indices(data: &OptimumData) -> Option<Figure> {
    let mut responses: Vec<&str> = Vec::new();
    for row in &data.sensitivities {
        if !responses.contains(&row.response.as_str()) {
            responses.push(&row.response);
        }
    }
    let mut panels = Vec::new();
    let mut sentences = Vec::new();
    for response in responses {
        let rows: Vec<&Sensitivity> =
            data.sensitivities.iter().filter(|row| row.response == response).collect();
        let names: Vec<String> =
            rows.iter().map(|row| data.variable_in_words(&row.variable)).collect();
        let parts = |index: Option<SobolIndex>| {
            let SobolIndex { value, low, high } = index?;
            Some([value, low.unwrap_or(f64::NAN), high.unwrap_or(f64::NAN)])
        };
        let first = rows.iter().map(|row| parts(row.first_order));
        let mut layers = bars("first order", Colour::Series(0), -BARS[0], first);
        let total = rows.iter().map(|row| parts(row.total));
        layers.extend(bars("total", Colour::Series(1), BARS[0], total));
        if layers.is_empty() {
            continue;
        }
        sentences.extend(data.largest_total(response).map(|(variable, value)| {
            format!("{response}: {variable} has the largest total index, {value:.2}")
        }));
        let x = axis_of_names(names, axis("", ""));
        // The axis has all bars and intervals from 0.
        let indices = rows.iter().flat_map(|row| [row.first_order, row.total]);
        let ends = indices.filter_map(parts).flatten().filter(|end| end.is_finite());
        let range =
            ends.fold([0.0, 1.0], |[low, high]: [f64; 2], end| [low.min(end), high.max(end)]);
        let y = Axis { range: Some(range), ..axis("part of the variance", "") };
        panels.push(Panel { part: response.to_owned(), ..Panel::new(x, y, layers) });
    }
    let surrogates = data.sensitivities.iter().any(|row| row.source == SensitivityFrom::Surrogates);
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
