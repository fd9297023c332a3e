//! One finished run as it is stored, and a chunk: finished runs in one file, in ascending order of their numbers.
//!
//! Layout, little-endian: 16 magic bytes, the versions of the layout and of the model (4 bytes each), and the hash
//! of the study (64 hexadecimal digits); then per run its number (8 bytes), the key of its case (16), the length of
//! the outcome (4) and the outcome, serialized by postcard. The hash in the list of chunks detects damage; the
//! parser only has to be safe for any input.

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use thiserror::Error;

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

const MAGIC: &[u8; 16] = b"stickslip chunk\n";
/// Version of the layout.
const FORMAT: u32 = 2;
const HASH_DIGITS: usize = 64;

/// The reason why bytes are not a chunk.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum ChunkFault {
    /// The magic bytes are wrong.
    #[error("not a chunk of finished runs")]
    Foreign,
    /// Another version wrote them.
    #[error(
        "layout {format} of model version {model}, this program reads {FORMAT} of {MODEL_VERSION}"
    )]
    Version {
        /// Version of the layout.
        format: u32,
        /// Version of the model.
        model: u32,
    },
    /// They end within a run.
    #[error("it ends within a run, at byte {at}")]
    Torn {
        /// Offset of that run.
        at: usize,
    },
    /// The run numbers do not ascend.
    #[error("run {run_id} is out of order")]
    Order {
        /// Number of the run.
        run_id: u64,
    },
}

/// A finished run that is not on disk yet.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::engine) struct NewResult {
    pub run_id: u64,
    pub key: CaseKey,
    pub content: Vec<u8>,
}

/// A parsed chunk.
#[derive(Debug)]
pub struct Chunk {
    /// The hash of the study of the runs.
    pub study_hash: String,
    runs: Vec<ChunkEntry>,
    bytes: Vec<u8>,
}

#[derive(Clone, Copy, Debug)]
struct ChunkEntry {
    run_id: u64,
    key: CaseKey,
    start: usize,
    end: usize,
}

impl Chunk {
    /// Parses a chunk.
    ///
    /// # Errors
    /// Returns a [`ChunkFault`] if the bytes are not a chunk of this version.
    pub fn parse(bytes: Vec<u8>) -> Result<Self, ChunkFault> {
        let mut rest = UnreadBytes { bytes: &bytes, at: 0 };
        if rest.take::<16>() != Some(*MAGIC) {
            return Err(ChunkFault::Foreign);
        }
        let (Some(format), Some(model)) = (rest.take(), rest.take()) else {
            return Err(ChunkFault::Foreign);
        };
        let [format, model] = [format, model].map(u32::from_le_bytes);
        if (format, model) != (FORMAT, MODEL_VERSION) {
            return Err(ChunkFault::Version { format, model });
        }
        let hash = rest.take::<HASH_DIGITS>().ok_or(ChunkFault::Foreign)?;
        let mut runs: Vec<ChunkEntry> = Vec::new();
        while rest.at < bytes.len() {
            let entry = rest.entry().ok_or(ChunkFault::Torn { at: rest.at })?;
            if runs.last().is_some_and(|last| last.run_id >= entry.run_id) {
                return Err(ChunkFault::Order { run_id: entry.run_id });
            }
            runs.push(entry);
        }
        Ok(Chunk { study_hash: String::from_utf8_lossy(&hash).into_owned(), runs, bytes })
    }

    /// Returns the approximate size in memory, bytes.
    pub fn size(&self) -> usize {
        self.bytes.len() + size_of_val(self.runs.as_slice())
    }

    /// Returns the numbers of the runs.
    pub fn run_ids(&self) -> impl ExactSizeIterator<Item = u64> {
        self.runs.iter().map(|entry| entry.run_id)
    }

    /// Returns the keys of the runs.
    pub(super) fn keys(&self) -> impl ExactSizeIterator<Item = CaseKey> {
        self.runs.iter().map(|entry| entry.key)
    }

    /// Returns the runs whose numbers are in this range: number, key and content.
    pub(super) fn runs_between(
        &self,
        first: u64,
        last: u64,
    ) -> impl Iterator<Item = (u64, CaseKey, &[u8])> {
        let from = self.runs.partition_point(|entry| entry.run_id < first);
        let inside = self.runs[from..].iter().take_while(move |entry| entry.run_id <= last);
        inside.map(|entry| (entry.run_id, entry.key, &self.bytes[entry.start..entry.end]))
    }

    /// Returns the content of the run with this index.
    pub(super) fn content(&self, index: usize) -> Option<&[u8]> {
        self.runs.get(index).map(|entry| &self.bytes[entry.start..entry.end])
    }
}

struct UnreadBytes<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl UnreadBytes<'_> {
    fn take<const N: usize>(&mut self) -> Option<[u8; N]> {
        let taken = *self.bytes.get(self.at..)?.first_chunk::<N>()?;
        self.at += N;
        Some(taken)
    }

    /// Returns the next run; consumes nothing if the run is incomplete.
    fn entry(&mut self) -> Option<ChunkEntry> {
        let mut ahead = UnreadBytes { bytes: self.bytes, at: self.at };
        let run_id = u64::from_le_bytes(ahead.take()?);
        let key = CaseKey(ahead.take()?);
        let length = usize::try_from(u32::from_le_bytes(ahead.take()?)).ok()?;
        let start = ahead.at;
        let end = start.checked_add(length).filter(|end| *end <= self.bytes.len())?;
        self.at = end;
        Some(ChunkEntry { run_id, key, start, end })
    }
}

/// Returns the bytes of a chunk with these runs, which must be in ascending order. Omits a run above four gigabytes.
pub(super) fn chunk_bytes(study_hash: &str, runs: &[NewResult]) -> Vec<u8> {
    let mut bytes = MAGIC.to_vec();
    bytes.extend(FORMAT.to_le_bytes());
    bytes.extend(MODEL_VERSION.to_le_bytes());
    bytes.extend(study_hash.bytes().chain(std::iter::repeat(b' ')).take(HASH_DIGITS));
    for NewResult { run_id, key, content } in runs {
        let Ok(length) = u32::try_from(content.len()) else { continue };
        bytes.extend(run_id.to_le_bytes());
        bytes.extend(key.0);
        bytes.extend(length.to_le_bytes());
        bytes.extend(content);
    }
    bytes
}
