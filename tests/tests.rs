//! All integration tests in one binary; folders mirror `src`.

/// Equilibrium sets and equilibria without friction.
mod analysis;
/// The command line: what goes in, what comes out, exit codes, interruption, memory.
mod cli;
/// Designs and their responses.
mod design;
/// The README.
mod docs;
/// How runs end.
mod ending;
/// Threads, chunks, failures: what the farm must not change and must keep.
mod farm;
/// What may happen on a bad day: kills, full disks, damaged files.
mod faults;
/// Equations of motion and closed forms.
mod model;
/// Integration, switches and symmetries.
mod motion;
/// What the project depends on.
mod policy;
/// What is drawn, by what it is made of.
mod report;
/// Study files, sampling designs, uncertain parameters and plans.
mod study;
/// Columns, metadata and contents of the tables.
mod table;
/// The thesis's counts, from the study files.
mod thesis;
/// The page that sets the thesis beside the program.
mod validation;
