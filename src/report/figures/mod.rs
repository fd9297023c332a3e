//! The figures of a report, as data that the page's script draws.

mod amplitudes;
mod basins;
mod diagnostics;
mod equilibrium_set;
mod fractions;
mod layers;
mod limit_cycles;
mod map;
mod preferred;
mod sweep_axis;
mod time_to_rest;

pub use layers::{label_words, significant};

use super::chart::Figure;
use super::data::ReportData;

/// Returns all figures that these results allow, in reading order.
pub fn of_results(data: &ReportData<'_>) -> Vec<Figure> {
    let figures = [
        preferred::figure(data),
        fractions::figure(data),
        map::figure(data),
        time_to_rest::figure(data),
        amplitudes::figure(data),
        basins::figure(data),
        limit_cycles::figure(data),
        diagnostics::figure(data),
    ];
    figures.into_iter().flatten().collect()
}
