//! Figure: each objective over each variable of the design.

use super::data::OptimumData;
use super::figures::{Evaluated, MET, NOT_MET, design_tooltips, evaluated, objective_axis};
use crate::report::chart::{Axis, AxisKind, Colour, Figure, Layer, Mark, Panel, Symbol};
use crate::report::figures::axis;
use crate::study::{DesignValue, Variable};

/// Plots a panel for each objective and variable, with a dot for each design of the search.
pub fn over_variables(data: &OptimumData) -> Option<Figure> {
    let designs = evaluated(data);
    let mut panels = Vec::new();
    for (place, (_, objective)) in data.goal.objectives().iter().enumerate() {
        let (y, factor) = objective_axis(data, objective);
        let value = |one: &Evaluated<'_>| Some(factor * one.objectives.get(place).copied()??);
        for (index, variable) in data.study.variables().iter().enumerate() {
            let of = |one: &Evaluated<'_>| match one.evaluation.values.get(index)? {
                DesignValue::Number(number) => Some(variable.shown_number(*number)),
                DesignValue::Choice(choice) => Some(*choice as f64),
            };
            let layers = [
                (NOT_MET, Colour::Series(1), Symbol::Cross),
                (MET, Colour::Series(0), Symbol::Disc),
            ];
            let layers = layers.into_iter().filter_map(|(name, colour, symbol)| {
                let own =
                    designs.iter().filter(|one| one.met == (name == MET) && value(one).is_some());
                let own: Vec<&Evaluated<'_>> = own.collect();
                let x = own.iter().filter_map(|one| of(one)).collect();
                let y = own.iter().filter_map(|one| value(one)).collect();
                let tooltips = design_tooltips(data, &own, true);
                let mark = Mark::Dots { symbol, x, y, tooltips };
                (!own.is_empty()).then(|| Layer::new(name, colour, mark))
            });
            let layers: Vec<Layer> = layers.collect();
            if layers.is_empty() {
                continue;
            }
            let title = match data.goal.objectives().len() {
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
    (!panels.is_empty()).then(|| Figure {
        id: "variables".to_owned(),
        title: "Objective over each variable".to_owned(),
        caption: "Each dot is a design of the search. The other variables vary from dot to dot."
            .to_owned(),
        alternative: format!("{} designs over {variables} variables.", designs.len()),
        one_at_a_time: panels.len() > 1,
        panels,
    })
}

fn variable_axis(variable: &Variable) -> Axis {
    let name = variable.short_name().replace('_', " ");
    let axis = axis(&name, variable.shown_unit());
    match variable.choices() {
        None => axis,
        Some(choices) => {
            let names: Vec<String> = choices.map(|choice| choice.replace('_', " ")).collect();
            Axis {
                range: Some([-0.5, names.len() as f64 - 0.5]),
                kind: AxisKind::Names(names),
                ..axis
            }
        }
    }
}
