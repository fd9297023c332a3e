//! The validated keys `optimize` and `identify` of a study: what is sought or inferred, and the effort.

use crate::study::file::searches_file::{OverPoints, PriorSpacing, SensitivityFrom};
use crate::study::plan::variable::{DesignValue, Variable};

/// The objectives, limits and effort of an optimisation.
#[derive(Clone, Debug, PartialEq)]
pub struct Optimization {
    /// One or two objectives.
    pub objectives: Vec<Objective>,
    /// Limits of responses.
    pub limits: Vec<Limit>,
    /// How the values at the points of a sweep are combined.
    pub over_points: OverPoints,
    /// Number of designs in the initial space-filling sample.
    pub start_designs: u64,
    /// Number of designs in total.
    pub designs: u64,
    /// Number of designs that are recomputed with other random numbers.
    pub finalists: u64,
    /// Number of runs of a finalist, as a multiple of the runs in the search.
    pub final_samples: u64,
    /// Source of the responses for the Sobol' indices.
    pub sensitivity_from: SensitivityFrom,
    /// Number of base samples of the Sobol' indices.
    pub sensitivity_samples: u64,
    /// The reference design, if there is one.
    pub compare_with: Option<Vec<DesignValue>>,
}

/// A response to minimise or maximise.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Objective {
    /// Index of the response in the study.
    pub response: usize,
    /// Whether the response is maximised.
    pub maximize: bool,
}

/// A lower or upper limit of a response.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limit {
    /// Index of the response in the study.
    pub response: usize,
    /// The limit, in the unit of the response.
    pub value: f64,
    /// Whether this is a lower limit; otherwise it is an upper limit.
    pub least: bool,
}

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
