//! Intervals and estimates with their coverage, summaries of points, classes of limit cycles, and
//! equilibrium sets against closed forms and the thesis.

mod audit;
mod balance_quality;
mod balanced_rotor;
mod basin_entropy;
pub mod cycle_classes;
mod cycle_groups;
mod equilibrium_histogram;
mod escape;
mod frictionless;
mod identical_balls;
mod interval;
mod linearised;
mod overlap;
mod point_summary;
mod rank_correlation;
mod reference_amplitude;
mod residual_vibration;
mod rest_curve;
mod run_up;
mod set_components;
mod set_extremes;
mod set_samples;
mod sets;
mod stopping;
mod stratified;
mod survival;
mod touching;
mod value_counts;
