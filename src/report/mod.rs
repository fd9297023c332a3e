//! Results and runs for the eye, on paper, on a page and moving: the same bytes for the same data.

pub mod chart;
pub mod contour;
mod course;
pub mod figures;
mod gathered;
mod page;
pub mod paper;
mod replay;

pub use figures::of_results;
pub use gathered::{Budget, Gathered, ResultTables, heading};
pub use page::{OWN, page};
pub use replay::{FigureError, animation, figure, frames, time_text};
