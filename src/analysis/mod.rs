//! Statistics of outcomes: confidence intervals, time to rest, classes of limit cycles, and summaries of sweep points.
//!
//! This module reads outcomes and returns numbers; it does not depend on any file format.
//!
//! Read `interval` first, then `observed`, which is a run as statistics see it. `value_counts`, `summary_statistics`
//! and `angle_set` collect values in bounded memory. The statistics of a point follow: `survival` with `rest_curve` and
//! `escape`, `cycle_class` with `cycles`, `stratified`, `basin_entropy` and `residual_vibration`. `point_summary`
//! combines them, and `stopping` decides whether a point needs more runs. `estimates` are the responses of designs.
//!
//! The closed forms of balls at rest begin with two files: `rest_form` has the parameters of a machine, and `touching`
//! decides which positions of touching balls are possible. `one_ball` gives the exact equilibrium set of one ball. For
//! more balls, `set_grid` or `set_samples` finds the set. The equilibria without friction build on `balance`,
//! `on_a_line` and `linearised`; `frictionless` combines these. `set_extremes` and `climb` find the amplitudes in the
//! set, and `equilibrium_set` combines everything about it. `run_up` stands alone. The other files are helpers of
//! these; read them where they are imported.

mod angle_set;
mod balance;
mod basin_entropy;
mod climb;
mod cycle_class;
mod cycles;
mod equilibrium_histogram;
mod equilibrium_set;
mod escape;
mod estimates;
mod frictionless;
mod frictionless_position;
mod identical_balls;
mod interval;
mod linearised;
mod observed;
mod on_a_line;
mod one_ball;
mod point_summary;
mod rank_correlation;
mod residual_vibration;
mod resolution;
mod rest_curve;
mod rest_form;
mod run_up;
mod set_components;
mod set_extremes;
mod set_grid;
mod set_samples;
mod stopping;
mod stratified;
mod summary_statistics;
mod survival;
mod touching;
mod value_counts;

pub use balance::Balance;
pub use basin_entropy::Basins;
pub use cycle_class::{CycleClass, Role};
pub use cycles::{CycleGroup, CycleRange, CycleRole};
pub use equilibrium_histogram::{BINS, EquilibriumHistogram, HistogramBin, bin, bin_edges};
pub use equilibrium_set::{EquilibriumSet, Resolution, set_fraction};
pub use escape::{EscapeRate, escape_rate, rate_interval};
pub use estimates::{
    Estimate, Measure, RunResult, Sample, above, at_rest_by, estimate_difference, estimate_ratio,
    mean, median_time_to_rest, quantile, standard_deviation, worst,
};
pub use frictionless::{FrictionlessEquilibrium, HIGH_DRAG, frictionless_equilibria};
pub use frictionless_position::FrictionlessKind;
pub use identical_balls::{groups_of_identical, sorted_where_identical};
pub(crate) use interval::interval_ranks;
pub use interval::{
    ConfidenceInterval, IntervalMethod, Z_95, simultaneous, wilson, wilson_with_failures,
};
pub use linearised::{SmallMotions, Stability, state_matrix};
pub use observed::{AuditCounts, FailureCounts, LabelCounts, ObservedRun};
pub use point_summary::{PointAccumulator, PointDetail, PointSummary};
pub use rank_correlation::{RankCorrelation, rank_correlation};
pub use residual_vibration::{
    ResidualVibration, balance_quality_grade, reference_amplitude, relative_amplitude,
    residual_imbalance, residual_imbalance_vector,
};
pub use resolution::{FEWEST_GRID_POINTS, MOST_BALL_DAMPING, Resolutions, SAMPLE_COUNTS};
pub use rest_curve::{RestStep, rest_curve};
pub use rest_form::{AtRest, RestForm};
pub use run_up::{RunUp, run_ups};
pub use set_components::SetRuns;
pub use set_extremes::amplitude_extremes;
pub use set_grid::{GridRow, GridSummary, SetGrid};
pub use set_samples::{REPLICATES, sample};
pub(crate) use set_samples::{coordinate as sample_coordinate, fraction_with_interval};
pub use stopping::{HalfWidths, StoppingRule};
pub use stratified::StratifiedCells;
pub(crate) use survival::rest_or_stop_time;
pub use survival::{SurvivalCurve, SurvivalStep};
pub use touching::{overlaps, touching_set_fraction};
pub use value_counts::ValueCounts;
pub(crate) use value_counts::interpolated_quantile;
