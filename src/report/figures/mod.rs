//! The figures of results: each made from what has been gathered, and drawn elsewhere.

mod amplitudes;
mod basins;
mod branches;
mod doubt;
pub mod equilibrium_set;
mod fractions;
mod frictionless;
mod layers;
mod map;
mod motion;
mod preferred;
mod rest;
mod sets;
mod surface;
mod sweep_axis;

pub use frictionless::branches;
pub use layers::{failed as failed_runs, label_words, significant};
pub use motion::motion;
pub use sets::sets;

use super::chart::Figure;
use super::gathered::Gathered;

/// All figures that these results can show, in reading order.
pub fn of_results(gathered: &Gathered<'_>) -> Vec<Figure> {
    let figures = [
        preferred::figure(gathered),
        fractions::figure(gathered),
        map::figure(gathered),
        rest::figure(gathered),
        amplitudes::figure(gathered),
        basins::figure(gathered),
        branches::figure(gathered),
        doubt::figure(gathered),
    ];
    figures.into_iter().flatten().collect()
}
