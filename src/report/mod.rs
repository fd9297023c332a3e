//! A recorded run for the eye: a figure and an animation, the same bytes for the same data.

mod animation;
pub mod chart;
pub mod contour;
mod course;
mod figure;
pub mod figures;
mod gathered;
mod page;

pub use animation::{animation, frames};
pub use figure::{FigureError, figure};
pub use figures::of_results;
pub use gathered::{Budget, Gathered};
pub use page::{OWN, page};
