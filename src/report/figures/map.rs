//! Figure: a sweep over two parameters as a map, with one coloured cell per point.

use super::sweep_axis::{SweepAxis, distinct, grouped, is_by_decades, number};
use crate::classification::Label;
use crate::report::chart::{Axis, Colour, ColourScale, Figure, Layer, Mark, Panel, Tooltips};
use crate::report::data::{PointFacts, ReportData};

/// The least number of values of each parameter.
const LEAST: usize = 3;

/// A quantity of a map: its name, its value at a point, and the ends of its scale if fixed.
type Shown = (&'static str, fn(&PointFacts) -> Option<f64>, Option<[f64; 2]>);

const SHOWN: [Shown; 4] = [
    ("fraction of equilibria", |point| Some(point.equilibrium.fraction), Some([0.0, 1.0])),
    ("median time to rest [s]", |point| point.time_to_rest_s[1], None),
    (
        "median of amplitude / amplitude without balls",
        |point| point.residual.relative_amplitude[1],
        None,
    ),
    ("fraction of positions that are equilibria", |point| point.set_fraction, Some([0.0, 1.0])),
];

/// Plots maps over the two parameters with the most values, one for each combination of the others.
pub fn figure(data: &ReportData<'_>) -> Option<Figure> {
    let axes = SweepAxis::all(data, LEAST);
    let [across, up, ..] = &axes[..] else { return None };
    let values = |column| distinct(data, column);
    let (mut x_values, mut y_values) = (values(across.column)?, values(up.column)?);
    // With too many cells, only every second, third and so on value of each parameter is shown.
    let mut one_in = 1;
    while x_values.len().div_ceil(one_in) * y_values.len().div_ceil(one_in) > data.budget.points {
        one_in += 1;
    }
    for values in [&mut x_values, &mut y_values] {
        *values = values.iter().copied().step_by(one_in).collect();
    }
    let on = |values: &[f64], value: f64| values.binary_search_by(|v| v.total_cmp(&value)).is_ok();
    if x_values.len() < 2 || y_values.len() < 2 {
        return None;
    }
    // One map for each combination of the other parameters.
    let mut planes = grouped(data, &[across.column, up.column], |point| -> Option<Placed<'_>> {
        let [x, y] = [across, up].map(|axis| number(data.study, point, axis.column));
        let (x, y) = x.zip(y).filter(|(x, y)| on(&x_values, *x) && on(&y_values, *y))?;
        Some((point, x, y))
    });
    // A map with mostly empty cells is a path through the plane, which curves show better.
    planes.retain(|(_, points)| 3 * points.len() >= x_values.len() * y_values.len());
    planes.truncate(MOST_PLANES);
    let shown: usize = planes.iter().map(|(_, points)| points.len()).sum();
    if shown == 0 {
        return None;
    }
    let panels = planes
        .iter()
        .flat_map(|(title, points)| plane(title, points, [(across, &x_values), (up, &y_values)]))
        .collect();
    let more = if shown as u64 == data.point_count {
        String::new()
    } else {
        format!(" {shown} of {} points are shown.", data.point_count)
    };
    Figure::new(
        "map",
        format!("Map over {} and {}", across.axis.name, up.axis.name),
        format!("One cell per point of the sweep; open cells have no value.{more}"),
        format!("{shown} points over {} and {}.", label(across), label(up)),
        panels,
    )
}

/// The largest number of combinations of other parameters with maps.
const MOST_PLANES: usize = 12;

/// A point and its coordinates.
type Placed<'a> = (&'a PointFacts, f64, f64);

/// Returns the maps of points that differ only in two parameters, which have these values.
fn plane(
    title: &str,
    points: &[Placed<'_>],
    [(across, x_values), (up, y_values)]: [(&SweepAxis, &Vec<f64>); 2],
) -> Vec<Panel> {
    let (x_edges, y_edges) = (edges(x_values), edges(y_values));
    let cell = |x: f64, y: f64| {
        let [left, right] = around(x_values, &x_edges, x)?;
        let [below, above] = around(y_values, &y_edges, y)?;
        Some([left, right, below, above])
    };
    let cells: Vec<[f64; 4]> = points.iter().filter_map(|(_, x, y)| cell(*x, *y)).collect();
    let column = |value: &dyn Fn(&PointFacts) -> Option<f64>| {
        points.iter().map(|(point, ..)| value(point).unwrap_or(f64::NAN)).collect()
    };
    let mut panels = Vec::new();
    for (name, value, range) in SHOWN {
        let values: Vec<f64> = column(&value);
        let known = || values.iter().copied().filter(|value| value.is_finite());
        let (least, most) = (known().fold(f64::INFINITY, f64::min), known().fold(0.0, f64::max));
        if known().next().is_none() {
            continue;
        }
        let tooltips = Tooltips::numbers([
            (&*label(across), points.iter().map(|(_, x, _)| *x).collect()),
            (&*label(up), points.iter().map(|(_, _, y)| *y).collect()),
            (name, values.clone()),
            ("runs", column(&|point| Some(point.runs as f64))),
            ("failed runs", column(&|point| Some(point.label(Label::Failed).runs as f64))),
            ("point", column(&|point| Some(point.point_id as f64))),
        ]);
        let mark = Mark::Cells { edges: cells.clone(), values, tooltips };
        let range = range.unwrap_or([least, if most > least { most } else { least + 1.0 }]);
        panels.push(Panel {
            title: title.to_owned(),
            part: name.to_owned(),
            scale: Some(ColourScale { name: name.to_owned(), range }),
            ..Panel::new(
                bounded(across, &x_edges),
                bounded(up, &y_edges),
                vec![Layer::new("", Colour::Scale, mark)],
            )
        });
    }
    panels
}

fn label(sweep: &SweepAxis) -> String {
    match sweep.axis.unit.is_empty() {
        true => sweep.axis.name.clone(),
        false => format!("{} [{}]", sweep.axis.name, sweep.axis.unit),
    }
}

fn bounded(sweep: &SweepAxis, edges: &[f64]) -> Axis {
    let ends = edges.first().zip(edges.last()).map(|(a, b)| [*a, *b]);
    Axis { range: ends, ..sweep.axis.clone() }
}

/// Returns the edges of cells around ascending values, midway between neighbours on the axis's scale.
fn edges(values: &[f64]) -> Vec<f64> {
    let by_decades = is_by_decades(values);
    let on_axis = |value: f64| if by_decades { value.ln() } else { value };
    let values: Vec<f64> = values.iter().copied().map(on_axis).collect();
    let between: Vec<f64> = values.windows(2).map(|pair| (pair[0] + pair[1]) / 2.0).collect();
    let mirrored = |edge: Option<&f64>, end: Option<&f64>| Some(2.0 * end? - edge?);
    let first = mirrored(between.first(), values.first());
    let last = mirrored(between.last(), values.last());
    let all = first.into_iter().chain(between.iter().copied()).chain(last);
    all.map(|edge| if by_decades { edge.exp() } else { edge }).collect()
}

/// Returns the edges around a value.
fn around(values: &[f64], edges: &[f64], value: f64) -> Option<[f64; 2]> {
    let place = values.binary_search_by(|other| other.total_cmp(&value)).ok()?;
    Some([*edges.get(place)?, *edges.get(place + 1)?])
}
