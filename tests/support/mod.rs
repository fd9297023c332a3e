//! Random numbers, angles, systems and an independent integration for tests of several folders.

mod angle;
mod assert_has;
mod block;
mod cases;
mod own_system;
mod places;
pub mod reference;
mod required_friction;
mod shipped;
mod studies;
mod systems;
mod test_rng;
mod two_blocks;
mod unit_kind;

pub use angle::angular_distance;
pub use assert_has::assert_has;
pub use block::{Block, Ground};
pub use cases::{cases, rows};
pub use own_system::OwnSystem;
pub use places::places;
pub use required_friction::{required_friction, rest_margin};
pub use shipped::{shipped, shipped_study, study_files};
pub use studies::{balancer_of_a_file, cases_of, parse};
pub use systems::{
    METHODS, example_law, for_each_kernel, go_on, settings, shared, spread_start, start_of,
    started, state_of,
};
pub use test_rng::TestRng;
pub use two_blocks::TwoBlocks;
pub use unit_kind::{UnitKind, numbered_contacts, simulate_kind, unit_kind};
