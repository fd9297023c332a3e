//! Figure: the distribution of the residual amplitude over the runs of each point.

use super::layers::{CurveOf, axis, few_each, fraction_axis, significant};
use crate::report::chart::{Axis, AxisKind, Colour, Figure, Layer, Mark, Panel};
use crate::report::data::{ReportData, evenly};

/// Plots empirical distributions, relative to the amplitude without balls if the model has balls.
pub fn figure(data: &ReportData<'_>) -> Option<Figure> {
    let balls = data.study.model().kind().offers.vibration;
    let mut curves = Vec::new();
    let mut sentences = Vec::new();
    for point in data.details() {
        let over = match (balls, point.without_balls_m) {
            (true, Some(without)) if without > 0.0 => without,
            (true, _) => continue,
            (false, _) => 1.0,
        };
        let held = data.runs.amplitudes_m.get(&point.point_id);
        let mut values: Vec<f64> = held
            .into_iter()
            .flatten()
            .map(|value| value / over)
            .filter(|value| value.is_finite() && (*value > 0.0 || !balls))
            .collect();
        if values.is_empty() {
            continue;
        }
        values.sort_by(f64::total_cmp);
        let count = values.len();
        let step = |rank: usize| Some([*values.get(rank)?, (rank + 1) as f64 / count as f64]);
        let ranks = evenly(count, data.budget.steps).into_iter();
        let mut points: Vec<[f64; 2]> = ranks.filter_map(step).collect();
        if let Some([first, _]) = points.first().copied() {
            points.insert(0, [first, 0.0]);
        }
        if balls {
            let less = values.partition_point(|value| *value < 1.0) as f64 / count as f64;
            sentences.push(format!(
                "{}: {:.1} % of the runs vibrate less than without balls",
                point.title,
                100.0 * less
            ));
        } else if let Some(median) = values.get((count - 1) / 2) {
            let median = significant(*median);
            sentences.push(format!(
                "{}: half of the runs have an amplitude of {median} m or less",
                point.title
            ));
        }
        curves.push((point, points));
    }
    if curves.is_empty() {
        return None;
    }
    let x = if balls {
        let name = "residual amplitude / amplitude without balls";
        Axis { kind: AxisKind::Logarithmic, ..axis(name, "") }
    } else {
        axis("amplitude at the end", "m")
    };
    let layers = |few: &[CurveOf<'_, Vec<[f64; 2]>>]| {
        let curve = |(place, (point, points)): (usize, &CurveOf<'_, Vec<[f64; 2]>>)| {
            let mark = Mark::Steps { points: points.clone() };
            Layer::new(&data.curve_name(point), Colour::Series(place), mark)
        };
        let rule = Mark::Rule { upright: true, at: 1.0, label: "without balls".to_owned() };
        let rule = balls.then(|| Layer::new("", Colour::Ink, rule));
        few.iter().enumerate().map(curve).chain(rule).collect()
    };
    let y = fraction_axis("fraction of runs below");
    let panel = |(part, few)| Panel { part, ..Panel::new(x.clone(), y.clone(), layers(few)) };
    let panels: Vec<Panel> = few_each(&curves).into_iter().map(panel).collect();
    let sampled = match data.runs.amplitude_one_in {
        1 => String::new(),
        one_in => format!(" Subsample: about one in {one_in} runs of these points is counted."),
    };
    Some(Figure {
        id: "residual-amplitude".to_owned(),
        title: "Distribution of the residual amplitude".to_owned(),
        caption: format!(
            "Empirical distribution of the amplitude at the end of a point's runs, at rest or \
             moving.{}{}{}{}{sampled}",
            data.failures_left_out(),
            if balls {
                data.without_draws("The amplitude without balls is that")
            } else {
                String::new()
            },
            data.left_out(),
            data.curve_names(),
        ),
        alternative: sentences.join("; "),
        one_at_a_time: panels.len() > 1,
        panels,
    })
}
