//! All integration tests in one binary; folders mirror `src`.

/// Equilibrium sets and equilibria without friction.
mod analysis;
/// How runs end.
mod classification;
/// The command line: what goes in, what comes out, exit codes, interruption, memory.
mod cli;
/// The README.
mod docs;
/// Threads, chunks, failures: what the engine must not change and must keep.
mod engine;
/// What may happen on a bad day: kills, full disks, damaged files.
mod faults;
/// Equations of motion and closed forms.
mod model;
/// Integration, switches and symmetries.
mod motion;
/// What the project depends on.
mod policy;
/// What figures show.
mod report;
/// Responses of designs.
mod responses;
/// Study files, sampling designs, uncertain parameters and plans.
mod study;
/// Columns, metadata and contents of the tables.
mod table;
/// The thesis's counts, from the study files.
mod thesis;
/// The page that sets the thesis beside the program.
mod validation;
