//! Data of the figures of a report.

mod animation;
mod campbell;
/// Rank correlations and amplitudes over uncertain parameters.
mod drawn;
/// The equilibrium set behind the rest positions.
mod equilibrium_set;
/// The page of a search.
mod optimum;
/// Balls with contact: where they would overlap, and rests that touch.
mod overlap;
/// Rest positions of the balls.
mod preferred;
/// A disc that starts.
mod run_up;
/// Cells of maps, and points in detail.
mod sweeps;
/// Residual vibration, and vibration without balls.
mod vibration;

use stickslip::report::chart::Figure;
use stickslip::report::{Budget, ReportData, ResultTables};
use stickslip::study::Study;
use stickslip::table::Manifest;

use crate::cli::support::Scratch;

fn figure_of<'a>(figures: &'a [Figure], id: &str) -> &'a Figure {
    figures.iter().find(|figure| figure.id == id).unwrap_or_else(|| panic!("no figure {id}"))
}

/// Computes the study in `file` into `out`, and returns it with what `of` makes of the data of its report.
fn reported<T>(
    scratch: &Scratch,
    file: &str,
    budget: Budget,
    of: impl FnOnce(&ReportData<'_>) -> T,
) -> (Study, T) {
    scratch.well(&format!("run {file} --out out --quiet"));
    let directory = scratch.path("out");
    let manifest = Manifest::read(&directory).unwrap().unwrap();
    let study = Study::load(&directory.join("study.yaml")).unwrap();
    let tables = ResultTables::open(&directory, &manifest).unwrap();
    let data = ReportData::read(&tables, &study, &manifest, budget, None);
    let made = of(&data.expect("the tables were just written"));
    (study, made)
}
