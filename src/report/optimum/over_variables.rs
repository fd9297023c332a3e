//! Figure: each objective over each variable of the design.

use super::data::OptimumData;
use super::designs::{
    EvaluatedDesign, Looks, MET, NOT_MET, design_dots, evaluated, objective_axis,
};
use crate::report::chart::{Axis, Colour, Figure, Panel, Symbol, axis, axis_of_names};
use crate::study::Variable;

const LOOKS: Looks =
    [(NOT_MET, Colour::Series(1), Symbol::Cross), (MET, Colour::Series(0), Symbol::Disc)];

/// Plots a panel for each objective and variable, with a dot for each design of the search.
pub fn over_variables(data: &OptimumData) -> Option<Figure> {
    let designs = evaluated(data);
    let mut panels = Vec::new();
    for (place, (_, objective)) in data.goal.objectives.iter().enumerate() {
        let (y, factor) = objective_axis(data, objective);
        let value =
            |design: &EvaluatedDesign<'_>| Some(factor * design.objectives.get(place).copied()??);
        for (index, variable) in data.study.variables().iter().enumerate() {
            let place = |design: &EvaluatedDesign<'_>| {
                Some([design.number(index, variable)?, value(design)?])
            };
            let layers = design_dots(data, &designs, LOOKS, true, place);
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
