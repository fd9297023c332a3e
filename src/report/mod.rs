//! Results for the eye: figures and the page of a directory, and the pictures of a recorded run; the same
//! bytes for the same data.

pub mod chart;
pub mod contour;
pub mod figures;
mod gathered;
mod page;
mod replay;

pub use figures::of_results;
pub use gathered::{Budget, Gathered};
pub use page::{OWN, page};
pub use replay::{FigureError, animation, figure, frames, time_text};
