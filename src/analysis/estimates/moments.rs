//! The mean of a sample with its standard error, within cells if the design is stratified.
//!
//! Cells of equal size have equal weight, and only the variation within cells contributes to the variance of the
//! mean. With `H` cells and `n_h` values of variance `s_h²` in each,
//!
//! ```text
//! mean = Σ mean_h / H,   V = Σ s_h² / n_h / H²
//! ```
//!
//! with Satterthwaite's degrees of freedom (W. G. Cochran, Sampling Techniques, 3rd ed., Wiley 1977,
//! sections 5.4 and 5.16). If a cell has fewer than two values, the runs are treated as unstratified, which gives
//! conservative intervals.

use statrs::distribution::{ContinuousCDF, StudentsT};

/// Returns the number that the absolute value of a Student variable with this many degrees of freedom exceeds with a
/// probability of 0.05. Degrees of freedom are rounded down to a whole number, at least 1, which gives conservative
/// intervals.
pub(super) fn student_95(degrees: f64) -> f64 {
    StudentsT::new(0.0, 1.0, degrees.floor().max(1.0))
        .map_or(f64::INFINITY, |student| student.inverse_cdf(0.975))
}

/// A mean with its variance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Mean {
    /// The mean.
    pub value: f64,
    /// Variance of the mean; `None` for a single value.
    pub variance: Option<f64>,
    /// Degrees of freedom of that variance.
    pub degrees: f64,
}

/// Estimates the mean of values, each given with its cell; `cells` is the number of cells.
pub(super) fn mean(values: &[(u64, f64)], cells: Option<u64>) -> Option<Mean> {
    if values.is_empty() {
        return None;
    }
    let by_cell = cells.and_then(|cells| in_cells(values, cells));
    Some(by_cell.map_or_else(|| unstratified(values), |cells| stratified(&cells)))
}

/// Returns the values of each cell, if every cell has at least two.
fn in_cells(values: &[(u64, f64)], cells: u64) -> Option<Vec<Vec<f64>>> {
    if cells < 2 || 2 * cells > values.len() as u64 {
        return None;
    }
    let mut all = vec![Vec::new(); usize::try_from(cells).ok()?];
    for (cell, value) in values {
        all.get_mut(usize::try_from(*cell).ok()?)?.push(*value);
    }
    all.iter().all(|cell| cell.len() >= 2).then_some(all)
}

/// Returns number, mean and variance.
fn moments(values: impl Iterator<Item = f64> + Clone) -> (f64, f64, f64) {
    let n = values.clone().count() as f64;
    let mean = values.clone().sum::<f64>() / n;
    let squares: f64 = values.map(|value| (value - mean) * (value - mean)).sum();
    (n, mean, squares / (n - 1.0))
}

fn unstratified(values: &[(u64, f64)]) -> Mean {
    let (n, value, variance) = moments(values.iter().map(|(_, value)| *value));
    Mean { value, variance: (n > 1.5).then_some(variance / n), degrees: n - 1.0 }
}

fn stratified(cells: &[Vec<f64>]) -> Mean {
    let weight = 1.0 / cells.len() as f64;
    let (mut value, mut variance, mut squares) = (0.0, 0.0, 0.0);
    for cell in cells {
        let (n, mean, cell_variance) = moments(cell.iter().copied());
        let part = weight * weight * cell_variance / n;
        value += weight * mean;
        variance += part;
        squares += part * part / (n - 1.0);
    }
    // Without variation the degrees of freedom do not matter.
    let degrees = if squares > 0.0 { variance * variance / squares } else { f64::MAX };
    Mean { value, variance: Some(variance), degrees }
}
