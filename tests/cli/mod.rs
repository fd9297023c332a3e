//! The command line, through the built program.

pub mod support;

mod abandoned_runs;
mod changed_bits;
mod check;
mod commands;
mod compare;
mod cost;
mod directories;
mod edited;
mod equilibria;
mod evaluate;
mod evaluate_requests;
mod evaluate_tables;
mod existence;
mod expand;
mod foreign;
mod identify;
mod interrupt;
mod limits;
mod memory;
mod merged;
mod network;
mod new;
pub mod optimize;
mod progress;
mod remedies;
mod replay;
mod replay_contact;
mod report;
mod responses;
mod resume;
mod streams;
mod summary;
mod system_files;
mod tables;
mod usage;
