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
        let held = data.runs.amplitudes.get(&point.point_id);
        let mut values: Vec<f64> = held.into_iter().flatten().copied().collect();
        if values.is_empty() {
            continue;
        }
        values.sort_by(f64::total_cmp);
        let count = values.len();
        // Runs without any vibration count, but have no place on the logarithmic axis of relative amplitudes.
        let still = if balls { values.partition_point(|value| *value <= 0.0) } else { 0 };
        let step = |rank: usize| Some([*values.get(rank)?, (rank + 1) as f64 / count as f64]);
        let ranks = evenly(count - still, data.budget.steps).into_iter();
        let mut points: Vec<[f64; 2]> = ranks.filter_map(|rank| step(still + rank)).collect();
        if let Some([first, _]) = points.first().copied() {
            points.insert(0, [first, still as f64 / count as f64]);
        }
        if let Some([worse, ..]) = point.residual.worse_than_without_balls {
            let worse = 100.0 * worse;
            sentences.push(format!(
                "{}: {worse:.1} % of the runs vibrate more than without balls",
                point.title
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
                data.with_draws(
                    "Each amplitude is relative to that of the run's own machine without balls",
                )
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
