//! The requested precision of the fraction of equilibria and of amplitudes, and the number of runs per point.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::study::error::{Fault, StudyError};
use crate::study::file::source::Source;
use crate::study::file::values::Count;
use crate::study::file::yaml_tree::describe_number;
use crate::study::sampling::sampling_design::Design;

/// Sequential sampling: adds whole replicates of the design at each point until the 95 % confidence
/// intervals of the given columns are narrow enough; only for `stratified`, `monte_carlo` and
/// `sobol`.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "PrecisionFile")]
pub struct Precision {
    /// Half width of the 95 % confidence interval (`ci_low` to `ci_high`) at which sampling stops;
    /// above 0, below 0.5.
    #[schemars(extend("exclusiveMinimum" = 0, "exclusiveMaximum" = 0.5))]
    pub equilibrium_fraction: Option<f64>,
    /// Half width of the 95 % confidence interval of the quantile 5 % of the amplitude, m; above 0.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub amplitude_p05_m: Option<f64>,
    /// Half width of the 95 % confidence interval of the median amplitude, m; above 0.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub amplitude_p50_m: Option<f64>,
    /// Half width of the 95 % confidence interval of the quantile 95 % of the amplitude, m; above 0.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub amplitude_p95_m: Option<f64>,
    /// Largest number of runs at each point; the runs of the design itself are always computed, and
    /// a Sobol' sequence ends after 65,536.
    pub max_runs: Count,
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
    /// Checks the precision of a study file.
    ///
    /// # Errors
    /// Returns an error if there is no half width.
    pub(in crate::study) fn check(&self, source: &Source) -> Result<(), StudyError> {
        if !self.half_widths().is_empty() {
            return Ok(());
        }
        let allowed = "at least one half width, such as equilibrium_fraction: 0.02 or \
                       amplitude_p95_m: 1.0e-6";
        Err(source.path("precision").wrong_value("no interval", "only max_runs", allowed))
    }

    /// Returns the half widths of the amplitude's quantiles 5, 50 and 95 %, m.
    pub fn amplitudes_m(&self) -> [Option<f64>; 3] {
        [self.amplitude_p05_m, self.amplitude_p50_m, self.amplitude_p95_m]
    }

    /// Returns the half widths by column, with their units.
    pub fn half_widths(&self) -> Vec<(&'static str, f64, &'static str)> {
        let fraction = self.equilibrium_fraction.map(|half| ("equilibrium_fraction", half, ""));
        let amplitudes = ["amplitude_p05_m", "amplitude_p50_m", "amplitude_p95_m"]
            .into_iter()
            .zip(self.amplitudes_m());
        let amplitudes = amplitudes.filter_map(|(name, half)| Some((name, half?, " m")));
        fraction.into_iter().chain(amplitudes).collect()
    }

    /// Returns what is narrow enough, in words.
    pub fn in_words(&self) -> String {
        if let (Some(half), [None, None, None]) = (self.equilibrium_fraction, self.amplitudes_m()) {
            return format!("the half width of the 95 % interval is at most {half}");
        }
        let each = self.half_widths().into_iter().map(|(name, half, unit)| {
            format!("of {name} is at most {}{unit}", describe_number(half))
        });
        let each: Vec<String> = each.collect();
        format!("the half width of the 95 % interval {}", each.join(", and that "))
    }
}

impl Sampling {
    /// Computes the number of runs of a point whose design has `first` samples; a precision adds runs up to `longest`.
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
        let limit = precision.max_runs.0.min(own_longest).min(longest);
        Ok(Sampling { first, replicate, most: (limit - limit % replicate).max(first) })
    }
}
