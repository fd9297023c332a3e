//! The densities of all measured runs for one parameter set.

use super::density::Rests;
use super::site::{MeasuredRest, Site};
use super::smoother::SetWeight;
use crate::numbers::counted;

/// The bandwidth of the kernels over the standard deviation of a measured angle: it adds 4 % to the variance.
const BANDWIDTH: f64 = 0.2;

/// The largest number of densities of all parameter sets; they take 2 GiB of memory.
const MOST_DENSITIES: u64 = 1 << 28;
/// The number of densities of a parameter set at a site besides those of measured rests: of references, and for the choice of the
/// regression's widths.
const OF_SITE: u64 = 600;

/// Checks that the densities of all measured rests for this many parameter sets fit into memory.
///
/// # Errors
/// Returns a sentence with the remedy if there are too many.
pub fn check_memory(sites: &[Site], designs: u64) -> Result<(), String> {
    let rests: u64 = sites.iter().map(|site| site.rests.len() as u64).sum();
    let others = OF_SITE * sites.len() as u64;
    let most = MOST_DENSITIES / designs.max(1);
    if rests + others <= most {
        return Ok(());
    }
    let (places, most) = (counted(sites.len() as u64, "point"), most.saturating_sub(others));
    Err(format!(
        "the densities of so many measured rests do not fit into memory\n  found:   {rests} rests at {places}, and {designs} \
         parameter sets\n  allowed: at most {most} rests; fewer rests or points, or fewer parameter sets (identify.designs)"
    ))
}

/// The densities of the measured runs at a site for one parameter set.
#[derive(Clone, Debug, PartialEq)]
pub struct SetDensities {
    /// The number of simulated runs.
    pub runs: usize,
    /// The probability density of each measured position of rest.
    pub rests: Vec<f64>,
    /// The probability of motion.
    pub moving: f64,
}

impl SetDensities {
    /// Returns the densities of the measured runs at a site.
    pub fn at_site(site: &Site, rests: &Rests) -> Self {
        let over_all = |sum: f64| if rests.runs() > 0 { sum / rests.runs() as f64 } else { 0.0 };
        let of_run = |measured: &MeasuredRest| {
            let std_dev_rad = measured.std_dev_rad;
            let kernels = rests.kernels(&measured.angles, std_dev_rad, BANDWIDTH * std_dev_rad);
            over_all(kernels.iter().sum())
        };
        SetDensities {
            runs: rests.runs(),
            rests: site.rests.iter().map(of_run).collect(),
            moving: over_all(rests.moving as f64),
        }
    }
}

/// Returns the sums of the regression and of the plain mean over parameter sets, for each measured position.
pub fn sums_of_rests<'d>(
    sets: impl Iterator<Item = (SetWeight, &'d SetDensities)>,
) -> Vec<[f64; 2]> {
    let (mut regression, mut mean) = (Vec::new(), Vec::new());
    for (weight, densities) in sets {
        let rows = &densities.rests;
        // Two loops over contiguous numbers, which are computed in vectors.
        for (sums, weight) in [(&mut regression, weight.regression), (&mut mean, weight.mean)] {
            sums.resize(rows.len(), 0.0);
            for (sum, density) in sums.iter_mut().zip(rows) {
                *sum += weight * density;
            }
        }
    }
    regression.into_iter().zip(mean).map(|(regression, mean)| [regression, mean]).collect()
}

#[cfg(test)]
mod tests {
    use super::{MeasuredRest, Site, check_memory};

    #[test]
    fn too_many_rests_are_refused() {
        let sites = |count: usize| {
            let rests = vec![MeasuredRest { angles: Vec::new(), std_dev_rad: 0.1 }; count];
            [Site { point_id: 0, stage: 1, rests, moving: 0 }]
        };
        assert_eq!(check_memory(&sites(60_000), 4000), Ok(()));
        let refused = check_memory(&sites(250_000), 1250).expect_err("too many");
        for part in
            ["found:   250000 rests at 1 point, and 1250", "at most 214148 rests", "designs"]
        {
            assert!(refused.contains(part), "{refused}");
        }
    }
}
