//! All integration tests in one binary; folders mirror `src`.

/// Intervals and estimates, equilibrium sets, frictionless equilibria and classes of limit cycles.
mod analysis;
/// Closed forms and warnings before a study is computed.
mod check;
/// Endings of runs.
mod classification;
/// The command line: input, output, exit codes, interruption, memory.
mod cli;
/// The documentation.
mod docs;
/// The engine: threads, chunks, failures.
mod engine;
/// Robustness against kills, full disks and damaged files.
mod faults;
/// Equations of motion and closed forms.
mod model;
/// Integration, switches and symmetries.
mod motion;
/// Search for the best design, and sensitivity indices.
mod optimize;
/// Licences, versions and sources of the dependencies.
mod policy;
/// Data of the figures.
mod report;
/// Estimates of responses, and comparison of designs.
mod responses;
/// Study files, sampling designs, uncertain parameters and plans.
mod study;
/// Random numbers and angles for tests.
mod support;
/// Columns, metadata and contents of the tables.
mod table;
/// Comparison of the thesis with the program, in `docs/validation.md`.
mod validation;
