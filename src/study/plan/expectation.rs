//! Expectations of a study about its own results.

use crate::study::plan::parameter::{ParameterValue, VariedParameter};

/// Expected ranges of the fractions of runs per label and of the audit's flip rate. They apply to
/// every point that the selector matches.
#[derive(Clone, Debug, PartialEq)]
pub struct Expectation {
    /// Names and values of the swept parameters that select points; an empty selector selects all
    /// points.
    pub point: Vec<(String, ParameterValue)>,
    /// Each label, such as `equilibrium`, with the expected range `[low, high]` of its fraction of
    /// runs.
    pub fractions: Vec<(&'static str, [f64; 2])>,
    /// The expected range of the fraction of audited runs whose label changes.
    pub audit_flip_rate: Option<[f64; 2]>,
}

impl Expectation {
    /// Returns whether this expectation selects a point with these swept values, one for each column, in the
    /// order of `Study::swept`.
    pub fn selects(&self, columns: &[VariedParameter], swept: &[ParameterValue]) -> bool {
        self.point.iter().all(|(name, wanted)| {
            let column = columns.iter().position(|column| column.name == *name);
            column.and_then(|column| swept.get(column)).is_some_and(|value| same(value, wanted))
        })
    }
}

/// Returns whether two values are equal words, or numbers that agree to twelve digits.
pub(crate) fn same(left: &ParameterValue, right: &ParameterValue) -> bool {
    match (left, right) {
        (ParameterValue::Number(left), ParameterValue::Number(right)) => {
            (left - right).abs() <= 1.0e-12 * left.abs().max(right.abs())
        }
        (left, right) => left == right,
    }
}
