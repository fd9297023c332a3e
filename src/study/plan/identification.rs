//! The validated key `identify` of a study.

use crate::study::file::identify_file::PriorSpacing;
use crate::study::plan::variable::Variable;

/// What is to be inferred from measurements, and the effort.
#[derive(Clone, Debug, PartialEq)]
pub struct Identification {
    /// The parameters with the ranges of their priors.
    pub parameters: Vec<Variable>,
    /// The scale of each parameter, on which the density of its prior is constant.
    pub spacings: Vec<PriorSpacing>,
    /// Number of parameter sets in the initial space-filling sample.
    pub start_designs: u64,
    /// Number of parameter sets in total.
    pub designs: u64,
    /// Number of samples of the posterior.
    pub posterior_samples: u64,
}

impl Identification {
    /// Returns the values of the parameters at a place in the unit cube, on which the prior is uniform.
    pub fn values_at(&self, place: &[f64]) -> Vec<f64> {
        let value = |((parameter, spacing), place): ((&Variable, &PriorSpacing), &f64)| {
            let [from, to] = parameter.range().unwrap_or([f64::NAN; 2]);
            match spacing {
                PriorSpacing::Linear => from + place * (to - from),
                PriorSpacing::Logarithmic => from * libm::pow(to / from, *place),
            }
        };
        self.parameters.iter().zip(&self.spacings).zip(place).map(value).collect()
    }

    /// Returns the place of values in the unit cube.
    pub fn place_of(&self, values: &[f64]) -> Vec<f64> {
        let place = |((parameter, spacing), value): ((&Variable, &PriorSpacing), &f64)| {
            let [from, to] = parameter.range().unwrap_or([f64::NAN; 2]);
            match spacing {
                PriorSpacing::Linear => (value - from) / (to - from),
                PriorSpacing::Logarithmic => libm::log(value / from) / libm::log(to / from),
            }
        };
        self.parameters.iter().zip(&self.spacings).zip(values).map(place).collect()
    }
}
