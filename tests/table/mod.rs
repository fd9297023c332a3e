//! The tables as readers find them.

mod contract;
mod cycles;
mod provenance;
