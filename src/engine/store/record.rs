//! One finished run as it is stored on disk, and its key.

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use crate::classification::{Evidence, MODEL_VERSION, Outcome};
use crate::study::PlannedRun;
use crate::table::RunRecord;

/// The key of a run, independent of its study: half of the SHA-256 of everything that determines its outcome.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(in crate::engine) struct CaseKey(pub(super) [u8; Self::BYTES]);

impl CaseKey {
    pub(super) const BYTES: usize = 16;

    /// Returns the key of a planned run.
    pub fn of(planned: &PlannedRun) -> Self {
        let case = planned.case.as_ref().map_err(ToString::to_string);
        // Most cases fit, so that the memory does not grow. Serializing numbers and names into memory cannot fail.
        let bytes = Vec::with_capacity(1024);
        let bytes = postcard::to_extend(&(MODEL_VERSION, case), bytes).unwrap_or_default();
        let digest = Sha256::digest(&bytes);
        let mut key = [0; Self::BYTES];
        key.copy_from_slice(&digest[..Self::BYTES]);
        CaseKey(key)
    }
}

/// The contents of a run's row besides its plan.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(in crate::engine) struct StoredOutcome {
    /// How the run ended.
    pub outcome: Outcome,
    /// The evidence of the second computation, if the run was audited.
    pub audit: Option<Evidence>,
}

impl StoredOutcome {
    /// Serializes a run's record.
    pub fn encode(record: &RunRecord) -> Vec<u8> {
        let RunRecord { outcome, audit, .. } = record;
        // Serialization into memory cannot fail.
        postcard::to_stdvec(&(outcome, audit)).unwrap_or_default()
    }

    /// Deserializes the output of [`StoredOutcome::encode`]. Returns `None` if the bytes are anything else, of a system with
    /// another number of contacts than that of the planned run, or without the audit that is planned.
    pub fn decode(bytes: &[u8], planned: &PlannedRun) -> Option<Self> {
        // A run without a case has no values of contacts.
        let contacts = planned.case.as_ref().map_or(0, |case| case.model.contacts());
        let (finished, rest): (StoredOutcome, _) = postcard::take_from_bytes(bytes).ok()?;
        let StoredOutcome { outcome, audit } = finished;
        let is_complete = !planned.audited || audit.is_some();
        let audit = audit.filter(|_| planned.audited);
        let is_usable = rest.is_empty() && outcome.is_of(contacts) && is_complete;
        is_usable.then_some(StoredOutcome { outcome, audit })
    }
}
