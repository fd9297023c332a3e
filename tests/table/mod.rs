//! The tables as readers find them.

mod contract;
mod cycles;
mod intervals;
mod parts;
mod preferred;
mod provenance;
mod read;
