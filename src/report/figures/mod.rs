//! The figures of a report, as data that the page's script draws.
//!
//! Read `layers` and `sweep_axis` first: what figures share, and the swept parameters as axes with panels over them. Each
//! other file has one or two figures or their background, and [`of_results`] lists all of them in reading order.

mod basins;
mod campbell;
mod drawn;
mod equilibrium_set;
mod exceedance;
mod fractions;
mod layers;
mod limit_cycles;
mod map;
mod overlap;
mod preferred;
mod run_up;
mod sweep_axis;
mod time_to_rest;
mod vibration;

pub use drawn::shown_parameters;
pub use layers::{BARS, PlottedEstimate, bars};

use super::chart::Figure;
use super::data::ReportData;

/// Returns all figures that these results allow, in reading order.
pub fn of_results(data: &ReportData<'_>) -> Vec<Figure> {
    // Over a single point, these would be curves of one dot; the table of points has their values.
    let several = |figure: fn(&ReportData<'_>) -> Option<Figure>| {
        (data.point_count > 1).then(|| figure(data)).flatten()
    };
    let figures = [
        several(vibration::figure),
        run_up::figure(data),
        exceedance::figure(data),
        drawn::correlations(data),
        drawn::amplitudes(data),
        map::figure(data),
        several(fractions::figure),
        time_to_rest::figure(data),
        preferred::figure(data),
        basins::figure(data),
        limit_cycles::figure(data),
        campbell::figure(data),
        fractions::diagnostics(data),
    ];
    figures.into_iter().flatten().collect()
}
