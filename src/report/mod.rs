//! Results for the eye: the report page, and the animation of a replayed run. The same data give the same bytes.

mod animation;
pub mod chart;
mod data;
mod figures;
mod page;

pub use animation::{animation, frames, time_text};
pub use data::{Budget, ReportData, ResultTables};
pub use figures::of_results;
pub use page::{OWN, page};
