//! All integration tests in one binary; folders mirror `src`.

/// Equations of motion and closed forms.
mod model;
mod study;
