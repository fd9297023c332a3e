//! A recorded run for the eye: `replay.svg` and `replay.html`.

mod animation;
mod axis;
mod figure;
mod panel;
mod path;
mod quantity;

pub use animation::{animation, frames};
pub use axis::time_text;
pub use figure::{FigureError, figure};
