//! The tables from the reader's point of view.

mod atomic_files;
mod basin_entropy;
mod cell;
pub mod contract;
mod cycles;
mod file_list;
mod intervals;
mod memory;
mod parts;
mod points;
mod preferred;
mod previous_results;
mod provenance;
mod read;
mod residual_vibration;
mod writer;
