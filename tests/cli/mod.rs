//! The command line, through the built program.

pub mod support;

mod commands;
mod directories;
mod equilibria;
mod existence;
mod expand;
mod interrupt;
mod memory;
mod network;
mod streams;
mod usage;
