//! Systems whose disc may turn with a speed that changes.

use super::{ContactMode, Expression, Recorder, System, SystemEquations};

/// Speed and acceleration of the disc in recorded equations.
#[derive(Clone, Copy)]
pub(super) struct DiscSpeed<'r> {
    pub(super) speed: Expression<'r>,
    pub(super) acceleration: Expression<'r>,
}

/// A system whose disc may turn with a speed that changes.
pub(super) trait DrivenDisc: System + Clone {
    /// Records the equations at constant speed, or with what `turning` returns. `turning` is called when the components of
    /// the state are recorded, and may record another one.
    fn record_turning<'r>(
        &self,
        recorder: &'r Recorder,
        turning: impl FnOnce() -> Option<DiscSpeed<'r>>,
    ) -> SystemEquations<'r>;

    /// Returns the values of the inputs without those that `turning` records.
    fn inputs_turning(&self, modes: &[ContactMode], turning: bool) -> Vec<f64>;
}
