//! A smooth approximation of a response between designs.
//!
//! A Gaussian process with a Matérn 5/2 kernel (egobox) whose inducing points are the designs themselves, which gives
//! the full process with noise. The noise is estimated, bounded by the responses' own standard errors: designs share
//! start states and draws, so that a part of these errors is common to all designs and is not noise between them.

use egobox_gp::correlation_models::Matern52Corr;
use egobox_gp::{Inducings, ParamTuning, SgpParams, SparseGaussianProcess, SparseMethod};
use linfa::Dataset;
use linfa::traits::Fit;
use ndarray::{Array1, Array2};
use serde_json::{Value, json};

use crate::engine::quietly;

/// Least noise relative to the variance of the values, which keeps matrices regular.
const LEAST_NOISE: f64 = 1e-8;
/// Number of starting points of the search for the kernel's length scales.
const STARTS: usize = 2;

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
        let count = values.len() as f64;
        let mean = values.iter().sum::<f64>() / count;
        let variance = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / count;
        let scale = variance.sqrt();
        if scale.is_nan() || scale <= 1e-12 * mean.abs() {
            return Err("all values are equal".to_owned());
        }
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
                .n_start(STARTS)
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
