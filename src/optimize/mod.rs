//! Sequential approximate optimisation: surrogates of a few designs choose the next ones.
//!
//! A search begins with space-filling designs over all ranges and choices, which reveal discontinuities that steps from
//! a single design would miss. Then surrogates of all objectives and limits choose designs in batches. Design number
//! `k` is a function of the study and of the designs before it, so that an interrupted search can continue and the
//! number of threads does not matter. The estimate of the best design is biased by the selection; therefore its
//! reported responses come from other and more runs.
//!
//! Read `space` first, which has the designs, then `evaluations`, the evaluated designs. `goal` combines the points of
//! a sweep into one value, says what is sought, and finds the designs that no other one dominates. `process` has
//! Gaussian processes of quantities on their own scales and smooth approximations of responses, `criterion` says how good
//! a design promises to be, and `proposal` maximises it. `suggest` and `next_designs` choose designs with these, and
//! `search` evaluates them. Afterwards `finalists` evaluates the best designs again. `sensitivity` computes how much of
//! the variance each variable explains. `report` writes the result in words, and `into_directory` runs everything with
//! progress.

mod criterion;
mod evaluations;
mod finalists;
mod goal;
mod into_directory;
mod next_designs;
mod notes;
mod process;
mod proposal;
mod report;
mod search;
mod search_directory;
mod sensitivity;
mod space;
mod suggest;

pub use evaluations::{Evaluation, read_evaluations};
pub use finalists::FinalistRole;
pub use goal::{Goal, pareto_front};
pub use into_directory::{Optimize, Optimized};
pub use process::Surrogate;
pub use sensitivity::{Sensitivity, SobolIndex, pick_freeze_sample, sobol_indices};
pub(crate) use space::Space;
