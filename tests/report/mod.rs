//! What is drawn, by what it is made of.

mod figures;
/// The figure of a replayed run.
mod replay_figure;
