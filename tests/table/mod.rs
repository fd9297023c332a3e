//! The tables as readers find them.

mod contract;
mod cycles;
mod intervals;
mod preferred;
mod provenance;
