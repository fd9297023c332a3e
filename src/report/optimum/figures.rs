//! Figures of a search: objectives by design, and the Pareto front.

use super::data::OptimumData;
use super::indices::indices;
use super::over_variables::over_variables;
use super::parallel::parallel_coordinates;
use crate::numbers::significant;
use crate::optimize::Evaluation;
use crate::report::chart::{
    Axis, Colour, Figure, Layer, Mark, Panel, Symbol, TooltipColumn, TooltipValues, Tooltips, axis,
};
use crate::study::{DesignValue, Objective, Variable};

pub(super) const MET: &str = "meets all limits";
pub(super) const NOT_MET: &str = "does not meet all limits";

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

/// An evaluated design with its values of the objectives.
pub(super) struct Evaluated<'a> {
    design: usize,
    pub evaluation: &'a Evaluation,
    pub objectives: Vec<Option<f64>>,
    pub met: bool,
}

impl Evaluated<'_> {
    /// Returns the value of a variable in the unit that the study chooses, or the number of its choice.
    pub fn number(&self, index: usize, variable: &Variable) -> Option<f64> {
        Some(match self.evaluation.values.get(index)? {
            DesignValue::Number(number) => variable.shown_number(*number),
            DesignValue::Choice(choice) => *choice as f64,
        })
    }
}

pub(super) fn evaluated(data: &OptimumData) -> Vec<Evaluated<'_>> {
    let mut designs = Vec::new();
    for (design, evaluation) in data.evaluations.iter().enumerate() {
        let values = data.values(evaluation);
        let quantities = data.goal.objectives.iter().map(|(quantity, _)| *quantity);
        let objectives = quantities.map(|quantity| values.get(quantity).copied().flatten());
        let (objectives, met) = (objectives.collect(), data.goal.is_met(&values));
        designs.push(Evaluated { design, evaluation, objectives, met });
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
    designs: &[&Evaluated<'_>],
    numbers: bool,
) -> Tooltips {
    let mut columns = Vec::new();
    let mut add = |name: String, values| columns.push(TooltipColumn { name, values });
    if numbers {
        let values = designs.iter().map(|one| one.design as f64).collect();
        add("design".to_owned(), TooltipValues::Numbers(values));
    }
    for (index, variable) in data.study.variables().iter().enumerate() {
        let values = designs.iter().map(|one| one.evaluation.values.get(index));
        let word = |value: Option<&DesignValue>| {
            value.map_or_else(String::new, |value| Variable::describe(variable, *value))
        };
        let numbers = designs.iter().map(|one| one.number(index, variable).unwrap_or(f64::NAN));
        let values = match variable.range() {
            Some(_) => TooltipValues::Numbers(numbers.collect()),
            None => TooltipValues::Words(values.map(word).collect()),
        };
        add(variable.shown_name(), values);
    }
    let origins = designs.iter().map(|one| one.evaluation.origin.name().replace('_', " "));
    add("origin".to_owned(), TooltipValues::Words(origins.collect()));
    Tooltips { run_ids: Vec::new(), columns }
}

/// The names of designs that meet all limits or not, with colour and symbol.
pub(super) type Looks = [(&'static str, Colour, Symbol); 2];

/// Returns dots of the designs that have a place, with their numbers in the data if wanted.
pub(super) fn design_dots(
    data: &OptimumData,
    designs: &[Evaluated<'_>],
    looks: Looks,
    numbers: bool,
    place: impl Fn(&Evaluated<'_>) -> Option<[f64; 2]>,
) -> Vec<Layer> {
    let layer = |(name, colour, symbol): (&str, Colour, Symbol)| {
        let own = designs.iter().filter(|one| one.met == (name == MET));
        let known = own.filter_map(|one| Some((one, place(one)?)));
        let (own, places): (Vec<&Evaluated<'_>>, Vec<[f64; 2]>) = known.unzip();
        let [x, y] = [0, 1].map(|axis| places.iter().map(|place| place[axis]).collect());
        let tooltips = design_tooltips(data, &own, numbers);
        let mark = Mark::Dots { symbol, x, y, tooltips };
        (!own.is_empty()).then(|| Layer::new(name, colour, mark))
    };
    looks.into_iter().filter_map(layer).collect()
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
        let value = |one: &Evaluated<'_>| Some(factor * one.objectives.get(place).copied()??);
        let mut layers = Vec::new();
        let (mut steps, mut best): (Vec<[f64; 2]>, Option<f64>) = (Vec::new(), None);
        for one in designs.iter().filter(|one| one.met) {
            let Some(value) = value(one) else { continue };
            let better =
                |before: f64| if objective.maximize { value > before } else { value < before };
            if best.is_none_or(better) {
                best = Some(value);
                steps.push([one.design as f64, value]);
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
        let place = |one: &Evaluated<'_>| Some([one.design as f64, value(one)?]);
        layers.extend(design_dots(data, &designs, looks, false, place));
        unknown = unknown.max(designs.iter().filter(|one| value(one).is_none()).count());
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
    let place = |one: &Evaluated<'_>| match one.objectives[..] {
        [Some(x), Some(y)] => Some([x_factor * x, y_factor * y]),
        _ => None,
    };
    let looks = [(NOT_MET, Colour::Faint, Symbol::Cross), (MET, Colour::Series(0), Symbol::Disc)];
    let mut layers = design_dots(data, &designs, looks, true, place);
    let finals = data.front.iter().filter_map(|one| match &one.objectives[..] {
        [x, y] => {
            let scaled = |value: Option<f64>| value.map_or(f64::NAN, |value| y_factor * value);
            let ends = [scaled(y.low), scaled(y.high)];
            Some((one, [x_factor * x.value?, y_factor * y.value?], ends))
        }
        _ => None,
    });
    let finals: Vec<_> = finals.collect();
    if !finals.is_empty() {
        let name = "Pareto front, final runs";
        let column = |pick: fn([f64; 2], [f64; 2]) -> f64| -> Vec<f64> {
            finals.iter().map(|one| pick(one.1, one.2)).collect()
        };
        let x = column(|place, _| place[0]);
        let tooltips = Tooltips::numbers([(
            "design",
            finals.iter().map(|(one, ..)| one.design.map_or(f64::NAN, |n| n as f64)).collect(),
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
    let remain = data.front.iter().filter(|one| one.on_front && one.met).count();
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
