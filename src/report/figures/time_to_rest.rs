//! Figure: the probability of rest over time, of each point.

use super::layers::{CurveOf, few_each, fraction_axis, moving};
use crate::classification::Label;
use crate::report::chart::{Axis, Colour, Figure, Layer, Mark, Panel, axis};
use crate::report::data::{PointFacts, ReportData, RestCurve};

/// Plots curves with their bands, up to the end of the runs. With stages, time counts from the begin of the last one.
pub fn figure(data: &ReportData<'_>) -> Option<Figure> {
    let after = if data.study.has_stages() { " after the begin of the last stage" } else { "" };
    let curve_of =
        |point: &PointFacts| data.rest.iter().find(|curve| curve.point_id == point.point_id);
    let with_curves: Vec<(&PointFacts, &RestCurve)> =
        data.details().filter_map(|point| Some((point, curve_of(point)?))).collect();
    if with_curves.is_empty() {
        return None;
    }
    let observed = data.points.iter().map(|point| data.observed_s(point));
    let last = with_curves.iter().filter_map(|(_, curve)| curve.time_s.last().copied());
    let range = Some([0.0, last.chain(observed).fold(0.0, f64::max)]);
    let x = Axis { range, ..axis(&format!("time{after}"), "s") };
    let y = fraction_axis("probability of being at rest");
    let panel = |(part, few)| Panel { part, ..Panel::new(x.clone(), y.clone(), layers(data, few)) };
    let panels: Vec<Panel> = few_each(&with_curves).into_iter().map(panel).collect();
    let medians: Vec<String> = with_curves
        .iter()
        .map(|(point, _)| {
            let of = match failed(point) {
                0 => String::new(),
                failed => format!(" of those that did not fail ({failed} of {} did)", point.runs),
            };
            match point.time_to_rest_s[1] {
                Some(median) => {
                    format!("{}: half{of} at rest by {median:.3} s{after}", point.title)
                }
                None => format!("{}: less than half{of} at rest", point.title),
            }
        })
        .collect();
    Figure::new(
        "time-to-rest",
        match moving(data.study) {
            (body, true) => format!("When the {body} comes to rest"),
            (several, false) => format!("When the {several} come to rest"),
        },
        format!(
            "Probability of rest by time t{after} (Kaplan-Meier estimator; runs that still move at the end are \
             censored), with 95 % bands.{}{}{}",
            match data.failures_left_out() {
                none if none.is_empty() => none,
                failed => failed + " The bands include them: at rest immediately, or never.",
            },
            data.left_out(),
            data.curve_names()
        ),
        medians.join("; "),
        panels,
    )
}

fn layers(data: &ReportData<'_>, curves: &[CurveOf<'_, &RestCurve>]) -> Vec<Layer> {
    let end_of = |point: &PointFacts| data.observed_s(point);
    let layer = |place: usize, point: &PointFacts, mark| {
        let name = match failed(point) {
            0 => data.curve_name(point),
            failed => format!("{} ({failed} failed)", data.curve_name(point)),
        };
        Layer::new(&name, Colour::Series(place), mark)
    };
    let bands = curves.iter().enumerate().map(|(place, (point, curve))| {
        let RestCurve { time_s, low, high, .. } = curve;
        // Bounds for failed runs: all at rest immediately, or never.
        let part = failed(point) as f64 / point.runs.max(1) as f64;
        let mut x = time_s.clone();
        let mut low: Vec<f64> = low.iter().map(|low| low * (1.0 - part)).collect();
        let mut high: Vec<f64> = high.iter().map(|high| high * (1.0 - part) + part).collect();
        // The curve stays constant up to the end of the runs.
        let end = end_of(point);
        if x.last().is_some_and(|time| *time < end) {
            x.push(end);
            low.extend(low.last().copied());
            high.extend(high.last().copied());
        }
        layer(place, point, Mark::Band { x, low, high, steps: true })
    });
    let lines = curves.iter().enumerate().map(|(place, (point, curve))| {
        let steps = curve.time_s.iter().zip(&curve.probability).map(|(t, p)| [*t, *p]);
        let mut points: Vec<[f64; 2]> = std::iter::once([0.0, 0.0]).chain(steps).collect();
        let end = end_of(point);
        if let Some([_, probability]) = points.last().copied().filter(|[time, _]| *time < end) {
            points.push([end, probability]);
        }
        layer(place, point, Mark::Steps { points })
    });
    bands.chain(lines).collect()
}

fn failed(point: &PointFacts) -> u64 {
    point.label(Label::Failed).runs
}
