//! Data of the figures of a report.

/// Rest positions of the balls.
mod preferred;
