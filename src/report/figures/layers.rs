//! Elements that several figures share: axes, colours and symbols of labels, tooltips of runs.

use crate::classification::Label;
use crate::report::chart::{Axis, Colour, Layer, Mark, Symbol, Tooltips, axis};
use crate::report::data::{PointFacts, ReportData, RunSample};
use crate::study::Study;

/// Returns an axis from 0 to 1.
pub fn fraction_axis(name: &str) -> Axis {
    Axis { range: Some([0.0, 1.0]), ..axis(name, "") }
}

/// Returns a number in subscript digits.
pub fn subscript(number: usize) -> String {
    let digit = |c: char| c.to_digit(10).and_then(|digit| char::from_u32(0x2080 + digit));
    number.to_string().chars().filter_map(digit).collect()
}

/// Returns the name of a label in a legend.
pub fn label_words(label: Label) -> String {
    label.name().replace('_', " ")
}

/// Returns the symbol of a label, which distinguishes labels without colour.
pub fn label_symbol(label: Label) -> Symbol {
    match label {
        Label::Equilibrium => Symbol::Disc,
        Label::LimitCycle => Symbol::Triangle,
        Label::Periodic => Symbol::Dot,
        Label::Creep => Symbol::Star,
        Label::QuasiPeriodic => Symbol::Circle,
        Label::Irregular => Symbol::Square,
        Label::Undecided => Symbol::Diamond,
        Label::Failed => Symbol::Cross,
    }
}

/// A value with its interval at an abscissa.
#[derive(Clone, Copy, Debug)]
pub struct PlottedEstimate {
    /// Abscissa.
    pub x: f64,
    /// The value.
    pub value: f64,
    /// Lower end of its interval.
    pub low: f64,
    /// Upper end of its interval.
    pub high: f64,
}

/// The columns of a tooltip: names with values.
pub type TooltipNumbers<const N: usize> = [(&'static str, Vec<f64>); N];

impl PlottedEstimate {
    /// Returns the tooltip columns of the values, named `name`, and of the ends of their intervals.
    pub fn columns(name: &'static str, estimates: &[PlottedEstimate]) -> TooltipNumbers<3> {
        let column = |pick: fn(&PlottedEstimate) -> f64| estimates.iter().map(pick).collect();
        [
            (name, column(|estimate| estimate.value)),
            ("from", column(|estimate| estimate.low)),
            ("to", column(|estimate| estimate.high)),
        ]
    }

    /// Returns the intervals, the values as dots and, if `line` says whether it is dashed, a line through them.
    pub fn layers(
        (name, colour, symbol): (&str, Colour, Symbol),
        line: Option<bool>,
        estimates: &[PlottedEstimate],
        tooltips: Tooltips,
    ) -> Vec<Layer> {
        let column =
            |pick: fn(&PlottedEstimate) -> f64| estimates.iter().map(pick).collect::<Vec<f64>>();
        let x = column(|estimate| estimate.x);
        let (low, high) = (column(|estimate| estimate.low), column(|estimate| estimate.high));
        let points = || estimates.iter().map(|estimate| [estimate.x, estimate.value]).collect();
        let marks = [
            Some(Mark::Intervals { x: x.clone(), low, high }),
            line.map(|dashed| Mark::Line { points: points(), dashed }),
            Some(Mark::Dots { symbol, x, y: column(|estimate| estimate.value), tooltips }),
        ];
        marks.into_iter().flatten().map(|mark| Layer::new(name, colour, mark)).collect()
    }
}

/// Returns the tooltips of runs at these places of a sample, besides their angles.
pub fn run_tooltips(data: &ReportData<'_>, places: &[usize]) -> Tooltips {
    let (runs, unit) = (&data.runs, data.amplitude_unit());
    let of = |values: &[f64]| -> Vec<f64> { at_places(values, places).collect() };
    let amplitudes = of(&runs.amplitude_m).into_iter().map(|metres| unit.of(metres)).collect();
    let run_ids = places.iter().filter_map(|&place| runs.run_id.get(place).copied()).collect();
    let columns = [
        (&*format!("amplitude [{}]", unit.symbol), amplitudes),
        ("friction margin", of(&runs.friction_margin)),
        ("time to rest [s]", of(&runs.time_to_rest_s)),
    ];
    Tooltips { run_ids, ..Tooltips::numbers(columns) }
}

fn at_places(values: &[f64], places: &[usize]) -> impl Iterator<Item = f64> {
    places.iter().map(|&place| values.get(place).copied().unwrap_or(f64::NAN))
}

/// Returns dots of runs at these places of a sample, with coordinates from its columns.
pub fn run_dots(
    (name, colour, symbol): (&str, Colour, Symbol),
    (x, y): (&[f64], &[f64]),
    places: &[usize],
    tooltips: Tooltips,
) -> Layer {
    let [x, y] = [x, y].map(|values| at_places(values, places).collect());
    Layer::new(name, colour, Mark::Dots { symbol, x, y, tooltips })
}

/// Returns dots of runs at these places of a sample, a layer for each label; the sample has numbers and labels of runs.
pub fn dots_by_label(
    (run_id, labels): (&[u64], &[Label]),
    coordinates: (&[f64], &[f64]),
    places: &[usize],
    symbol: fn(Label) -> Symbol,
) -> Vec<Layer> {
    let layer = |label: Label| {
        let is = |place: &usize| labels.get(*place) == Some(&label);
        let runs: Vec<usize> = places.iter().copied().filter(is).collect();
        let run_ids = runs.iter().filter_map(|place| run_id.get(*place).copied()).collect();
        let tooltips = Tooltips { run_ids, ..Tooltips::default() };
        let look = (&*label_words(label), Colour::Label(label), symbol(label));
        (!runs.is_empty()).then(|| run_dots(look, coordinates, &runs, tooltips))
    };
    Label::ALL.into_iter().filter_map(layer).collect()
}

/// Half the distance between two bars at one abscissa, and the width of each.
pub const BARS: [f64; 2] = [0.19, 0.34];

/// Returns bars with their intervals, at whole numbers shifted by `shift`; empty if there is none. A value has the ends of its
/// interval, which may be NaN.
pub fn bars(
    name: &str,
    colour: Colour,
    shift: f64,
    values: impl Iterator<Item = Option<[f64; 3]>>,
) -> Vec<Layer> {
    let at = |place: usize| (1e4 * (place as f64 + shift)).round() / 1e4;
    let known = values.enumerate().filter_map(|(place, value)| Some((at(place), value?)));
    let (x, values): (Vec<f64>, Vec<[f64; 3]>) = known.unzip();
    if x.is_empty() {
        return Vec::new();
    }
    let [y, low, high] =
        [0, 1, 2].map(|part| values.iter().map(|value| value[part]).collect::<Vec<f64>>());
    let has_interval = low.iter().any(|low| low.is_finite());
    let tooltips = Tooltips::numbers([("from", low.clone()), ("to", high.clone())]);
    let bars = Mark::Bars { x: x.clone(), y, width: BARS[1], tooltips };
    let intervals = has_interval.then_some(Mark::Intervals { x, low, high });
    let intervals = intervals.map(|mark| Layer::new(name, Colour::Ink, mark));
    [Layer::new(name, colour, bars)].into_iter().chain(intervals).collect()
}

/// Returns the data of points: the numbers of their runs, and their own numbers.
pub fn of_points<'a>(points: impl Iterator<Item = &'a PointFacts>) -> TooltipNumbers<2> {
    let (runs, ids) = points.map(|point| (point.runs as f64, point.point_id as f64)).unzip();
    [("runs", runs), ("point", ids)]
}

/// Returns the places of the runs of a point, with the given label if any.
pub fn places(runs: &RunSample, point_id: u64, label: Option<Label>) -> Vec<usize> {
    let of_point = runs.point_id.iter().enumerate().filter(|(_, id)| **id == point_id);
    let is = |place: &usize| label.is_none() || runs.label.get(*place).copied() == label;
    of_point.map(|(place, _)| place).filter(is).collect()
}

/// The largest number of curves in one panel.
pub const MOST_CURVES: usize = 6;

/// A point and its curve.
pub type CurveOf<'a, T> = (&'a PointFacts, T);

/// Divides the curves of points into panels of a few neighbours each, with the titles of the panels; a single
/// panel has no title.
pub fn few_each<'c, 'a, T>(curves: &'c [CurveOf<'a, T>]) -> Vec<(String, &'c [CurveOf<'a, T>])> {
    let panels = curves.len().div_ceil(MOST_CURVES).max(1);
    let each = curves.len().div_ceil(panels).max(1);
    let part = |few: &[CurveOf<'a, T>]| match few {
        [(first, _), .., (last, _)] if panels > 1 => {
            format!("points {} to {}", first.point_id, last.point_id)
        }
        [(point, _)] if panels > 1 => format!("point {}", point.point_id),
        _ => String::new(),
    };
    curves.chunks(each).map(|few| (part(few), few)).collect()
}

/// Returns the name of what moves, such as `block` or `balls`, and whether it is one body.
pub fn moving(study: &Study) -> (String, bool) {
    let body = study.model().kind().body;
    match study.model().contacts() {
        1 => (body.to_owned(), true),
        _ => (format!("{body}s"), false),
    }
}
