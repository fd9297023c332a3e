//! The report of a search for the best design: convergence, Pareto front, sensitivities, and the best design.
//!
//! Read `data` first, then `designs`, which says how figures show designs. `over_variables`, `parallel` and `indices` are
//! figures, and `figures` lists all of them. `notes` are sentences.

mod data;
mod designs;
mod figures;
mod indices;
mod notes;
mod over_variables;
mod parallel;

pub use data::OptimumData;
pub use figures::of_search;
pub use notes::notes;
