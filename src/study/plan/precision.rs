//! The requested precision of the fraction of equilibria and of amplitudes, and the number of runs per point.

use crate::study::error::{Fault, StudyError};
use crate::study::file::study_file::PrecisionFile;
use crate::study::file::yaml_tree::{Source, describe_number};
use crate::study::sampling::sampling_design::Design;

/// Sequential sampling: each point receives whole replicates of its design until the fraction of
/// equilibria and the quantiles of the amplitude are known to this precision.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Precision {
    /// Half width of the fraction's 95 % confidence interval at which sampling stops, above 0 and
    /// below 0.5; `None` if the fraction does not matter.
    pub equilibrium_fraction: Option<f64>,
    /// Half widths of the 95 % confidence intervals of the amplitude's quantiles 5, 50 and 95 %, m, likewise.
    pub amplitude_m: [Option<f64>; 3],
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
    /// Returns an error if there is no half width, if that of the fraction is not above 0 and below 0.5, or if that of an
    /// amplitude is not above 0.
    pub(in crate::study) fn resolve(
        source: &Source,
        written: Option<&PrecisionFile>,
    ) -> Result<Option<Precision>, StudyError> {
        let Some(file) = written.copied() else { return Ok(None) };
        let PrecisionFile { equilibrium_fraction, max_runs, .. } = file;
        let amplitude_m = [file.amplitude_p05_m, file.amplitude_p50_m, file.amplitude_p95_m];
        let path = source.path("precision");
        let refuse = |key: &str, half_width: f64, range: &str| {
            let allowed = format!("half the width of the confidence interval, {range}");
            let fault = Fault::new("not a half width", describe_number(half_width), allowed);
            Err(path.key(key).refuse_value(fault))
        };
        match equilibrium_fraction {
            Some(half) if !(0.0 < half && half < 0.5) => {
                let range = "above 0 and below 0.5, such as 0.02";
                return refuse("equilibrium_fraction", half, range);
            }
            None if amplitude_m == [None; 3] => {
                let allowed = "at least one half width, such as equilibrium_fraction: 0.02 or \
                               amplitude_p95_m: 1.0e-6";
                let fault = Fault::new("no interval", "only max_runs", allowed);
                return Err(path.refuse_value(fault));
            }
            _ => {}
        }
        for (half, name) in amplitude_m.into_iter().zip(Precision::AMPLITUDES) {
            if let Some(half) = half.filter(|half| *half <= 0.0) {
                return refuse(name, half, "above 0, such as 1.0e-6");
            }
        }
        Ok(Some(Precision { equilibrium_fraction, amplitude_m, max_runs: max_runs.0 }))
    }

    /// The columns whose intervals [`Precision::amplitude_m`] limits.
    pub const AMPLITUDES: [&'static str; 3] =
        ["amplitude_p05_m", "amplitude_p50_m", "amplitude_p95_m"];

    /// Returns the half widths by column, with their units.
    pub fn half_widths(&self) -> Vec<(&'static str, f64, &'static str)> {
        let fraction = self.equilibrium_fraction.map(|half| ("equilibrium_fraction", half, ""));
        let amplitudes = Precision::AMPLITUDES.into_iter().zip(self.amplitude_m);
        let amplitudes = amplitudes.filter_map(|(name, half)| Some((name, half?, " m")));
        fraction.into_iter().chain(amplitudes).collect()
    }

    /// Returns what is narrow enough, in words.
    pub fn in_words(&self) -> String {
        if let (Some(half), [None, None, None]) = (self.equilibrium_fraction, self.amplitude_m) {
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
