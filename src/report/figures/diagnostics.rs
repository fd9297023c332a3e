//! Figure: fractions of failed and undecided runs, and of flips in the audit.

use super::layers::{PlottedEstimate, fraction_axis, label_symbol, label_words};
use crate::classification::Label;
use crate::report::chart::{Axis, Colour, Figure, Layer, Panel, Symbol, Tooltips};
use crate::report::data::{Fraction, PointFacts, ReportData};

/// Plots the fractions with their intervals, for each point in detail.
pub fn figure(data: &ReportData<'_>) -> Option<Figure> {
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
