//! Figure: the fraction of each label with its interval, over a swept parameter.

use super::layers::{fraction_axis, label_colour, label_symbol, label_words, numbers};
use super::sweep_axis::SweepAxis;
use crate::classification::Label;
use crate::report::chart::{Figure, Layer, Mark, Panel, Tooltips};
use crate::report::data::{PointFacts, ReportData};

/// Plots over the parameter with the most values, or over the points if no number is swept.
pub fn figure(data: &ReportData<'_>) -> Option<Figure> {
    let fraction = || fraction_axis("fraction of runs");
    let axes = SweepAxis::all(data, 2);
    let (mut left_out, mut most_left_out) = (0, 1);
    let (panels, over) = match axes.first() {
        Some(sweep) => {
            let mut groups = sweep.groups(data);
            // The groups with the most points come first.
            groups.sort_by_key(|group| std::cmp::Reverse(group.points.len()));
            left_out = groups.len().saturating_sub(data.budget.details);
            groups.truncate(data.budget.details);
            // Half of the budget, because each point has several values.
            let each = data.budget.points / 2 / groups.len().max(1);
            for group in &mut groups {
                let one_in = group.points.len().div_ceil(each.max(1)).max(1);
                most_left_out = most_left_out.max(one_in);
                group.points = group.points.iter().copied().step_by(one_in).collect();
            }
            let panel = |group: &super::sweep_axis::Group<'_>| Panel {
                title: group.title.clone(),
                part: String::new(),
                x: sweep.axis.clone(),
                y: fraction(),
                scale: None,
                layers: layers(data, &group.points),
            };
            (groups.iter().map(panel).collect(), sweep.axis.name.clone())
        }
        None => {
            let points: Vec<(f64, &PointFacts)> =
                data.details().enumerate().map(|(place, point)| (place as f64, point)).collect();
            let named: Vec<&PointFacts> = points.iter().map(|(_, point)| *point).collect();
            let x = data.axis_of_points(&named);
            let layers = layers(data, &points);
            let panel = Panel {
                title: String::new(),
                part: String::new(),
                x,
                y: fraction(),
                scale: None,
                layers,
            };
            (vec![panel], String::new())
        }
    };
    let end = data.study.simulation().end_time_s;
    let most = data.points.iter().map(|point| point.equilibrium.fraction).fold(f64::NAN, f64::max);
    let least = data.points.iter().map(|point| point.equilibrium.fraction).fold(f64::NAN, f64::min);
    let left_out = match left_out {
        0 => String::new(),
        more => format!(" {more} other combinations of parameters are not shown."),
    };
    let thinned = match most_left_out {
        1 => String::new(),
        one_in => format!(" Every {one_in}th point is shown."),
    };
    Some(Figure {
        id: "fractions".to_owned(),
        title: match over.as_str() {
            "" => "How runs end".to_owned(),
            over => format!("How runs end, over {over}"),
        },
        caption: format!(
            "Fraction of the runs of each point by label, {end} s after the start. The 95 % intervals of the \
             equilibria hold for each fraction separately and are widened by failed runs, which could have had any \
             label; those of the other labels hold jointly and are therefore wider.{left_out}{thinned}"
        ),
        alternative: format!(
            "The fraction of runs that end in equilibrium lies between {least:.3} and {most:.3}."
        ),
        one_at_a_time: panels.len() > 1,
        panels,
    })
}

fn layers(data: &ReportData<'_>, points: &[(f64, &PointFacts)]) -> Vec<Layer> {
    let mut layers = Vec::new();
    for (place, label) in Label::ALL.into_iter().enumerate() {
        let fraction = |point: &PointFacts| match label {
            Label::Equilibrium => Some(point.equilibrium),
            _ => point.labels.get(place).copied(),
        };
        let seen = data.points.iter().any(|point| fraction(point).is_some_and(|s| s.runs > 0));
        if !seen && label != Label::Equilibrium {
            continue;
        }
        let known: Vec<_> =
            points.iter().filter_map(|(x, point)| Some((*x, fraction(point)?, *point))).collect();
        let colour = label_colour(label);
        let name = label_words(label);
        let x: Vec<f64> = known.iter().map(|(x, ..)| *x).collect();
        let mark = Mark::Intervals {
            x: x.clone(),
            low: known.iter().map(|(_, fraction, _)| fraction.low).collect(),
            high: known.iter().map(|(_, fraction, _)| fraction.high).collect(),
        };
        layers.push(Layer { name: name.clone(), colour, mark });
        let line = known.iter().map(|(x, fraction, _)| [*x, fraction.fraction]).collect();
        let mark = Mark::Line { points: line, dashed: label != Label::Equilibrium };
        layers.push(Layer { name: name.clone(), colour, mark });
        let tooltips = Tooltips {
            run_ids: Vec::new(),
            columns: vec![
                numbers("fraction", known.iter().map(|(_, fraction, _)| fraction.fraction)),
                numbers("from", known.iter().map(|(_, fraction, _)| fraction.low)),
                numbers("to", known.iter().map(|(_, fraction, _)| fraction.high)),
                numbers(
                    "runs with this label",
                    known.iter().map(|(_, fraction, _)| fraction.runs as f64),
                ),
                numbers("runs", known.iter().map(|(.., point)| point.runs as f64)),
                numbers("point", known.iter().map(|(.., point)| point.point_id as f64)),
            ],
        };
        let y = known.iter().map(|(_, fraction, _)| fraction.fraction).collect();
        let mark = Mark::Dots { symbol: label_symbol(label), x, y, tooltips };
        layers.push(Layer { name, colour, mark });
    }
    layers
}
