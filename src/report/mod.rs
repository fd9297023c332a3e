//! A recorded run for the eye: a figure and an animation, the same bytes for the same data.

mod animation;
pub mod chart;

mod course;
mod figure;
mod figures;
mod gathered;
mod page;

pub use animation::{animation, frames};
pub use figure::{FigureError, figure};
pub use figures::of_results;
pub use gathered::Gathered;
pub use page::{OWN, page};
