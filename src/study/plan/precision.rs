//! What a study asks beyond its design: more runs at each point until intervals are narrow, and the recomputation of some.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::study::error::{Fault, StudyError, describe_number};
use crate::study::file::source::Source;
use crate::study::file::values::Count;
use crate::study::plan::parameter::{Parameter, ParameterValue};
use crate::study::sampling::draw::DrawKey;
use crate::study::sampling::sampling_design::{Design, SampleId};

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
            return Err(Fault::new(
                "a design that cannot be enlarged",
                design.layout.kind(),
                allowed,
            ));
        };
        let limit = precision.max_runs.0.min(own_longest).min(longest);
        Ok(Sampling { first, replicate, most: (limit - limit % replicate).max(first) })
    }
}

/// Recomputation of randomly chosen runs by the other method, with a tenth of both tolerances; it
/// measures how often the label depends on the computation.
// A run is selected if a uniform random number is below the fraction. The number is keyed by the
// swept values of the point, the cell and the replicate. More samples, more points or a larger
// fraction therefore keep all earlier selections, and each point has its own selection.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "AuditFile")]
pub struct Audit {
    /// Fraction of the runs that are recomputed, above 0 and at most 1.
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1))]
    pub fraction: f64,
}

impl Audit {
    /// Returns whether the audit selects a sample at the point with these swept values.
    pub(in crate::study) fn chooses(
        self,
        seed: u64,
        swept: &[(Parameter, ParameterValue)],
        id: SampleId,
    ) -> bool {
        let key = DrawKey::new(seed, "audit", &name(swept));
        key.uniform(id.cell, id.replicate) < self.fraction
    }
}

/// Returns the swept values of a point as text that does not depend on the order of the sweep.
fn name(swept: &[(Parameter, ParameterValue)]) -> String {
    let text = |(parameter, value): &(Parameter, ParameterValue)| match value {
        // Adding 0 turns -0 into 0; the exponent form keeps every digit.
        ParameterValue::Number(number) => format!("{}={:e}", parameter.name(), number + 0.0),
        ParameterValue::Text(word) => format!("{}={word}", parameter.name()),
    };
    let mut values: Vec<String> = swept.iter().map(text).collect();
    values.sort_unstable();
    values.join(",")
}
