mod block_closed_form;
pub mod closed_forms;
mod existence;
mod extended_lagrange;
mod thesis_matrices;
