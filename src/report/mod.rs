//! A recorded run for the eye: a figure and an animation, the same bytes for the same data.

mod animation;
pub mod chart;
mod course;
mod figure;

pub use animation::{animation, frames};
pub use figure::{FigureError, figure};
