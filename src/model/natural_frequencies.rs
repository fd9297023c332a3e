//! The equations of small motions of a model, and their natural frequencies.

use nalgebra::{DMatrix, Schur};
use serde::Serialize;

/// The matrices of the equations of first order of small motions about the middle of the start ranges, in SI units: values and
/// rates of change of the coordinates that move.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SmallMotionEquations {
    /// Of the coordinates that no contact moves, while the others keep their values; `None` without such coordinates, and for a
    /// matrix that changes with time.
    pub held: Option<DMatrix<f64>>,
    /// Of all coordinates while no contact has friction; `None` without contacts, and for a matrix that changes with time.
    pub free: Option<DMatrix<f64>>,
}

/// The natural frequencies of small motions with their damping, in ascending order.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct NaturalFrequencies {
    /// Those of [`SmallMotionEquations::held`], rad/s.
    pub held_rad_s: Option<Vec<f64>>,
    /// Those of [`SmallMotionEquations::free`], rad/s.
    pub free_rad_s: Option<Vec<f64>>,
}

impl SmallMotionEquations {
    /// Returns the natural frequencies.
    pub fn natural_frequencies(&self) -> NaturalFrequencies {
        let of = |matrix: &Option<DMatrix<f64>>| frequencies(matrix.clone()?);
        NaturalFrequencies { held_rad_s: of(&self.held), free_rad_s: of(&self.free) }
    }
}

impl NaturalFrequencies {
    /// Returns the frequencies while contacts hold or, without such ones, those without friction.
    pub fn first_rad_s(&self) -> &[f64] {
        self.held_rad_s.as_ref().or(self.free_rad_s.as_ref()).map_or(&[], Vec::as_slice)
    }
}

/// Motions with a frequency below this, over the largest eigenvalue, do not oscillate.
const OSCILLATES: f64 = 1e-6;

/// Returns the imaginary parts of the eigenvalues above the real axis, in ascending order; `None` if they cannot be computed.
pub(super) fn frequencies(matrix: DMatrix<f64>) -> Option<Vec<f64>> {
    let eigenvalues = Schur::try_new(matrix, f64::EPSILON, 10_000)?.complex_eigenvalues();
    let least = OSCILLATES * eigenvalues.iter().map(|value| value.norm()).fold(0.0, f64::max);
    let oscillating = eigenvalues.iter().map(|value| value.im).filter(|value| *value > least);
    let mut frequencies: Vec<f64> = oscillating.collect();
    frequencies.sort_by(f64::total_cmp);
    Some(frequencies)
}
