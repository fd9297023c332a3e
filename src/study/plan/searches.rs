//! The validated key `optimize` of a study.

use crate::study::file::optimize_file::{OverPoints, SensitivityFrom};
use crate::study::plan::variable::DesignValue;

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
