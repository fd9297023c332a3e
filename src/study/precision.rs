//! How precisely the fraction of equilibria is wanted, and how many runs of each point that may take.

use super::design::Design;
use super::error::{Fault, Locate, StudyError};
use super::file::PrecisionFile;
use super::file_values::Count;
use super::key_path::KeyPath;
use super::node::describe_number;

/// Sampling goes on at each point, in whole replicates of its design, until the fraction of equilibria
/// is known so well.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Precision {
    /// The half width of the fraction's 95 % interval at which sampling stops, above 0 and below 0.5.
    pub equilibrium_fraction: f64,
    /// The most runs at a point, apart from those that its design begins with.
    pub max_runs: u64,
}

/// How many runs a point has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sampling {
    /// Runs before the first decision: the samples that the design names.
    pub first: u64,
    /// Runs that are added together: one sample in every cell of a stratified design, otherwise as
    /// many as at first.
    pub replicate: u64,
    /// The most runs, for which numbers are reserved: a multiple of the replicate.
    pub most: u64,
}

impl Precision {
    /// Checks a precision.
    ///
    /// # Errors
    /// A half width that is none.
    pub(super) fn resolve(
        locate: &dyn Locate,
        written: Option<&PrecisionFile>,
    ) -> Result<Option<Precision>, StudyError> {
        let Some(PrecisionFile { equilibrium_fraction, max_runs }) = written.copied() else {
            return Ok(None);
        };
        if 0.0 < equilibrium_fraction && equilibrium_fraction < 0.5 {
            return Ok(Some(Precision { equilibrium_fraction, max_runs: max_runs.0 }));
        }
        let allowed =
            "half the width of an interval of fractions, above 0 and below 0.5, such as 0.02";
        let found = describe_number(equilibrium_fraction);
        let fault = Fault::new("not a half width", found, allowed);
        Err(locate.refuse_value(&KeyPath::of("precision.equilibrium_fraction"), fault))
    }

    /// As a study file writes it.
    pub(super) fn to_file(self) -> PrecisionFile {
        let Precision { equilibrium_fraction, max_runs } = self;
        PrecisionFile { equilibrium_fraction, max_runs: Count(max_runs) }
    }
}

impl Sampling {
    /// The runs of a point whose design begins with `first` samples.
    ///
    /// # Errors
    /// A design that cannot be enlarged, where a precision asks for that.
    pub(super) fn new(
        design: &Design,
        first: u64,
        precision: Option<&Precision>,
    ) -> Result<Sampling, Fault> {
        let Some(precision) = precision else {
            return Ok(Sampling { first, replicate: first, most: first });
        };
        let Some((replicate, longest)) = design.enlargement(first) else {
            let allowed = "stratified, monte_carlo or sobol, or no `precision`";
            return Err(Fault::new("a design that cannot be enlarged", design.kind(), allowed));
        };
        let limit = precision.max_runs.min(longest);
        Ok(Sampling { first, replicate, most: (limit - limit % replicate).max(first) })
    }
}
