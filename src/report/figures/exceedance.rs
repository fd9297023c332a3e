//! Figure: the probability that a run's amplitude exceeds a value, with its 95 % band: in the unit of vibration, and relative
//! to the amplitude without balls.

use super::layers::{CurveOf, few_each, fraction_axis};
use crate::analysis::Measure;
use crate::analysis::{Z_95, wilson};
use crate::numbers::significant;
use crate::report::chart::{Axis, AxisKind, Colour, Figure, Layer, Mark, Panel, axis};
use crate::report::data::{ReportData, evenly};
use crate::study::{AmplitudeKind, Response, Unit};

/// Points of a curve with its band: amplitude, fraction above it, lower and upper end.
type Exceedance = Vec<[f64; 4]>;

/// Plots the fraction of each point's runs above an amplitude, absolute and relative; only absolute for a model without
/// vibration.
pub fn figure(data: &ReportData<'_>) -> Option<Figure> {
    let vibrates = data.study.model().kind().offers.vibration;
    let shown = data.amplitude_unit();
    let ratio = Unit { symbol: String::new(), si: 1.0 };
    let mut panels = panels(data, AmplitudeKind::Residual, &shown);
    if vibrates {
        panels.extend(self::panels(data, AmplitudeKind::RelativeResidual, &ratio));
    }
    let sentences = data.details().filter_map(|point| {
        let median = significant(shown.of(point.amplitude_m[1]?));
        let worse = point.residual.worse_than_without_balls;
        let worse = worse.map(|[worse, ..]| {
            format!(", and {:.1} % of the runs vibrate more than without balls", 100.0 * worse)
        });
        let (title, unit) = (&point.title, &shown.symbol);
        Some(format!(
            "{title}: half of the runs have an amplitude above {median} {unit}{}",
            worse.unwrap_or_default()
        ))
    });
    let kinds = [AmplitudeKind::Residual, AmplitudeKind::RelativeResidual];
    let has_limits =
        kinds.iter().any(|kind| limits(data.study.responses(), *kind).next().is_some());
    Figure::new(
        "exceedance",
        "Probability of exceeding an amplitude",
        format!(
            "Fraction of a point's runs, at rest or moving, whose amplitude at the end is above a value, with its 95 % \
             band (Wilson, for each value separately).{}{}{}{}{}{}",
            if has_limits {
                " Vertical lines are the limits of the study's responses."
            } else {
                ""
            },
            data.failures_left_out(),
            if vibrates {
                data.with_draws(
                    "A relative amplitude is relative to that of the run's own machine without balls",
                )
            } else {
                String::new()
            },
            data.left_out(),
            data.curve_names(),
            match data.runs.amplitude_one_in {
                1 => String::new(),
                one_in => format!(" Subsample: about one in {one_in} runs of these points counts."),
            }
        ),
        sentences.collect::<Vec<_>>().join("; "),
        panels,
    )
}

/// Returns the panels of a few curves each.
fn panels(data: &ReportData<'_>, kind: AmplitudeKind, unit: &Unit) -> Vec<Panel> {
    let is_relative = kind == AmplitudeKind::RelativeResidual;
    let is_logarithmic = data.study.model().kind().offers.vibration;
    let mut curves: Vec<CurveOf<'_, Exceedance>> = Vec::new();
    for point in data.details() {
        let held = data.runs.amplitudes.get(&point.point_id);
        let held = held.into_iter().flat_map(|held| &held[usize::from(is_relative)]);
        let mut values: Vec<f64> = held.map(|value| unit.of(*value)).collect();
        values.sort_by(f64::total_cmp);
        if !values.is_empty() {
            curves.push((point, exceedance(&values, is_logarithmic, data.budget.steps)));
        }
    }
    let mut rules: Vec<(f64, String)> = limits(data.study.responses(), kind)
        .map(|limit| unit.of(limit))
        .map(|at| (at, format!("limit {} {}", significant(at), unit.symbol).trim_end().to_owned()))
        .collect();
    if is_relative {
        rules.retain(|(at, _)| *at != 1.0);
        rules.push((1.0, "without balls".to_owned()));
    }
    let layers = |few: &[CurveOf<'_, Exceedance>]| -> Vec<Layer> {
        let curve = |(place, (point, points)): (usize, &CurveOf<'_, Exceedance>)| {
            let column = |part: usize| points.iter().map(|point| point[part]).collect();
            let band = Mark::Band { x: column(0), low: column(2), high: column(3), steps: true };
            let steps = points.iter().map(|[x, fraction, ..]| [*x, *fraction]).collect();
            [band, Mark::Steps { points: steps }]
                .map(|mark| Layer::new(&data.curve_name(point), Colour::Series(place), mark))
        };
        let rule = |(at, label): &(f64, String)| {
            let mark = Mark::Rule { upright: true, at: *at, label: label.clone() };
            Layer::new("", Colour::Ink, mark)
        };
        few.iter().enumerate().flat_map(curve).chain(rules.iter().map(rule)).collect()
    };
    let x = match is_relative {
        true => axis("residual amplitude / amplitude without balls", ""),
        false => axis("amplitude at the end", &unit.symbol),
    };
    let kind = if is_logarithmic { AxisKind::Logarithmic } else { AxisKind::Linear };
    let x = Axis { kind, ..x };
    let y = fraction_axis("fraction of runs above");
    let panel = |(points, few): (String, _)| {
        let what =
            if is_relative { "relative to the amplitude without balls" } else { "amplitude" };
        let part = if points.is_empty() { what.to_owned() } else { format!("{what}, {points}") };
        Panel { part, ..Panel::new(x.clone(), y.clone(), layers(few)) }
    };
    few_each(&curves).into_iter().filter(|(_, few)| !few.is_empty()).map(panel).collect()
}

/// Returns at most `most` points of the curve of ascending values; an amplitude of 0 has no place on a logarithmic axis.
fn exceedance(ascending: &[f64], is_logarithmic: bool, most: usize) -> Exceedance {
    let all = ascending.len();
    let still = if is_logarithmic { ascending.partition_point(|value| *value <= 0.0) } else { 0 };
    let at = |rank: usize| {
        let value = *ascending.get(still + rank)?;
        let above = all - ascending.partition_point(|other| *other <= value);
        let (low, high) = wilson(above as u64, all as u64, Z_95);
        Some([value, above as f64 / all as f64, low, high])
    };
    evenly(all - still, most).into_iter().filter_map(at).collect()
}

/// Returns the limits of the study's responses to amplitudes of this kind.
fn limits(responses: &[Response], kind: AmplitudeKind) -> impl Iterator<Item = f64> {
    responses.iter().filter_map(move |response| match response.measure {
        Measure::Above(limit) if response.amplitude == kind => Some(limit),
        _ => None,
    })
}
