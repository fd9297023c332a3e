//! A point of the sweep as one line of text, and the values of its swept parameters in messages.

use crate::classification::Label;
use crate::report::{Fraction, PointFacts, percent, three_digits};
use crate::study::{ParameterValue, Study};

/// Returns a point as one line of text. With `own_machines` the amplitude without balls is a median over the runs.
pub fn point_line(study: &Study, point: &PointFacts, own_machines: bool) -> String {
    let words = point_words(study, point.point_id, &point.swept);
    let mut line = format!("{words}: {} runs", point.runs);
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

/// Returns a point and the values of its swept parameters for a message, as `point 3 speed_rad_s=-160` or, with a unit that
/// the study chooses, `point 3 speed=-1528 rpm`.
pub fn point_words(study: &Study, point_id: u64, swept: &[ParameterValue]) -> String {
    let shown = study.shown(swept);
    let each = study.swept().iter().zip(shown).map(|(column, value)| match &column.shown {
        Some(unit) => format!(" {}={value} {}", column.short_name(), unit.symbol),
        None => format!(" {}={value}", column.name),
    });
    format!("point {point_id}{}", each.collect::<String>())
}
