//! Figures: the fraction of each label with its interval, over a swept parameter; and fractions of failed and undecided runs, and
//! of flips in the audit.

use super::layers::{PlottedEstimate, fraction_axis, label_symbol, label_words, of_points};
use super::sweep_axis::OverSweep;
use crate::classification::Label;
use crate::report::chart::{Axis, Colour, Figure, Layer, Panel, Symbol, Tooltips};
use crate::report::data::{Fraction, PointFacts, ReportData};

/// Plots over the parameter with the most values, or over the points if no number is swept.
pub fn figure(data: &ReportData<'_>) -> Option<Figure> {
    // Half of the budget, because each point has several values.
    let sweep = OverSweep::new(data, 2);
    let fraction = fraction_axis("fraction of runs");
    let panels = sweep.panels(&fraction, |points| layers(data, points));
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

/// Plots the fractions of failed, undecided and flipped runs with their intervals, for each point in detail.
pub fn diagnostics(data: &ReportData<'_>) -> Option<Figure> {
    let points: Vec<&PointFacts> = data.details().collect();
    if points.is_empty() {
        return None;
    }
    let mut layers = Vec::new();
    // Side by side, so that intervals do not overlap.
    for (shift, label) in [(-0.16, Label::Undecided), (0.0, Label::Failed)] {
        let look = (&*label_words(label), Colour::Label(label), label_symbol(label));
        let fractions = points.iter().map(|point| {
            let Fraction { runs, fraction, low, high } = point.label(label);
            Some((runs, [fraction, low, high]))
        });
        layers.extend(fraction_layers(look, shift, fractions));
    }
    let audited = points.iter().any(|point| point.flip_rate.is_some());
    if audited {
        let look = ("flips of audited runs", Colour::Series(0), Symbol::Circle);
        let rates = points.iter().map(|point| Some((point.audit.flips, point.flip_rate?)));
        layers.extend(fraction_layers(look, 0.16, rates));
    }
    let y = Axis { range: None, ..fraction_axis("fraction of runs") };
    let panel = Panel::new(data.axis_of_points(&points), y, layers);
    let failed = data.manifest.labels.get(Label::Failed.name()).copied().unwrap_or(0);
    let undecided = data.manifest.labels.get(Label::Undecided.name()).copied().unwrap_or(0);
    let audit = if audited {
        let flips: u64 = data.points.iter().map(|point| point.audit.flips).sum();
        let runs: u64 = data.points.iter().map(|point| point.audit.runs).sum();
        format!(" {flips} of {runs} audited runs have another label when computed more precisely.")
    } else {
        " No run was audited (`audit:` in the study computes some of them more precisely)."
            .to_owned()
    };
    Figure::new(
        "diagnostics",
        "Fractions of failed, undecided and flipped runs",
        format!(
            "Fractions of failed runs, of undecided runs, and of labels that changed in the audit, with 95 % \
             intervals, also at zero.{}",
            data.left_out()
        ),
        format!("{failed} runs failed, {undecided} are undecided.{audit}"),
        vec![panel],
    )
}

/// Returns the layers of one fraction, given as a number of runs and the fraction with its interval, for each point.
fn fraction_layers(
    look: (&str, Colour, Symbol),
    shift: f64,
    fractions: impl Iterator<Item = Option<(u64, [f64; 3])>>,
) -> Vec<Layer> {
    let known = fractions.enumerate().filter_map(|(place, fraction)| {
        let (runs, [value, low, high]) = fraction?;
        Some((runs as f64, PlottedEstimate { x: place as f64 + shift, value, low, high }))
    });
    let (runs, estimates): (Vec<f64>, Vec<PlottedEstimate>) = known.unzip();
    let [fraction, from, to] = PlottedEstimate::columns("fraction", &estimates);
    let tooltips = Tooltips::numbers([("runs", runs), fraction, from, to]);
    PlottedEstimate::layers(look, None, &estimates, tooltips)
}
