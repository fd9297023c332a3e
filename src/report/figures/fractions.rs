//! Figure: the fraction of each label with its interval, over a swept parameter.

use super::layers::{PlottedEstimate, fraction_axis, label_symbol, label_words, of_points};
use super::over_sweep::OverSweep;
use crate::classification::Label;
use crate::report::chart::{Colour, Figure, Layer, Tooltips};
use crate::report::data::{Fraction, PointFacts, ReportData};

/// Plots over the parameter with the most values, or over the points if no number is swept.
pub fn figure(data: &ReportData<'_>) -> Option<Figure> {
    // Half of the budget, because each point has several values.
    let sweep = OverSweep::new(data, 2);
    let fraction = fraction_axis("fraction of runs");
    let panels = sweep.panels(data, &fraction, |points| layers(data, points));
    let left_out = &sweep.left_out;
    let end = data.ends_in_words();
    let most = data.points.iter().map(|point| point.equilibrium.fraction).fold(f64::NAN, f64::max);
    let least = data.points.iter().map(|point| point.equilibrium.fraction).fold(f64::NAN, f64::min);
    Figure::new(
        "fractions",
        match sweep.parameter.as_str() {
            "" => "How runs end".to_owned(),
            over => format!("How runs end, over {over}"),
        },
        format!(
            "Fraction of the runs of each point by label, {end} s after the start. The 95 % intervals of the \
             equilibria hold for each fraction separately and are widened by failed runs, which could have had any \
             label; those of the other labels hold jointly and are therefore wider.{left_out}"
        ),
        format!(
            "The fraction of runs that end in equilibrium lies between {least:.3} and {most:.3}."
        ),
        panels,
    )
}

fn layers(data: &ReportData<'_>, points: &[(f64, &PointFacts)]) -> Vec<Layer> {
    let fraction = |point: &PointFacts, label| match label {
        Label::Equilibrium => point.equilibrium,
        _ => point.label(label),
    };
    let of_label = |label: Label| {
        let estimate = |(x, point): &(f64, &PointFacts)| {
            let Fraction { fraction, low, high, .. } = fraction(point, label);
            PlottedEstimate { x: *x, value: fraction, low, high }
        };
        let estimates: Vec<PlottedEstimate> = points.iter().map(estimate).collect();
        let of_label = points.iter().map(|(_, point)| fraction(point, label).runs as f64);
        let [runs, point] = of_points(points.iter().map(|(_, point)| *point));
        let [value, from, to] = PlottedEstimate::columns("fraction", &estimates);
        let tooltips = Tooltips::numbers([
            value,
            from,
            to,
            ("runs with this label", of_label.collect()),
            runs,
            point,
        ]);
        let look = (&*label_words(label), Colour::Label(label), label_symbol(label));
        PlottedEstimate::layers(look, Some(label != Label::Equilibrium), &estimates, tooltips)
    };
    let seen = |label: &Label| {
        *label == Label::Equilibrium
            || data.points.iter().any(|point| fraction(point, *label).runs > 0)
    };
    Label::ALL.into_iter().filter(seen).flat_map(of_label).collect()
}
