//! The tables as readers find them.

mod contract;
mod cycles;
mod intervals;
mod memory;
mod parts;
mod preferred;
mod provenance;
mod read;
