//! Statistics of outcomes: intervals, time to rest, and what is known of a point of the sweep.
//!
//! Between endings and tables: it reads outcomes and writes numbers, and knows no file format.

mod equilibrium_set;
mod interval;
mod point_summary;
mod survival;
mod tally;

pub use equilibrium_set::set_fraction;
pub use interval::{Z_95, wilson, wilson_with_failures};
pub use point_summary::{LabelCounts, PointAccumulator, PointSummary};
pub use survival::SurvivalCurve;
pub use tally::Tally;
