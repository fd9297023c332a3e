//! All integration tests in one binary; folders mirror `src`.

/// The README.
mod docs;
/// How runs end.
mod ending;
/// Equations of motion and closed forms.
mod model;
/// Integration, switches and symmetries.
mod motion;
/// Study files, sampling designs, uncertain parameters and plans.
mod study;
/// The thesis's counts, from the study files.
mod thesis;
