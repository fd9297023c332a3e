//! One finished run as it is kept on disk, and what it is known by: its case.

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use crate::classification::{Evidence, MODEL_VERSION, Outcome};
use crate::motion::SimdLevel;
use crate::study::PlannedRun;
use crate::table::RunRecord;

/// What a run is known by, whatever study it belongs to: half of the SHA-256 of everything that decides
/// its outcome.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(in crate::engine) struct CaseKey(pub(super) [u8; Self::BYTES]);

impl CaseKey {
    pub(super) const BYTES: usize = 16;

    /// The key of a planned run.
    pub fn of(planned: &PlannedRun) -> Self {
        let case = planned.case.as_ref().map_err(ToString::to_string);
        // Last digits differ between runs in lockstep and one by one.
        let in_lockstep = SimdLevel::best().name() != "none";
        // Numbers and names in memory: there is nothing in them that could not be written.
        let bytes = postcard::to_stdvec(&(MODEL_VERSION, in_lockstep, case)).unwrap_or_default();
        let digest = Sha256::digest(&bytes);
        let mut key = [0; Self::BYTES];
        key.copy_from_slice(&digest[..Self::BYTES]);
        CaseKey(key)
    }
}

/// What a run's row needs beside its plan.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(in crate::engine) struct StoredOutcome {
    /// How it ended.
    pub outcome: Outcome,
    /// Why it ended as it did when it was computed a second time, if it was.
    pub audit: Option<Evidence>,
}

impl StoredOutcome {
    /// The content of a run's record.
    pub fn encode(record: &RunRecord) -> Vec<u8> {
        let RunRecord { outcome, audit, .. } = record;
        // As above.
        postcard::to_stdvec(&(outcome, audit)).unwrap_or_default()
    }

    /// Reads what [`StoredOutcome::encode`] has written; `None` where it is something else, or not of a system
    /// with so many contacts.
    pub fn decode(bytes: &[u8], contacts: usize) -> Option<Self> {
        let (finished, rest): (StoredOutcome, _) = postcard::take_from_bytes(bytes).ok()?;
        (rest.is_empty() && finished.outcome.is_of(contacts)).then_some(finished)
    }
}
