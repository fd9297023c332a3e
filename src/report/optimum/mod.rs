//! The report of a search for the best design: convergence, Pareto front, sensitivities, and the best design.
//!
//! Read `data` first, then `designs`, which says how figures show designs. `parallel` is one figure,
//! and `figures` has the others and lists all of them. `notes` are sentences.

mod data;
mod designs;
mod figures;
mod notes;
mod parallel;

pub use data::OptimumData;
pub use figures::of_search;
pub use notes::notes;
