//! What happened in a step of all lanes.

use super::LANES;
use crate::motion::Failure;

/// The events of a step, as bit masks of lanes.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct StepReport {
    /// The lane's step has been taken.
    pub(crate) taken: u64,
    /// A contact changed its phase, or came to rest.
    pub(crate) event: u64,
    /// An angle passed through 0.
    pub(crate) round: u64,
    /// The requested time or the end time was reached, or the perturbation must be rescaled.
    pub(crate) attention: u64,
    /// The amplitude may have been larger than the watched one.
    pub(crate) larger: u64,
    /// All contacts stick, perhaps for good.
    pub(crate) rest: u64,
    /// Everything is slow while a contact slides.
    pub(crate) still: u64,
    /// Without dry friction: a contact has turned back, which no condition detects.
    pub(crate) turned: u64,
    /// The lanes for which events, completed turns and reversals are reported.
    pub(crate) reporting_lanes: u64,
    /// Lanes that cannot continue.
    pub(crate) failed: u64,
    pub(super) failures: [Option<Failure>; LANES],
}

impl StepReport {
    /// Returns the lanes with anything to report.
    pub(crate) fn any(&self) -> u64 {
        let events = (self.event | self.round | self.turned) & self.reporting_lanes;
        events | self.attention | self.larger | self.rest | self.still | self.failed
    }

    /// Returns why a lane cannot continue.
    pub(crate) fn failure(&self, lane: usize) -> Option<Failure> {
        self.failures[lane]
    }

    /// Notes that a lane cannot continue.
    pub(super) fn fail(&mut self, lane: usize, failure: Failure) {
        self.failed |= 1 << lane;
        self.failures[lane] = Some(failure);
    }
}
