//! Figure: parallel coordinates, an upright axis for each variable and each objective, and a line for each design.

use super::data::OptimumData;
use super::designs::{EvaluatedDesign, MET, NOT_MET, design_tooltips, evaluated, objective_axis};
use crate::numbers::trimmed;
use crate::report::chart::{Axis, AxisKind, Colour, Figure, Layer, Mark, Panel, Symbol, axis};
use crate::study::Variable;

/// The values of one axis, one for each design, and the name of the axis with its ends.
struct ParallelAxis {
    name: String,
    values: Vec<Option<f64>>,
    ends: [f64; 2],
}

/// Plots all designs; `None` with a single variable, whose figure shows the same.
pub fn parallel_coordinates(data: &OptimumData) -> Option<Figure> {
    let designs = evaluated(data);
    let variables = data.study.variables();
    let of_variables = variables.iter().enumerate().map(|(index, variable)| {
        let value = |design: &EvaluatedDesign<'_>| design.number(index, variable);
        upright(
            &variable.short_name(),
            variable.shown_unit(),
            designs.iter().map(value),
            Some(variable),
        )
    });
    let objectives = data.goal.objectives.iter().enumerate().map(|(place, (_, objective))| {
        let (axis, _) = objective_axis(data, objective);
        let values = designs.iter().map(|design| design.objectives[place]);
        upright(&axis.name, &axis.unit, values, None)
    });
    let axes: Vec<ParallelAxis> = of_variables.chain(objectives).collect();
    if variables.len() < 2 || designs.is_empty() {
        return None;
    }
    // The best design meets all limits and has the best value of the only objective.
    let best = match &data.goal.objectives[..] {
        [(_, objective)] => {
            let value = |place: &usize| {
                let value = designs[*place].objectives[0]?;
                Some(if objective.maximize { -value } else { value })
            };
            let met = (0..designs.len()).filter(|place| designs[*place].met);
            let known = met.filter_map(|place| Some((place, value(&place)?)));
            known.min_by(|(_, a), (_, b)| a.total_cmp(b)).map(|(place, _)| place)
        }
        _ => None,
    };
    let mut layers = Vec::new();
    for (name, colour, belongs) in [
        (NOT_MET, Colour::Faint, &(|place: usize| !designs[place].met) as &dyn Fn(usize) -> bool),
        (MET, Colour::Series(0), &|place| designs[place].met && Some(place) != best),
        ("best of the search", Colour::Ink, &|place| Some(place) == best),
    ] {
        let chosen: Vec<usize> = (0..designs.len()).filter(|place| belongs(*place)).collect();
        if chosen.is_empty() {
            continue;
        }
        let (mut points, mut dots, mut of) = (Vec::new(), Vec::new(), Vec::new());
        for &place in &chosen {
            for (x, axis) in axes.iter().enumerate() {
                let [low, high] = axis.ends;
                let part = axis.values[place].map(|value| match high > low {
                    true => (value - low) / (high - low),
                    false => 0.5,
                });
                points.push([x as f64, part.unwrap_or(f64::NAN)]);
                dots.extend(part.map(|part| [x as f64, part]));
                of.extend(part.map(|_| &designs[place]));
            }
            // A point that is not finite ends the line of a design.
            points.push([f64::NAN; 2]);
        }
        let dots = Mark::dots(Symbol::Dot, &dots, design_tooltips(data, &of, true));
        layers.extend(
            [Mark::Line { points, dashed: false }, dots].map(|mark| Layer::new(name, colour, mark)),
        );
    }
    let uprights = (0..axes.len()).flat_map(|x| {
        let x = x as f64;
        [[x, 0.0], [x, 1.0], [f64::NAN; 2]]
    });
    let uprights = Mark::Line { points: uprights.collect(), dashed: false };
    layers.insert(0, Layer::new("", Colour::Faint, uprights));
    let names: Vec<String> = axes.iter().map(|axis| axis.name.clone()).collect();
    let x = Axis { kind: AxisKind::Names(names), ..axis("", "") };
    let y = Axis { range: Some([-0.02, 1.02]), ..axis("part of the range of the designs", "") };
    Figure::new(
        "parallel-coordinates",
        "All designs in parallel coordinates",
        "Each line is a design of the search. The name of an axis has the values at its lower and its upper end.",
        format!("{} designs over {} axes.", designs.len(), axes.len()),
        vec![Panel::new(x, y, layers)],
    )
}

/// Returns an axis from the least to the largest value.
fn upright(
    name: &str,
    unit: &str,
    values: impl Iterator<Item = Option<f64>>,
    variable: Option<&Variable>,
) -> ParallelAxis {
    let values: Vec<Option<f64>> = values.collect();
    let known = || values.iter().copied().flatten();
    let ends = [known().fold(f64::INFINITY, f64::min), known().fold(f64::NEG_INFINITY, f64::max)];
    let choices: Vec<&str> = variable.and_then(Variable::choices).into_iter().flatten().collect();
    let [low, high] = ends.map(|end| match choices.get(end as usize) {
        Some(choice) => choice.replace('_', " "),
        None => trimmed(end),
    });
    let range = if low == high { low } else { format!("{low} to {high}") };
    ParallelAxis {
        name: format!("{}: {range} {unit}", name.replace('_', " ")).trim_end().to_owned(),
        values,
        ends,
    }
}
