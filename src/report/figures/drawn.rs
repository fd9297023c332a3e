//! Figures over the drawn values of uncertain parameters: rank correlations, and amplitudes of the runs.

use super::layers::{BARS, bars, dots_by_label, label_symbol};
use crate::analysis::RankCorrelation;
use crate::classification::Label;
use crate::numbers::significant;
use crate::report::chart::{Axis, Colour, Figure, Layer, Panel, Symbol, axis, axis_of_names};
use crate::report::data::{DrawnRuns, PointFacts, ReportData, axis_of, evenly, scattered};

/// The largest number of parameters in the figures.
pub const MOST_PARAMETERS: usize = 12;
/// The largest number of panels of the figure of amplitudes.
const MOST_PANELS: usize = 600;

/// Returns the parameters in the figures, as indices in the order of the study: those with the strongest rank
/// correlation with the amplitude at any point.
pub fn shown_parameters(data: &ReportData<'_>) -> Vec<usize> {
    let strength = |parameter: usize| {
        let values = data.drawn.points.values();
        let found = values.filter_map(|runs| Some(runs.with_amplitude(parameter)?.value.abs()));
        found.fold(0.0, f64::max)
    };
    let all = data.study.uncertain().len();
    let mut order: Vec<(usize, f64)> =
        (0..all).map(|parameter| (parameter, strength(parameter))).collect();
    order.sort_by(|(_, left), (_, right)| right.total_cmp(left));
    let mut shown: Vec<usize> = order.into_iter().map(|(parameter, _)| parameter).collect();
    shown.truncate(MOST_PARAMETERS);
    shown.sort_unstable();
    shown
}

/// Returns a sentence on the parameters that the figures omit; empty if there are none.
fn omitted(data: &ReportData<'_>, shown: &[usize]) -> String {
    match data.study.uncertain().len() - shown.len() {
        0 => String::new(),
        more => format!(
            " Of {} parameters, the {} with the strongest correlation with the amplitude are shown; the \
             report's table lists the other {more}.",
            shown.len() + more,
            shown.len(),
        ),
    }
}

fn sampled(data: &ReportData<'_>) -> String {
    match data.drawn.one_in {
        1 => String::new(),
        one_in => format!(" Subsample: about one in {one_in} runs of these points is counted."),
    }
}

/// The points in detail with their drawn values.
fn points<'a>(data: &'a ReportData<'_>) -> impl Iterator<Item = (&'a PointFacts, &'a DrawnRuns)> {
    data.details().filter_map(|point| Some((point, data.drawn.points.get(&point.point_id)?)))
}

/// Plots the rank correlations of each parameter with the amplitude and with the time to rest, for each point.
pub fn correlations(data: &ReportData<'_>) -> Option<Figure> {
    let shown = shown_parameters(data);
    let name = |parameter: &usize| axis_of(&data.study.uncertain()[*parameter]).name;
    let names: Vec<String> = shown.iter().map(name).collect();
    let x = axis_of_names(names.clone(), axis("", ""));
    let y = Axis { range: Some([-1.0, 1.0]), ..axis("rank correlation", "") };
    let mut panels = Vec::new();
    let mut sentences = Vec::new();
    for (point, runs) in points(data) {
        let amplitude: Vec<Option<RankCorrelation>> =
            shown.iter().map(|&parameter| runs.with_amplitude(parameter)).collect();
        let time: Vec<Option<RankCorrelation>> =
            shown.iter().map(|&parameter| runs.with_time_to_rest(parameter)).collect();
        let parts = |all: &[Option<RankCorrelation>]| -> Vec<Option<[f64; 3]>> {
            let rounded = |value: f64| (1e4 * value).round() / 1e4;
            let part = |found: &RankCorrelation| [found.value, found.low, found.high].map(rounded);
            all.iter().map(|found| found.as_ref().map(part)).collect()
        };
        let (of_amplitude, of_time) = (parts(&amplitude).into_iter(), parts(&time).into_iter());
        let mut layers = bars("with the amplitude", Colour::Series(0), -BARS[0], of_amplitude);
        layers.extend(bars("with the time to rest", Colour::Series(1), BARS[0], of_time));
        if layers.is_empty() {
            continue;
        }
        let strongest =
            names.iter().zip(&amplitude).filter_map(|(name, found)| Some((name, (*found)?)));
        let strongest = strongest.max_by(|(_, a), (_, b)| a.value.abs().total_cmp(&b.value.abs()));
        if let Some((name, RankCorrelation { value, low, high })) = strongest {
            let [value, low, high] = [value, low, high].map(|number| format!("{number:.2}"));
            let text = format!("{}: {name} {value} ({low} to {high})", point.title);
            sentences.push(text.replace('-', "\u{2212}"));
        }
        let title = point.title.clone();
        panels.push(Panel { title, ..Panel::new(x.clone(), y.clone(), layers) });
    }
    Figure::new(
        "rank-correlations",
        "Influence of uncertain parameters",
        format!(
            "Spearman's rank correlation of each drawn parameter with the amplitude at the end of a run and with \
             the time to rest, with 95 % intervals (Fisher's transformation, independent draws). 1: the quantity \
             always increases with the parameter; \u{2212}1: it always decreases. Runs that do not come to rest rank last \
             in the time to rest. Failed runs are not counted.{}{}{}",
            omitted(data, &shown),
            data.left_out(),
            sampled(data),
        ),
        format!(
            "The strongest rank correlation with the amplitude, of each point: {}.",
            sentences.join("; ")
        ),
        panels,
    )
}

/// Plots the amplitude of the runs over each parameter, coloured by label, for each point.
pub fn amplitudes(data: &ReportData<'_>) -> Option<Figure> {
    let shown = shown_parameters(data);
    let all: Vec<(&PointFacts, &DrawnRuns)> = points(data).collect();
    let most = (MOST_PANELS / shown.len().max(1)).max(1);
    let places = evenly(all.len(), most.max(2));
    let left_out = match places.len() < all.len() {
        true => format!(
            " {} of {} points are shown, evenly spaced in the order of the sweep.",
            places.len(),
            data.point_count
        ),
        false => data.left_out(),
    };
    let chosen: Vec<(&PointFacts, &DrawnRuns)> =
        places.into_iter().filter_map(|place| all.get(place).copied()).collect();
    let runs: usize = chosen.iter().map(|(_, runs)| runs.run_id.len()).sum();
    if runs == 0 || shown.is_empty() {
        return None;
    }
    let one_in = (runs * shown.len()).div_ceil(data.budget.drawn.max(1)).max(1) as u64;
    // Mixes the run numbers again to draw a subsample of a subsample.
    let mixed = |run: u64| run.wrapping_mul(0x2545_f491_4f6c_dd1d).rotate_left(29);
    let is_shown = |run: u64| scattered(mixed(run), one_in);
    let unit = data.amplitude_unit();
    let y = axis("amplitude", &unit.symbol);
    let mut panels = Vec::new();
    let mut drawn = 0;
    for (point, runs) in &chosen {
        let amplitudes: Vec<f64> = runs.amplitude_m.iter().map(|metres| unit.of(*metres)).collect();
        for &parameter in &shown {
            let values = &runs.values[parameter];
            let x = axis_of(&data.study.uncertain()[parameter]);
            let part = x.name.clone();
            let sample = (&runs.run_id[..], &runs.label[..]);
            let places = (0..).zip(&runs.run_id).filter(|(_, run)| is_shown(**run));
            let places: Vec<usize> = places.map(|(place, _)| place).collect();
            let layers = dots_by_label(sample, (values, &amplitudes), &places, small);
            drawn += layers.iter().map(Layer::dots).sum::<usize>();
            let title = point.title.clone();
            panels.push(Panel { title, part, ..Panel::new(x, y.clone(), layers) });
        }
    }
    let dots = match (one_in, data.drawn.one_in) {
        (1, 1) => String::new(),
        _ => {
            let of = chosen.iter().map(|(point, _)| point.runs).sum::<u64>();
            let runs = drawn / shown.len().max(1);
            format!(" Subsample: {runs} of the {of} runs of these points are shown.")
        }
    };
    Figure::new(
        "drawn-parameters",
        "Amplitude over uncertain parameters",
        format!(
            "Each dot is a run at the value that was drawn for it; the other parameters and the start state vary \
             from dot to dot. Colour: label of the run. Failed runs are not shown.{}{left_out}{dots}",
            omitted(data, &shown),
        ),
        ranges(data, &chosen, &shown),
        panels,
    )
}

/// Returns the symbol of a label in a crowd of dots.
fn small(label: Label) -> Symbol {
    if label == Label::Equilibrium { Symbol::Dot } else { label_symbol(label) }
}

/// Returns a sentence on the ranges of the drawn values.
fn ranges(data: &ReportData<'_>, chosen: &[(&PointFacts, &DrawnRuns)], shown: &[usize]) -> String {
    let range = |&parameter: &usize| {
        let axis = axis_of(&data.study.uncertain()[parameter]);
        let values = || chosen.iter().flat_map(|(_, runs)| &runs.values[parameter]).copied();
        let (least, most) =
            (values().fold(f64::INFINITY, f64::min), values().fold(f64::NEG_INFINITY, f64::max));
        let [least, most] = [least, most].map(significant);
        format!("{} from {least} to {most} {}", axis.name, axis.unit).trim_end().to_owned()
    };
    let ranges: Vec<String> = shown.iter().map(range).collect();
    format!("The runs have drawn {}.", ranges.join(", "))
}
