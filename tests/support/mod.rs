//! Random numbers and angles for tests of several folders.

mod angle;
mod test_rng;

pub use angle::angular_distance;
pub use test_rng::TestRng;
