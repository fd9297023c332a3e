//! A point of the sweep as one line of text, and the values of its swept parameters in messages.

use crate::classification::Label;
use crate::report::{Fraction, PointFacts, percent, three_digits};
use crate::study::{Study, VariedParameter};

/// Returns a point as one line of text. With `own_machines` the amplitude without balls is a median over the runs.
pub fn point_line(study: &Study, point: &PointFacts, own_machines: bool) -> String {
    let swept = swept_text(study.swept(), &study.shown(&point.swept));
    let mut line = format!("point {}{swept}: {} runs", point.point_id, point.runs);
    let unit = study.units().vibration();
    let (vibration, unit) = (|metres: f64| three_digits(unit.of(metres)), &unit.symbol);
    if let Some([worse, ..]) = point.residual.worse_than_without_balls {
        let [_, median, p95] = point.amplitude_m.map(|metres| metres.map(vibration));
        if let (Some(median), Some(p95)) = (median, p95) {
            line += &format!(", vibration {median} {unit} (95 % of the runs: {p95} {unit})");
        }
        if let Some(without) = point.residual.amplitude_without_balls_m {
            let median = if own_machines { " (median)" } else { "" };
            line += &format!(", without balls {} {unit}{median}", vibration(without));
        }
        line += &format!("; {} % of the runs vibrate more than without balls", percent(worse));
    }
    let Fraction { fraction, low, high, .. } = point.equilibrium;
    let [fraction, low, high] = [fraction, low, high].map(percent);
    line += &format!("; {fraction} % at rest ({low} .. {high} %)");
    match point.label(Label::Failed).runs {
        0 => line,
        failed => format!("{line}, {failed} failed"),
    }
}

/// Returns the values of the swept parameters for a message, each after a blank, as ` speed_rad_s=-160` or, with a unit
/// that the study chooses, ` speed=-1528 rpm`. The values are those of [`Study::shown`].
pub fn swept_text(columns: &[VariedParameter], shown: &[String]) -> String {
    let each = columns.iter().zip(shown);
    each.map(|(column, value)| match &column.shown {
        Some(unit) => format!(" {}={value} {}", column.short_name(), unit.symbol),
        None => format!(" {}={value}", column.name),
    })
    .collect()
}
