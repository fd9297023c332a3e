//! Figure: the residual vibration of each point, and the vibration without balls.

use super::layers::{fraction_axis, of_points};
use super::sweep_axis::{OverSweep, is_by_decades};
use crate::numbers::significant;
use crate::report::chart::{
    Axis, AxisKind, Colour, Figure, Layer, Mark, Panel, Symbol, Tooltips, axis,
};
use crate::report::data::{PointFacts, ReportData};

/// The title of the panels with the fraction of runs that the balls make worse.
const WORSE: &str = "runs that vibrate more than without balls";

/// Plots median and 95 % quantile of the amplitude, and the amplitude without balls, over the sweep; and the fraction of
/// the runs that vibrate more than without balls.
pub fn figure(data: &ReportData<'_>) -> Option<Figure> {
    let known = |point: &PointFacts| point.amplitude_m[1].is_some();
    if !data.points.iter().any(known) {
        return None;
    }
    let balls = data.study.model().kind().offers.vibration;
    let sweep = OverSweep::new(data, 4);
    let amplitudes = amplitude_axis(data);
    let amplitude = |points: &[(f64, &PointFacts)]| amplitude_layers(data, points);
    let fraction = |points: &[(f64, &PointFacts)]| {
        line((WORSE, Colour::Series(1), Symbol::Disc, false), points, worse_fraction)
    };
    let has_worse = data.points.iter().any(|point| worse_fraction(point).is_some());
    let mut panels = sweep.panels(&amplitudes, amplitude);
    if has_worse {
        let name = |part: &str, panels: Vec<Panel>| {
            panels.into_iter().map(|panel| Panel { part: part.to_owned(), ..panel }).collect()
        };
        let fractions = sweep.panels(&fraction_axis("fraction of runs"), fraction);
        let fractions: Vec<Panel> = name(WORSE, fractions);
        panels = name("amplitude", panels);
        panels.extend(fractions);
    }
    let without =
        if balls { " Squares: the amplitude of the same machine without balls." } else { "" };
    let draws = match balls {
        true => data.with_draws("The amplitude without balls is the median over the runs"),
        false => String::new(),
    };
    Figure::new(
        "vibration",
        match sweep.parameter.as_str() {
            "" => "Residual vibration".to_owned(),
            over => format!("Residual vibration, over {over}"),
        },
        format!(
            "Median and 95 % quantile of the amplitude at the end of the runs of each point, at rest or \
             moving.{without}{}{draws}{}",
            data.failures_left_out(),
            sweep.left_out,
        ),
        words(data),
        panels,
    )
}

/// Returns a sentence for each point in detail.
fn words(data: &ReportData<'_>) -> String {
    let shown = data.amplitude_unit();
    let unit = &shown.symbol;
    let sentences = data.details().filter_map(|point| {
        let [_, median, p95] = point.amplitude_m.map(|value| value.map(|value| shown.of(value)));
        let mut sentence = format!("{}: {} {unit}", point.title, significant(median?));
        if let Some(p95) = p95 {
            sentence += &format!(" (95 % of the runs: {} {unit} or less)", significant(p95));
        }
        if let Some(without) = point.residual.amplitude_without_balls_m {
            sentence += &format!(", {} {unit} without balls", significant(shown.of(without)));
        }
        if let Some(worse) = worse_fraction(point) {
            let worse = 100.0 * worse;
            sentence += &format!(", {worse:.1} % of the runs vibrate more than without balls");
        }
        Some(sentence)
    });
    format!("Median amplitude. {}", sentences.collect::<Vec<_>>().join("; "))
}

/// Returns the axis of all amplitudes, from 0 or by decades.
fn amplitude_axis(data: &ReportData<'_>) -> Axis {
    let unit = data.amplitude_unit();
    let of_point = |point: &PointFacts| {
        let [_, median, p95] = point.amplitude_m;
        [median, p95, point.residual.amplitude_without_balls_m]
    };
    let values = data.points.iter().flat_map(of_point).flatten().map(|value| unit.of(value));
    let mut values: Vec<f64> = values.filter(|value| value.is_finite()).collect();
    values.sort_by(f64::total_cmp);
    let axis = axis("amplitude", &unit.symbol);
    match values.last() {
        Some(_) if is_by_decades(&values) => Axis { kind: AxisKind::Logarithmic, ..axis },
        Some(most) if *most > 0.0 => Axis { range: Some([0.0, 1.06 * most]), ..axis },
        _ => axis,
    }
}

fn amplitude_layers(data: &ReportData<'_>, points: &[(f64, &PointFacts)]) -> Vec<Layer> {
    let unit = data.amplitude_unit();
    let median = |point: &PointFacts| point.amplitude_m[1];
    let p95 = |point: &PointFacts| point.amplitude_m[2];
    let without = |point: &PointFacts| point.residual.amplitude_without_balls_m;
    let series: [(&str, Colour, Symbol, bool, Value<'_>); 3] = [
        ("95 % quantile", Colour::Series(1), Symbol::Triangle, true, &p95),
        ("median", Colour::Series(0), Symbol::Disc, false, &median),
        ("without balls", Colour::Ink, Symbol::Square, true, &without),
    ];
    let layers = series.into_iter().flat_map(|(name, colour, symbol, dashed, value)| {
        let value = |point: &PointFacts| value(point).map(|metres| unit.of(metres));
        line((name, colour, symbol, dashed), points, value)
    });
    layers.collect()
}

/// Returns a line through the known values of points, with dots.
fn line(
    (name, colour, symbol, dashed): (&str, Colour, Symbol, bool),
    points: &[(f64, &PointFacts)],
    value: impl Fn(&PointFacts) -> Option<f64>,
) -> Vec<Layer> {
    let known = points.iter().filter_map(|(x, point)| Some(([*x, value(point)?], *point)));
    let (points, of): (Vec<[f64; 2]>, Vec<&PointFacts>) = known.unzip();
    if points.is_empty() {
        return Vec::new();
    }
    let dots = Mark::dots(symbol, &points, Tooltips::numbers(of_points(of.into_iter())));
    [Mark::Line { points, dashed }, dots].map(|mark| Layer::new(name, colour, mark)).into()
}

/// A value of a point.
type Value<'a> = &'a dyn Fn(&PointFacts) -> Option<f64>;

/// Returns the fraction of a point's runs that vibrate more than without balls.
fn worse_fraction(point: &PointFacts) -> Option<f64> {
    point.residual.worse_than_without_balls.map(|[worse, ..]| worse)
}
