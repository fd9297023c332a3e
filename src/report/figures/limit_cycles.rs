//! Figure: limit cycles over a swept parameter, one branch per class.

use super::layers::PlottedEstimate;
use super::sweep_axis::{OverSweep, SweepGroup};
use crate::report::chart::{Colour, Figure, Layer, Mark, Panel, Symbol, Tooltips, axis};
use crate::report::data::{CycleFacts, QUANTITIES, ReportData};
use crate::study::Unit;

/// The largest number of classes; those with the most runs are shown.
const MOST_CLASSES: usize = 8;
const SYMBOLS: [Symbol; 4] = [Symbol::Disc, Symbol::Triangle, Symbol::Square, Symbol::Diamond];

/// Plots a panel for each quantity; returns `None` if no run ended in a limit cycle.
pub fn figure(data: &ReportData<'_>) -> Option<Figure> {
    let cycles = &data.cycles;
    let mut classes: Vec<(String, u64)> = Vec::new();
    for cycle in cycles {
        match classes.iter_mut().find(|(class, _)| *class == cycle.class) {
            Some((_, runs)) => *runs = runs.saturating_add(cycle.runs),
            None => classes.push((cycle.class.clone(), cycle.runs)),
        }
    }
    let all = classes.len();
    classes.sort_by_key(|(_, runs)| std::cmp::Reverse(*runs));
    classes.truncate(MOST_CLASSES);
    let OverSweep { x, groups, .. } = OverSweep::all(data);
    let mut panels = Vec::new();
    for group in groups.iter().take(data.budget.details) {
        for (place, (name, si, _)) in QUANTITIES.iter().enumerate() {
            let mut layers = Vec::new();
            let unit = match *si {
                "m" => data.amplitude_unit(),
                "rad/s" => data.study.units().speed(),
                si => Unit { symbol: si.to_owned(), si: 1.0 },
            };
            for (index, (class, _)) in classes.iter().enumerate() {
                layers.extend(branch(cycles, group, class, (place, &unit, index)));
            }
            if place == QUANTITIES.len() - 1 && !layers.is_empty() {
                let label = "stable below".to_owned();
                let mark = Mark::Rule { upright: false, at: 1.0, label };
                layers.push(Layer::new("", Colour::Faint, mark));
            }
            if layers.is_empty() {
                continue;
            }
            panels.push(Panel {
                title: group.title.clone(),
                part: (*name).to_owned(),
                ..Panel::new(x.clone(), axis(name, &unit.symbol), layers)
            });
        }
    }
    let left_out = match all > MOST_CLASSES {
        true => format!(" The {MOST_CLASSES} classes with the most runs are shown, of {all}."),
        false => String::new(),
    };
    let list: Vec<String> =
        classes.iter().map(|(class, runs)| format!("class {class}: {runs} runs")).collect();
    Figure::new(
        "limit-cycles",
        "Limit cycles",
        format!(
            "One branch per class of limit cycles (which balls run and which stick; docs/methods.md explains \
             the names), with the range over its runs; fractions with their 95 % interval (Wilson, for each \
             fraction separately).{left_out}"
        ),
        list.join("; "),
        panels,
    )
}

fn branch(
    cycles: &[CycleFacts],
    group: &SweepGroup<'_>,
    class: &str,
    (quantity, unit, index): (usize, &Unit, usize),
) -> Vec<Layer> {
    let known = group.points.iter().filter_map(|(x, point)| {
        let of_class =
            |cycle: &&CycleFacts| cycle.point_id == point.point_id && cycle.class == class;
        let cycle = cycles.iter().find(of_class)?;
        let values = cycle.values.get(quantity)?;
        let [value, low, high] = values.map(|value| value.map(|value| unit.of(value)));
        let value = value?;
        let (low, high) = (low.unwrap_or(value), high.unwrap_or(value));
        Some((PlottedEstimate { x: *x, value, low, high }, cycle))
    });
    let (estimates, cycles): (Vec<PlottedEstimate>, Vec<&CycleFacts>) = known.unzip();
    if estimates.is_empty() {
        return Vec::new();
    }
    let column =
        |pick: fn(&CycleFacts) -> u64| cycles.iter().map(|cycle| pick(cycle) as f64).collect();
    let [value, from, to] = PlottedEstimate::columns("value", &estimates);
    let (runs, point) = (column(|cycle| cycle.runs), column(|cycle| cycle.point_id));
    let tooltips = Tooltips::numbers([value, from, to, ("runs", runs), ("point", point)]);
    let symbol = SYMBOLS.get(index % SYMBOLS.len()).copied().unwrap_or(Symbol::Disc);
    let look = (&*format!("class {class}"), Colour::Series(index), symbol);
    PlottedEstimate::layers(look, Some(false), &estimates, tooltips)
}
