//! Results and runs for the eye, on paper, on a page and moving: the same bytes for the same data.

mod animation;
pub mod chart;
pub mod contour;
mod course;
mod figure;
pub mod figures;
mod gathered;
mod page;
pub mod paper;

pub use animation::{animation, frames};
pub use figure::{FigureError, figure};
pub use figures::of_results;
pub use gathered::{Budget, Gathered, heading};
pub use page::{OWN, page};
