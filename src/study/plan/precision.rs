//! The requested precision of the fraction of equilibria, and the number of runs per point.

use crate::study::error::{Fault, StudyError};
use crate::study::file::study_file::PrecisionFile;
use crate::study::file::yaml_tree::{Source, describe_number};
use crate::study::sampling::sampling_design::Design;

/// Sequential sampling: each point receives whole replicates of its design until the fraction of
/// equilibria is known to this precision.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Precision {
    /// Half width of the fraction's 95 % confidence interval at which sampling stops, above 0 and
    /// below 0.5.
    pub equilibrium_fraction: f64,
    /// Largest number of runs at a point; the runs of the design itself are always computed.
    pub max_runs: u64,
}

/// The number of runs of a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sampling {
    /// Number of runs before the first decision: the samples of the design.
    pub first: u64,
    /// Number of runs per replicate: one sample in every cell of a stratified design, otherwise as
    /// many as in the design.
    pub replicate: u64,
    /// Largest number of runs, for which run numbers are reserved; a multiple of the replicate.
    pub most: u64,
}

impl Precision {
    /// Validates the precision of a study file.
    ///
    /// # Errors
    /// Returns an error if the half width is not above 0 and below 0.5.
    pub(in crate::study) fn resolve(
        source: &Source,
        written: Option<&PrecisionFile>,
    ) -> Result<Option<Precision>, StudyError> {
        let Some(PrecisionFile { equilibrium_fraction, max_runs }) = written.copied() else {
            return Ok(None);
        };
        if 0.0 < equilibrium_fraction && equilibrium_fraction < 0.5 {
            return Ok(Some(Precision { equilibrium_fraction, max_runs: max_runs.0 }));
        }
        let allowed =
            "half the width of the confidence interval, above 0 and below 0.5, such as 0.02";
        let found = describe_number(equilibrium_fraction);
        let fault = Fault::new("not a half width", found, allowed);
        Err(source.path("precision.equilibrium_fraction").refuse_value(fault))
    }
}

impl Sampling {
    /// Computes the number of runs of a point whose design has `first` samples; a precision adds runs up to `longest`.
    ///
    /// # Errors
    /// Returns an error if there is a precision and the design cannot be enlarged.
    pub(in crate::study) fn new(
        design: &Design,
        first: u64,
        precision: Option<&Precision>,
        longest: u64,
    ) -> Result<Sampling, Fault> {
        let Some(precision) = precision else {
            return Ok(Sampling { first, replicate: first, most: first });
        };
        let Some((replicate, own_longest)) = design.enlargement(first) else {
            let allowed = "stratified, monte_carlo or sobol, or no `precision`";
            return Err(Fault::new("a design that cannot be enlarged", design.kind(), allowed));
        };
        let limit = precision.max_runs.min(own_longest).min(longest);
        Ok(Sampling { first, replicate, most: (limit - limit % replicate).max(first) })
    }
}
