//! Figure: basins of attraction, the start states in two coordinates, coloured by label.

use super::layers::{dots_by_label, label_symbol, label_words, places};
use crate::classification::Label;
use crate::model::Coordinate;
use crate::report::chart::{Axis, AxisKind, Figure, Layer, Panel, axis};
use crate::report::data::{ReportData, scattered};
use crate::study::Study;

/// About the largest number of panels.
const MOST_PANELS: usize = 480;

/// Plots a panel for each point and pair of coordinates; of many points, only for the first pairs.
pub fn figure(data: &ReportData<'_>) -> Option<Figure> {
    let study = data.study;
    let coordinates = study.model().coordinates();
    let mut pairs = pairs(study, &coordinates);
    let all_pairs = pairs.len();
    pairs.truncate((MOST_PANELS / data.detailed.len().max(1)).max(1));
    let of_points: Vec<(_, Vec<usize>)> =
        data.details().map(|point| (point, places(&data.runs, point.point_id, None))).collect();
    let all: usize = of_points.iter().map(|(_, runs)| runs.len()).sum();
    if pairs.is_empty() || all == 0 {
        return None;
    }
    let every = (all * pairs.len()).div_ceil(data.budget.starts).max(1);
    // Mixes the run numbers again to draw a subsample of the sample.
    let mixed = |run: u64| run.wrapping_mul(0x2545_f491_4f6c_dd1d).rotate_left(17);
    let is_shown = |place: usize| scattered(mixed(data.runs.run_id[place]), every as u64);
    let mut panels = Vec::new();
    let mut drawn = 0;
    for (point, runs) in &of_points {
        let first_panel = panels.len();
        let runs: Vec<usize> = runs.iter().copied().filter(|run| is_shown(*run)).collect();
        for &[first, second] in &pairs {
            let [x, y] = [first, second].map(|index| &data.runs.start[index]);
            let [of_x, of_y] = [first, second].map(|index| &coordinates[index]);
            // A point with fewer balls than others has no such coordinate.
            let is_known = |run: &usize| [x, y].iter().all(|column| column[*run].is_finite());
            if !runs.is_empty() && !runs.iter().any(is_known) {
                continue;
            }
            let sample = (&data.runs.run_id[..], &data.runs.label[..]);
            let layers = dots_by_label(sample, (x, y), &runs, label_symbol);
            panels.push(Panel {
                title: point.title.clone(),
                part: format!("{} and {}", words(of_x), words(of_y)),
                ..Panel::new(start_axis(of_x, x), start_axis(of_y, y), layers)
            });
        }
        let shown = panels.get(first_panel);
        drawn += shown.map_or(0, |panel| panel.layers.iter().map(Layer::dots).sum::<usize>());
    }
    let sampled = if every > 1 || data.runs.one_in > 1 {
        format!(" Subsample: {drawn} of the {} runs of these points are shown.", data.runs.of)
    } else {
        String::new()
    };
    let planes = match pairs.len() {
        all if all == all_pairs => String::new(),
        few => format!(" {few} of {all_pairs} pairs of coordinates are shown."),
    };
    let counts = Label::ALL.into_iter().filter_map(|label| {
        let count: u64 = data.details().map(|point| point.label(label).runs).sum();
        (count > 0).then(|| format!("{count} {}", label_words(label)))
    });
    let counts: Vec<String> = counts.collect();
    Figure::new(
        "basins",
        "Basins of attraction",
        format!(
            "Start states in the plane of two of their coordinates, coloured by the label of the run; the \
             other coordinates vary from dot to dot.{planes}{}{sampled}",
            data.left_out()
        ),
        format!("Start states of runs by label: {}.", counts.join(", ")),
        panels,
    )
}

/// Returns the pairs of coordinates to plot: equal ones of two balls, x and y, position and speed.
fn pairs(study: &Study, coordinates: &[Coordinate]) -> Vec<[usize; 2]> {
    let place = |name: &str| coordinates.iter().position(|coordinate| coordinate.name == name);
    let pair = |a: &str, b: &str| Some([place(a)?, place(b)?]);
    let balls = study.model().balls();
    if study.model().ball_balancer().is_none() {
        return (1..coordinates.len().min(4)).map(|second| [0, second]).collect();
    }
    let mut pairs = vec![
        pair("beta_1", "beta_2"),
        pair("beta_dot_1", "beta_dot_2"),
        pair("x", "y"),
        pair("x_dot", "y_dot"),
    ];
    let each = (1..=balls).map(|ball| pair(&format!("beta_{ball}"), &format!("beta_dot_{ball}")));
    pairs.extend(each);
    pairs.into_iter().flatten().collect()
}

/// Returns a coordinate in mathematical notation: `β̇₁` for `beta_dot_1`.
fn words(coordinate: &Coordinate) -> String {
    let dotted = coordinate.name.contains("_dot");
    let mut parts = coordinate.name.split('_');
    let letter = match parts.next() {
        Some("beta") => "β",
        Some(letter) => letter,
        None => "",
    };
    let ball: String =
        parts.filter_map(|part| part.parse().ok()).map(super::layers::subscript).collect();
    format!("{letter}{}{ball}", if dotted { "\u{307}" } else { "" })
}

/// Returns the axis of a coordinate; the axis of an angle is one turn if the start states cover it.
fn start_axis(coordinate: &Coordinate, values: &[f64]) -> Axis {
    let round = 0.0..=std::f64::consts::TAU;
    let angle = coordinate.unit == Some("rad")
        && values.iter().all(|value| value.is_nan() || round.contains(value));
    let axis = axis(&format!("{} at the start", words(coordinate)), coordinate.unit.unwrap_or(""));
    match angle {
        true => Axis { range: Some([0.0, std::f64::consts::TAU]), kind: AxisKind::Angle, ..axis },
        false => axis,
    }
}
