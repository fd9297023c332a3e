//! The tables as readers find them.

mod contract;
mod intervals;
mod preferred;
mod provenance;
