//! A parameter whose value is drawn for each run.

use crate::study::plan::parameter::Parameter;
use crate::study::sampling::distribution::Distribution;
use crate::study::sampling::draw::DrawKey;

/// A parameter that is drawn for each run.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct UncertainParameter {
    /// The parameter.
    pub parameter: Parameter,
    /// The distribution of the value, or of a factor.
    pub distribution: Distribution,
    /// Whether the draw is a factor that multiplies the nominal value.
    pub factor: bool,
    /// The key of the random numbers.
    pub key: DrawKey,
}
