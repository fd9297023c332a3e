//! Parameters and points in words: `speed [rad/s]` for `speed_rad_s`, and lists of points.

use crate::report::chart::{Axis, axis};
use crate::study::{ParameterValue, Study, VariedParameter};

/// Returns the name of a parameter in words, without its unit.
pub fn words(parameter: &VariedParameter) -> String {
    parameter.short_name().replace('_', " ")
}

/// Returns the values of the swept parameters of a point as text; a negative number has a minus sign, not a hyphen.
pub fn said(study: &Study, values: &[ParameterValue]) -> Vec<String> {
    let each = values.iter().zip(study.shown(values));
    each.map(|(value, text)| match value {
        ParameterValue::Number(_) => text.replace('-', "\u{2212}"),
        ParameterValue::Text(_) => text,
    })
    .collect()
}

/// Returns the axis of a parameter.
pub fn axis_of(parameter: &VariedParameter) -> Axis {
    axis(&words(parameter), parameter.shown_unit())
}

/// Returns the names of the values of [`short`], as `speed [rad/s], friction coefficient`.
pub fn short_axis(study: &Study) -> Axis {
    let name = |parameter: &VariedParameter| match parameter.shown_unit() {
        "" => words(parameter),
        unit => format!("{} [{unit}]", words(parameter)),
    };
    let names: Vec<String> = study.swept().iter().map(name).collect();
    axis(&names.join(", "), "")
}

/// Returns the values of a point, as `-216.3772, 0.00275`; `point` and its number if nothing is swept.
pub fn short(study: &Study, point_id: u64, values: &[ParameterValue]) -> String {
    let values = said(study, values);
    if values.is_empty() { format!("point {point_id}") } else { values.join(", ") }
}

/// Returns the parameters of a point in words, as `speed -216.3772 rad/s, friction coefficient 0.00275`; only those
/// for which `wanted` returns true.
pub fn heading(study: &Study, values: &[ParameterValue], wanted: impl Fn(usize) -> bool) -> String {
    let values = said(study, values);
    let parts = study.swept().iter().zip(&values).enumerate();
    let part = |(index, (parameter, value)): (usize, (&VariedParameter, &String))| {
        let unit = parameter.shown_unit();
        let space = if unit.is_empty() { "" } else { " " };
        wanted(index).then(|| format!("{} {}{space}{unit}", words(parameter), value))
    };
    parts.filter_map(part).collect::<Vec<_>>().join(", ")
}

/// The largest number of points that a sentence names.
const MOST_NAMED: usize = 10;

/// A list of points that counts all of them and names only the first ones.
#[derive(Clone, Debug, Default)]
pub struct NamedPoints {
    /// The number of the points.
    pub count: u64,
    first: Vec<u64>,
}

impl NamedPoints {
    /// Adds a point.
    pub fn add(&mut self, point_id: u64) {
        self.count += 1;
        if self.first.len() < MOST_NAMED {
            self.first.push(point_id);
        }
    }

    /// Returns the points in words, as `points 1, 4 and 2 more`.
    pub fn text(&self) -> String {
        let named: Vec<String> = self.first.iter().map(u64::to_string).collect();
        let plural = if self.count == 1 { "" } else { "s" };
        let others = match self.count - self.first.len() as u64 {
            0 => String::new(),
            others => format!(" and {others} more"),
        };
        format!("point{plural} {}{others}", named.join(", "))
    }
}
