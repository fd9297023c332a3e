//! The evaluated designs of a search, as the figures show them.

use super::data::OptimumData;
use crate::optimize::Evaluation;
use crate::report::chart::{
    Axis, Colour, Layer, Mark, Symbol, TooltipColumn, TooltipValues, Tooltips, axis,
};
use crate::study::{DesignValue, Objective, Variable};

pub(super) const MET: &str = "meets all limits";
pub(super) const NOT_MET: &str = "does not meet all limits";

/// An evaluated design with its values of the objectives.
pub(super) struct EvaluatedDesign<'a> {
    pub design: usize,
    pub evaluation: &'a Evaluation,
    /// The values of the objectives in the units in which they are shown.
    pub objectives: Vec<Option<f64>>,
    pub met: bool,
}

impl EvaluatedDesign<'_> {
    /// Returns the value of a variable in the unit that the study chooses, or the number of its choice.
    pub fn number(&self, index: usize, variable: &Variable) -> Option<f64> {
        Some(match self.evaluation.values.get(index)? {
            DesignValue::Number(number) => variable.shown_number(*number),
            DesignValue::Choice(choice) => *choice as f64,
        })
    }
}

pub(super) fn evaluated(data: &OptimumData) -> Vec<EvaluatedDesign<'_>> {
    let mut designs = Vec::new();
    for (design, evaluation) in data.evaluations.iter().enumerate() {
        let values = data.values(evaluation);
        let objective = |(quantity, objective): &(usize, Objective)| {
            let (_, factor) = objective_axis(data, objective);
            Some(factor * values.get(*quantity).copied()??)
        };
        let objectives = data.goal.objectives.iter().map(objective).collect();
        let met = data.goal.is_met(&values);
        designs.push(EvaluatedDesign { design, evaluation, objectives, met });
    }
    designs
}

/// Returns the axis of an objective, and the factor of its values.
pub(super) fn objective_axis(data: &OptimumData, objective: &Objective) -> (Axis, f64) {
    let (name, unit) = data.response(objective.response);
    (axis(name, &unit.symbol), unit.si.recip())
}

/// Returns the data of designs: their numbers, variables and origins.
pub(super) fn design_tooltips(
    data: &OptimumData,
    designs: &[&EvaluatedDesign<'_>],
    numbers: bool,
) -> Tooltips {
    let mut columns = Vec::new();
    let mut add = |name: String, values| columns.push(TooltipColumn { name, values });
    if numbers {
        let values = designs.iter().map(|design| design.design as f64).collect();
        add("design".to_owned(), TooltipValues::Numbers(values));
    }
    for (index, variable) in data.study.variables().iter().enumerate() {
        let values = designs.iter().map(|design| design.evaluation.values.get(index));
        let word = |value: Option<&DesignValue>| {
            value.map_or_else(String::new, |value| Variable::describe(variable, *value))
        };
        let numbers =
            designs.iter().map(|design| design.number(index, variable).unwrap_or(f64::NAN));
        let values = match variable.range() {
            Some(_) => TooltipValues::Numbers(numbers.collect()),
            None => TooltipValues::Words(values.map(word).collect()),
        };
        add(variable.shown_name(), values);
    }
    let origins = designs.iter().map(|design| design.evaluation.origin.name().replace('_', " "));
    add("origin".to_owned(), TooltipValues::Words(origins.collect()));
    Tooltips { run_ids: Vec::new(), columns }
}

/// The names of designs that meet all limits or not, with colour and symbol.
pub(super) type Looks = [(&'static str, Colour, Symbol); 2];

/// Returns dots of the designs that have a place, with their numbers in the data if wanted.
pub(super) fn design_dots(
    data: &OptimumData,
    designs: &[EvaluatedDesign<'_>],
    looks: Looks,
    numbers: bool,
    place: impl Fn(&EvaluatedDesign<'_>) -> Option<[f64; 2]>,
) -> Vec<Layer> {
    let layer = |(name, colour, symbol): (&str, Colour, Symbol)| {
        let of_look = designs.iter().filter(|design| design.met == (name == MET));
        let known = of_look.filter_map(|design| Some((design, place(design)?)));
        let (shown, places): (Vec<&EvaluatedDesign<'_>>, Vec<[f64; 2]>) = known.unzip();
        let mark = Mark::dots(symbol, &places, design_tooltips(data, &shown, numbers));
        (!shown.is_empty()).then(|| Layer::new(name, colour, mark))
    };
    looks.into_iter().filter_map(layer).collect()
}
