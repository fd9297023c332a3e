//! The figures of results: each made from what has been gathered, and drawn elsewhere.

mod amplitudes;
mod basins;
mod branches;
mod diagnostics;
mod equilibrium_set;
mod fractions;
mod layers;
mod map;
mod preferred;
mod rest;
mod sweep_axis;

pub use layers::{failed as failed_runs, label_words, significant};

use super::chart::Figure;
use super::data::Gathered;

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
        diagnostics::figure(gathered),
    ];
    figures.into_iter().flatten().collect()
}
