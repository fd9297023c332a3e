//! The scale on which a process models a quantity: logarithmic for positive values over more than a decade.

use super::goal::Goal;

/// Ratio of the largest to the smallest value from which the scale is logarithmic.
const DECADE: f64 = 10.0;

/// A monotonically increasing scale.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(super) enum QuantityScale {
    Linear,
    Logarithmic,
}

impl QuantityScale {
    /// Returns the scale for the values of a quantity, given by its index in the goal.
    pub fn new(goal: &Goal, quantity: usize, values: &[f64]) -> QuantityScale {
        let least = values.iter().copied().fold(f64::INFINITY, f64::min);
        let most = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let mut limits = goal.limits.iter().filter(|(index, _)| *index == quantity);
        let positive = least > 0.0 && limits.all(|(_, limit)| limit.value > 0.0);
        match positive && most > DECADE * least {
            true => QuantityScale::Logarithmic,
            false => QuantityScale::Linear,
        }
    }

    /// Returns a value on the scale.
    pub fn scaled(self, value: f64) -> f64 {
        match self {
            QuantityScale::Linear => value,
            QuantityScale::Logarithmic => value.ln(),
        }
    }

    /// Returns the value at a place on the scale.
    pub fn raw(self, scaled: f64) -> f64 {
        match self {
            QuantityScale::Linear => scaled,
            QuantityScale::Logarithmic => scaled.exp(),
        }
    }

    /// Returns a standard error on the scale, to first order.
    pub fn scaled_error(self, value: f64, error: f64) -> f64 {
        match self {
            QuantityScale::Linear => error,
            QuantityScale::Logarithmic => error / value,
        }
    }
}
