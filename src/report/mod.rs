//! The report page and the animation of a replayed run, and the files that hold them. Equal data give equal bytes.
//!
//! Read `chart` and `data` first: what a figure contains, and what the tables of a directory say about its points and runs.
//! `figures` makes the figures of a study from the data. `printed_columns` chooses the columns of its tables,
//! `conclusion` writes its sentences, and `optimum` makes the report of a search. `page` puts everything into HTML.
//! `overwrite` says which files may be replaced, and `write` writes the page.
//!
//! `animation` and `replay` are about one run that is computed again, and `comparison` is about two studies.

mod animation;
pub mod chart;
mod comparison;
mod conclusion;
mod data;
mod figures;
mod optimum;
mod overwrite;
mod packed;
mod page;
mod printed_columns;
mod replay;
mod write;

pub use crate::engine::MOST_INSTANTS;
pub use crate::numbers::{percent, three_digits};
pub use crate::printed_table::PrintedColumn;
pub use animation::{ANIMATION, time_text};
pub use comparison::{ComparedPoint, ComparedQuantity, ComparedResults, Comparison, compare};
pub use conclusion::Conclusion;
pub use data::{
    Budget, Fraction, IncompletePoints, NamedPoints, PointFacts, ReportData, ResultTables,
};
pub use figures::of_results;
pub use optimum::{OptimumData, notes, of_search};
pub use overwrite::beside;
pub use page::{OWN, optimum_page, page};
pub use printed_columns::{Estimates, estimate_columns, printed_columns, response_columns};
pub use replay::{Replay, SWITCHES};
pub use write::{printed_figures, printed_figures_of, write_report};
