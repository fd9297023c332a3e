//! The report page and the animation of a replayed run. Equal data give equal bytes.

mod animation;
pub mod chart;
mod data;
mod figures;
mod optimum;
mod packed;
mod page;

pub use animation::{animation, frames, time_text};
pub use data::{Budget, Fraction, IncompletePoints, PointFacts, ReportData, ResultTables};
pub use figures::of_results;
pub use optimum::{OptimumData, notes, of_search};
pub use page::{OWN, optimum_page, page};
