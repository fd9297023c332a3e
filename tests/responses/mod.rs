//! Estimates of responses and their coverage, neighbouring designs, and common samples of designs.

mod amplitude;
mod common_samples;
mod discontinuity;
mod moments;
mod neighbours;
mod probability;
mod rest_time;
mod sample_quantile;
