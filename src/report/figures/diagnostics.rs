//! Figure: fractions of failed and undecided runs, and of flips in the audit.

use super::layers::{fraction_axis, label_colour, label_symbol, label_words, numbers};
use crate::classification::Label;
use crate::report::chart::{Axis, Colour, Figure, Layer, Mark, Panel, Symbol, Tooltips};
use crate::report::data::{PointFacts, ReportData};

/// Plots the fractions with their intervals, for each point in detail.
pub fn figure(data: &ReportData<'_>) -> Option<Figure> {
    let points: Vec<&PointFacts> = data.details().collect();
    if points.is_empty() {
        return None;
    }
    let mut layers = Vec::new();
    for (place, label) in Label::ALL.into_iter().enumerate() {
        if !matches!(label, Label::Undecided | Label::Failed) {
            continue;
        }
        let values: Vec<Option<[f64; 3]>> = points
            .iter()
            .map(|point| {
                point
                    .labels
                    .get(place)
                    .map(|fraction| [fraction.fraction, fraction.low, fraction.high])
            })
            .collect();
        let counts = points.iter().map(|p| p.labels.get(place).map_or(0, |fraction| fraction.runs));
        let look = (label_words(label), label_colour(label), label_symbol(label));
        add(&mut layers, look, &values, counts.collect(), place);
    }
    let audited = points.iter().any(|point| point.flip_rate.is_some());
    if audited {
        let values: Vec<Option<[f64; 3]>> = points.iter().map(|point| point.flip_rate).collect();
        let counts = points.iter().map(|point| point.audit.flips).collect();
        let look = ("flips of audited runs".to_owned(), Colour::Series(0), Symbol::Circle);
        add(&mut layers, look, &values, counts, 5);
    }
    let x = data.axis_of_points(&points);
    let panel = Panel {
        title: String::new(),
        part: String::new(),
        x,
        y: Axis { range: None, ..fraction_axis("fraction of runs") },
        scale: None,
        layers,
    };
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
    Some(Figure {
        id: "doubt".to_owned(),
        title: "Failed, undecided and flipped runs".to_owned(),
        caption: format!(
            "Fractions of failed runs, of undecided runs, and of labels that changed in the audit, with 95 % \
             intervals, also at zero.{}",
            data.left_out()
        ),
        alternative: format!("{failed} runs failed, {undecided} are undecided.{audit}"),
        panels: vec![panel],
        one_at_a_time: false,
    })
}

fn add(
    layers: &mut Vec<Layer>,
    (name, colour, symbol): (String, Colour, Symbol),
    values: &[Option<[f64; 3]>],
    counts: Vec<u64>,
    place: usize,
) {
    // Side by side, so that intervals do not overlap.
    let shift = match place {
        3 => -0.16,
        4 => 0.0,
        _ => 0.16,
    };
    let known: Vec<(f64, [f64; 3], u64)> = values
        .iter()
        .zip(counts)
        .enumerate()
        .filter_map(|(place, (value, count))| Some((place as f64 + shift, (*value)?, count)))
        .collect();
    let column = |index: usize| known.iter().map(move |(_, value, _)| value[index]);
    let x: Vec<f64> = known.iter().map(|(x, ..)| *x).collect();
    let mark =
        Mark::Intervals { x: x.clone(), low: column(1).collect(), high: column(2).collect() };
    layers.push(Layer { name: name.clone(), colour, mark });
    let tooltips = Tooltips {
        run_ids: Vec::new(),
        columns: vec![
            numbers("runs", known.iter().map(|(.., count)| *count as f64)),
            numbers("fraction", column(0)),
            numbers("from", column(1)),
            numbers("to", column(2)),
        ],
    };
    let mark = Mark::Dots { symbol, x, y: column(0).collect(), tooltips };
    layers.push(Layer { name, colour, mark });
}
