//! All integration tests in one binary; folders mirror `src`.

/// The program as a user meets it: arguments, exit codes, messages, signals, memory.
mod cli;
/// Farming changes no result, and one bad run is one bad row.
mod farm;
/// Equations of motion and closed forms.
mod model;
mod study;
/// What readers of the tables rely on: columns, units, provenance.
mod table;
