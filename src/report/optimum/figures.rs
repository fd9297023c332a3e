//! Figures of a search: objectives by design, and the Pareto front.

use super::data::OptimumData;
use super::designs::{EvaluatedDesign, MET, NOT_MET, design_dots, evaluated, objective_axis};
use super::indices::indices;
use super::over_variables::over_variables;
use super::parallel::parallel_coordinates;
use crate::numbers::significant;
use crate::report::chart::{Colour, Figure, Layer, Mark, Panel, Symbol, Tooltips, axis};
use crate::study::Objective;
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
        let (y, factor) = objective_axis(data, objective);
        let value =
            |design: &EvaluatedDesign<'_>| Some(factor * design.objectives.get(place).copied()??);
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
        [Some(x), Some(y)] => Some([x_factor * x, y_factor * y]),
        _ => None,
    };
    let looks = [(NOT_MET, Colour::Faint, Symbol::Cross), (MET, Colour::Series(0), Symbol::Disc)];
    let mut layers = design_dots(data, &designs, looks, true, place);
    let finals = data.front.iter().filter_map(|point| match &point.objectives[..] {
        [x, y] => {
            let scaled = |value: Option<f64>| value.map_or(f64::NAN, |value| y_factor * value);
            let ends = [scaled(y.low), scaled(y.high)];
            Some((point, [x_factor * x.value?, y_factor * y.value?], ends))
        }
        _ => None,
    });
    let finals: Vec<_> = finals.collect();
    if !finals.is_empty() {
        let name = "Pareto front, final runs";
        let column = |pick: fn([f64; 2], [f64; 2]) -> f64| -> Vec<f64> {
            finals.iter().map(|shown| pick(shown.1, shown.2)).collect()
        };
        let x = column(|place, _| place[0]);
        let tooltips = Tooltips::numbers([(
            "design",
            finals.iter().map(|(point, ..)| point.design.map_or(f64::NAN, |n| n as f64)).collect(),
        )]);
        let intervals = Mark::Intervals {
            x: x.clone(),
            low: column(|_, ends| ends[0]),
            high: column(|_, ends| ends[1]),
        };
        let dots =
            Mark::Dots { symbol: Symbol::Diamond, x, y: column(|place, _| place[1]), tooltips };
        layers.extend([intervals, dots].map(|mark| Layer::new(name, Colour::Series(1), mark)));
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
