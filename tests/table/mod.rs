//! The tables from the reader's point of view.

mod contract;
mod cycles;
mod intervals;
mod memory;
mod parts;
mod preferred;
mod provenance;
mod read;
