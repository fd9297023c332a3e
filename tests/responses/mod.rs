//! Estimates of responses and their coverage, neighbouring designs, and common samples of designs.

mod amplitude;
mod common_samples;
mod discontinuity;
mod moments;
mod neighbours;
mod probability;
mod rest_time;
mod sample_quantile;

use stickslip::analysis::{RunResult, Sample};
use stickslip::classification::Label;

/// Returns runs with these amplitudes, which take turns in the cells; `None` is a failed run.
fn sample(amplitudes: &[Option<f64>], cells: Option<u64>) -> Sample {
    let run = |(index, amplitude): (usize, &Option<f64>)| RunResult {
        cell: index as u64 % cells.unwrap_or(1),
        label: if amplitude.is_some() { Label::Equilibrium } else { Label::Failed },
        amplitude: *amplitude,
        time_to_rest_s: None,
        end_time_s: None,
    };
    Sample { cells, runs: amplitudes.iter().enumerate().map(run).collect() }
}
