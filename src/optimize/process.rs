//! Gaussian processes with Matérn 5/2 kernels (egobox): those that choose designs, and smooth approximations of responses.
//!
//! To choose designs there is one process per quantity on its own scale, with a constant mean. The search for
//! hyperparameters takes most of the time of a fit. A process with given hyperparameters needs a single matrix
//! factorisation.
//!
//! A response is approximated between designs by a process whose inducing points are the designs themselves, which gives
//! the full process with noise. The noise is estimated, bounded by the responses' own standard errors: designs share
//! start states and draws, so that a part of these errors is common to all designs and is not noise between them.

use egobox_gp::correlation_models::Matern52Corr;
use egobox_gp::mean_models::ConstantMean;
use egobox_gp::{
    GaussianProcess, Inducings, ParamTuning, SgpParams, SparseGaussianProcess, SparseMethod,
    ThetaTuning,
};
use linfa::Dataset;
use linfa::traits::Fit;
use ndarray::{Array1, Array2, ArrayView2};
use serde_json::{Value, json};

use super::goal::Goal;
use crate::engine::quietly;

/// Ratio of the largest to the smallest value from which the scale is logarithmic.
const DECADE: f64 = 10.0;

/// A monotonically increasing scale.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(super) enum QuantityScale {
    Linear,
    Logarithmic,
}

impl QuantityScale {
    /// Returns the scale for the values of a quantity, given by its index in the goal.
    pub fn new(goal: &Goal, quantity: usize, values: &[f64]) -> QuantityScale {
        let least = values.iter().copied().fold(f64::INFINITY, f64::min);
        let most = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let mut limits = goal.limits.iter().filter(|(index, _)| *index == quantity);
        let positive = least > 0.0 && limits.all(|(_, limit)| limit.value > 0.0);
        match positive && most > DECADE * least {
            true => QuantityScale::Logarithmic,
            false => QuantityScale::Linear,
        }
    }

    /// Returns a value on the scale.
    pub fn scaled(self, value: f64) -> f64 {
        match self {
            QuantityScale::Linear => value,
            QuantityScale::Logarithmic => value.ln(),
        }
    }

    /// Returns the value at a place on the scale.
    pub fn raw(self, scaled: f64) -> f64 {
        match self {
            QuantityScale::Linear => scaled,
            QuantityScale::Logarithmic => scaled.exp(),
        }
    }

    /// Returns a standard error on the scale, to first order.
    pub fn scaled_error(self, value: f64, error: f64) -> f64 {
        match self {
            QuantityScale::Linear => error,
            QuantityScale::Logarithmic => error / value,
        }
    }
}

/// A quantity of all designs of a search, on its own scale.
pub(super) struct ScaledQuantity {
    pub scale: QuantityScale,
    /// One value per design.
    pub values: Vec<f64>,
    /// Typical variance of the noise of a value.
    pub noise: f64,
}

/// Least noise relative to the variance of the process, which keeps matrices regular.
const LEAST_NOISE: f64 = 1e-8;
/// Noise variances that a fit tries, relative to the largest possible one. The least one keeps a group of very similar
/// designs, which share all draws, from appearing free of noise.
const NOISES: [f64; 4] = [0.03, 0.1, 0.3, 1.0];
/// Inverse length scale at which the first search for hyperparameters begins, for coordinates of variance 1.
const FIRST_THETA: f64 = 0.1;
/// Bounds of inverse length scales.
const THETAS: (f64, f64) = (1e-2, 1e1);
/// Number of further starting points of the first search for hyperparameters. A later search starts from the
/// hyperparameters of the search before.
const STARTS: usize = 4;

/// Parameters of a process that do not depend linearly on its values.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Hyperparameters {
    /// Inverse length scale of each coordinate.
    theta: Array1<f64>,
    /// Variance of the noise relative to the variance of the process.
    noise: f64,
}

impl Hyperparameters {
    /// Returns the most likely hyperparameters of values at these coordinates, one row per design, whose noise has at
    /// most this variance. Returns `None` if the library cannot fit them.
    pub fn fit(
        coordinates: &Array2<f64>,
        values: &[f64],
        most_noise: f64,
        before: Option<&Hyperparameters>,
    ) -> Option<Hyperparameters> {
        let first = Array1::from_elem(coordinates.ncols(), FIRST_THETA);
        let Some((_, variance)) = moments(values) else {
            return Some(Hyperparameters { theta: first, noise: LEAST_NOISE });
        };
        let most = (most_noise / variance).clamp(10.0 * LEAST_NOISE, 1.0);
        let noise = before.map_or(0.1 * most, |before| before.noise.min(most));
        let theta = before.map_or(first, |before| before.theta.clone());
        let starts = if before.is_some() { 0 } else { STARTS };
        let bounds = Array1::from_elem(1, THETAS);
        let tuning = ThetaTuning::Full { init: theta.mapv(within_bounds), bounds };
        let fitted = process(coordinates, values, tuning, noise, starts)?;
        let theta = fitted.theta().mapv(within_bounds);
        let likelihood = |noise: f64| {
            let fixed = ThetaTuning::Fixed(theta.clone());
            let likelihood = process(coordinates, values, fixed, noise, 0)?.likelihood();
            likelihood.is_finite().then_some((likelihood, noise))
        };
        let noises = NOISES.iter().map(|fraction| (fraction * most).max(LEAST_NOISE));
        let best = noises.filter_map(likelihood).max_by(|left, right| left.0.total_cmp(&right.0));
        Some(Hyperparameters { theta, noise: best.map_or(noise, |(_, noise)| noise) })
    }

    /// Returns the values without their noise: predictions at the coordinates of the values themselves.
    pub fn smooth(&self, coordinates: &Array2<f64>, values: &[f64]) -> Option<Vec<f64>> {
        let fixed = ThetaTuning::Fixed(self.theta.clone());
        let process = process(coordinates, values, fixed, self.noise, 0)?;
        let smooth = quietly(|| process.predict(coordinates).ok())??.to_vec();
        smooth.iter().all(|value| value.is_finite()).then_some(smooth)
    }
}

/// Returns mean and variance of values; `None` if all values are equal, or if one is not a number.
fn moments(values: &[f64]) -> Option<(f64, f64)> {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let variance = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / count;
    (variance.sqrt() > 1e-12 * mean.abs()).then_some((mean, variance))
}

fn within_bounds(theta: f64) -> f64 {
    theta.clamp(THETAS.0, THETAS.1)
}

type Process = GaussianProcess<f64, ConstantMean, Matern52Corr>;

/// Fits a process; `noise` is relative to its variance. Returns `None` if the library cannot fit it.
fn process(
    coordinates: &Array2<f64>,
    values: &[f64],
    tuning: ThetaTuning<f64>,
    noise: f64,
    starts: usize,
) -> Option<Process> {
    let data = Dataset::new(coordinates.clone(), Array1::from(values.to_vec()));
    let fit = || {
        Process::params(ConstantMean::default(), Matern52Corr::default())
            .theta_tuning(tuning)
            .n_start(starts)
            .nugget(noise)
            .fit(&data)
    };
    // After a panic the library's objects are not used again.
    quietly(fit)?.ok()
}

/// A process through the values of designs.
pub(super) struct Interpolation(Process);

impl Interpolation {
    /// Returns the process through these values, with these hyperparameters but without noise.
    pub fn new(
        coordinates: &Array2<f64>,
        values: &[f64],
        hyperparameters: &Hyperparameters,
    ) -> Option<Interpolation> {
        // A matrix that is nearly singular needs a little noise.
        [LEAST_NOISE, 1e-6, 1e-4].into_iter().find_map(|noise| {
            let fixed = ThetaTuning::Fixed(hyperparameters.theta.clone());
            process(coordinates, values, fixed, noise, 0).map(Interpolation)
        })
    }

    /// Returns mean and standard deviation at each of these coordinates.
    pub fn predict(&self, coordinates: &ArrayView2<f64>) -> Option<Vec<(f64, f64)>> {
        let (means, variances) = quietly(|| self.0.predict_valvar(coordinates).ok())??;
        let both = means.iter().zip(&variances);
        Some(both.map(|(mean, variance)| (*mean, variance.max(0.0).sqrt())).collect())
    }
}

/// Number of starting points of the search for the kernel's length scales.
const SURROGATE_STARTS: usize = 2;

/// An approximation of a response.
pub struct Surrogate {
    process: SparseGaussianProcess<f64, Matern52Corr>,
    mean: f64,
    scale: f64,
}

impl Surrogate {
    /// Fits values to the coordinates of their designs, with at most this variance of noise.
    ///
    /// # Errors
    /// Returns the reason if all values are equal, or if the library cannot fit them.
    pub fn fit(
        coordinates: &[Vec<f64>],
        values: &[f64],
        noise: f64,
        seed: u64,
    ) -> Result<Self, String> {
        let (mean, variance) = moments(values).ok_or("all values are equal")?;
        let scale = variance.sqrt();
        let x = table(coordinates)?;
        let y: Array1<f64> = values.iter().map(|value| (value - mean) / scale).collect();
        let most = (noise / variance).clamp(10.0 * LEAST_NOISE, 1.0);
        let noise = ParamTuning::Optimized {
            init: (most * LEAST_NOISE).sqrt(),
            bounds: (LEAST_NOISE, most),
        };
        let fit = || {
            SgpParams::new(Matern52Corr::default(), Inducings::Located(x.clone()))
                .sparse_method(SparseMethod::Fitc)
                .noise_variance(noise)
                .n_start(SURROGATE_STARTS)
                .seed(Some(seed))
                .fit(&Dataset::new(x.clone(), y))
        };
        // After a panic the library's objects are not used again.
        let process = quietly(fit).ok_or_else(|| "the fit failed".to_owned())?;
        let process = process.map_err(|error| format!("the fit failed: {error}"))?;
        Ok(Surrogate { process, mean, scale })
    }

    /// Returns the approximation for designs with these coordinates.
    ///
    /// # Errors
    /// Returns an error if the coordinates differ in number from the fitted ones, or if a value is not finite.
    pub fn predict(&self, coordinates: &[Vec<f64>]) -> Result<Vec<f64>, String> {
        let predicted =
            self.process.predict(&table(coordinates)?).map_err(|error| error.to_string())?;
        let values: Vec<f64> = predicted.iter().map(|y| self.mean + self.scale * y).collect();
        if values.iter().all(|value| value.is_finite()) {
            return Ok(values);
        }
        Err("values that are not finite".to_owned())
    }

    /// Returns the standard deviation of the noise, in the response's unit.
    pub fn noise(&self) -> f64 {
        self.scale * self.process.noise_variance().sqrt()
    }

    /// Returns the complete state of the surrogate.
    pub fn state(&self) -> Value {
        json!({
            "mean": self.mean,
            "scale": self.scale,
            "noise": self.noise(),
            // Serializing numbers and lists cannot fail.
            "process": serde_json::to_value(&self.process).unwrap_or(Value::Null),
        })
    }
}

pub(super) fn table(rows: &[Vec<f64>]) -> Result<Array2<f64>, String> {
    let width = rows.first().map_or(0, Vec::len);
    let flat: Vec<f64> = rows.iter().flatten().copied().collect();
    Array2::from_shape_vec((rows.len(), width), flat).map_err(|error| error.to_string())
}
