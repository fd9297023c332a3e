//! Figure: the fraction of each label with its interval, over a swept parameter.

use super::layers::{Estimate, fraction_axis, label_colour, label_symbol, label_words};
use super::sweep_axis::SweepAxis;
use crate::classification::Label;
use crate::report::chart::{Figure, Layer, Panel, Tooltips};
use crate::report::data::{Fraction, PointFacts, ReportData};

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
                ..Panel::new(sweep.axis.clone(), fraction(), layers(data, &group.points))
            };
            (groups.iter().map(panel).collect(), sweep.axis.name.clone())
        }
        None => {
            let points: Vec<(f64, &PointFacts)> =
                data.details().enumerate().map(|(place, point)| (place as f64, point)).collect();
            let named: Vec<&PointFacts> = points.iter().map(|(_, point)| *point).collect();
            let x = data.axis_of_points(&named);
            let panel = Panel::new(x, fraction(), layers(data, &points));
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
    let fraction = |point: &PointFacts, label| match label {
        Label::Equilibrium => point.equilibrium,
        _ => point.label(label),
    };
    let of_label = |label: Label| {
        let estimate = |(x, point): &(f64, &PointFacts)| {
            let Fraction { fraction, low, high, .. } = fraction(point, label);
            Estimate { x: *x, value: fraction, low, high }
        };
        let estimates: Vec<Estimate> = points.iter().map(estimate).collect();
        let column = |value: &dyn Fn(&PointFacts) -> u64| {
            points.iter().map(|(_, one)| value(one) as f64).collect()
        };
        let [value, from, to] = Estimate::columns("fraction", &estimates);
        let tooltips = Tooltips::numbers([
            value,
            from,
            to,
            ("runs with this label", column(&|point| fraction(point, label).runs)),
            ("runs", column(&|point| point.runs)),
            ("point", column(&|point| point.point_id)),
        ]);
        let look = (&*label_words(label), label_colour(label), label_symbol(label));
        Estimate::layers(look, Some(label != Label::Equilibrium), &estimates, tooltips)
    };
    let seen = |label: &Label| {
        *label == Label::Equilibrium
            || data.points.iter().any(|point| fraction(point, *label).runs > 0)
    };
    Label::ALL.into_iter().filter(seen).flat_map(of_label).collect()
}
