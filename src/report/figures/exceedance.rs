//! Figure: the probability that the vibration exceeds a limit, over the limit, with its 95 % band.

use super::layers::{CurveOf, axis, few_each, fraction_axis, significant};
use crate::analysis::{Z_95, wilson};
use crate::report::chart::{Axis, AxisKind, Colour, Figure, Layer, Mark, Panel};
use crate::report::data::{PointFacts, ReportData, evenly};
use crate::study::{AmplitudeKind, Measure};

/// Points of a curve with its band: amplitude, fraction above it, lower and upper end.
type Exceedance = Vec<[f64; 4]>;

/// Plots the fraction of each point's runs above an amplitude; `None` for a model without vibration.
pub fn figure(data: &ReportData<'_>) -> Option<Figure> {
    if !data.study.model().kind().offers.vibration {
        return None;
    }
    let unit = data.amplitude_unit();
    let mut sentences = Vec::new();
    let mut curves: Vec<CurveOf<'_, Exceedance>> = Vec::new();
    for point in data.details() {
        let mut values = amplitudes(data, point);
        values.iter_mut().for_each(|metres| *metres = unit.of(*metres));
        let Some(median) = point.amplitude_m[1].filter(|_| !values.is_empty()) else { continue };
        sentences.push(format!(
            "{}: half of the runs vibrate more than {} {}",
            point.title,
            significant(unit.of(median)),
            unit.symbol
        ));
        curves.push((point, exceedance(&values, data.budget.steps)));
    }
    if curves.is_empty() {
        return None;
    }
    let limits: Vec<f64> = limits(data).map(|metres| unit.of(metres)).collect();
    let layers = |few: &[CurveOf<'_, Exceedance>]| -> Vec<Layer> {
        let curve = |(place, (point, points)): (usize, &CurveOf<'_, Exceedance>)| {
            let column = |part: usize| points.iter().map(|point| point[part]).collect();
            let band = Mark::Band { x: column(0), low: column(2), high: column(3), steps: true };
            let steps = points.iter().map(|[x, fraction, ..]| [*x, *fraction]).collect();
            let name = data.curve_name(point);
            let colour = Colour::Series(place);
            [
                Layer::new(&name, colour, band),
                Layer::new(&name, colour, Mark::Steps { points: steps }),
            ]
        };
        let rule = |at: &f64| {
            let label = format!("limit {} {}", significant(*at), unit.symbol);
            Layer::new("", Colour::Ink, Mark::Rule { upright: true, at: *at, label })
        };
        few.iter().enumerate().flat_map(curve).chain(limits.iter().map(rule)).collect()
    };
    let x = Axis { kind: AxisKind::Logarithmic, ..axis("amplitude", &unit.symbol) };
    let y = fraction_axis("fraction of runs above");
    let panel = |(part, few)| Panel { part, ..Panel::new(x.clone(), y.clone(), layers(few)) };
    let panels: Vec<Panel> = few_each(&curves).into_iter().map(panel).collect();
    let of_limits =
        if limits.is_empty() { "" } else { " Rules: the limits of the study's responses." };
    Some(Figure {
        id: "exceedance".to_owned(),
        title: "Probability of exceeding a vibration".to_owned(),
        caption: format!(
            "Fraction of a point's runs whose amplitude at the end is above a value, with its 95 % band (Wilson, for each \
             value separately).{of_limits}{}{}{}{}",
            data.failures_left_out(),
            data.left_out(),
            data.runs.left_out(),
            data.curve_names(),
        ),
        alternative: sentences.join("; "),
        one_at_a_time: panels.len() > 1,
        panels,
    })
}

/// Returns the amplitudes of a point's runs in the sample, m, ascending.
fn amplitudes(data: &ReportData<'_>, point: &PointFacts) -> Vec<f64> {
    let runs = data.runs.point_id.iter().zip(&data.runs.amplitude_m);
    let own = runs.filter(|(id, amplitude)| **id == point.point_id && amplitude.is_finite());
    let mut values: Vec<f64> = own.map(|(_, amplitude)| *amplitude).collect();
    values.sort_by(f64::total_cmp);
    values
}

/// Returns at most `most` points of the curve of ascending values; an amplitude of 0 has no place on a logarithmic axis.
fn exceedance(ascending: &[f64], most: usize) -> Exceedance {
    let all = ascending.len();
    let still = ascending.partition_point(|value| *value <= 0.0);
    let at = |rank: usize| {
        let value = *ascending.get(still + rank)?;
        let above = all - ascending.partition_point(|other| *other <= value);
        let (low, high) = wilson(above as u64, all as u64, Z_95);
        Some([value, above as f64 / all as f64, low, high])
    };
    evenly(all - still, most).into_iter().filter_map(at).collect()
}

/// Returns the absolute limits of the study's responses, m.
fn limits(data: &ReportData<'_>) -> impl Iterator<Item = f64> {
    data.study.responses().iter().filter_map(|response| match response.measure {
        Measure::Above(limit) if response.amplitude == AmplitudeKind::Residual => Some(limit),
        _ => None,
    })
}
