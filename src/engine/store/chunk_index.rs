//! Finished runs of the same study, found by their numbers, one window of numbers at a time.

use std::collections::HashMap;

use super::chunk::{CaseKey, Chunk, StoredOutcome};
use super::folder::{Folder, ListedChunk, what_follows};
use crate::engine::say;
use crate::study::PlannedRun;
use crate::table::RunRecord;

/// The largest size of chunks that stay in memory between windows, in bytes.
const MEMORY: usize = 1 << 27;

/// A finished run on disk.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::engine) struct StoredResult {
    /// The key of its case.
    pub key: CaseKey,
    /// The serialized outcome.
    pub content: Vec<u8>,
    /// Whether the run is in the output directory, not in a shard's.
    pub in_output: bool,
}

impl StoredResult {
    /// Returns the row of a run if this is the complete result of its case.
    pub fn of_run(&self, planned: PlannedRun) -> Option<RunRecord> {
        let StoredOutcome { outcome, audit } = StoredOutcome::decode(&self.content, &planned)?;
        let is_same = self.key == CaseKey::of(&planned);
        is_same.then_some(RunRecord { planned, outcome, audit })
    }
}

/// The folders of a study: first that of the output directory, then those of its shards.
#[derive(Debug)]
pub(in crate::engine) struct ChunkIndex {
    pub(super) folders: Vec<Folder>,
    /// Chunks that may reach into the next window, by folder and number.
    loaded: HashMap<(usize, u64), Chunk>,
}

impl ChunkIndex {
    /// Creates an index with the folder of the output directory.
    pub(super) fn new(folder: Folder) -> Self {
        ChunkIndex { folders: vec![folder], loaded: HashMap::new() }
    }

    /// Whether there is a finished run with this number or a later one.
    pub fn reach(&self, run_id: u64) -> bool {
        let mut listed = self.folders.iter().flat_map(|folder| &folder.listed);
        listed.any(|chunk| chunk.last_run >= run_id)
    }

    /// Returns the finished runs from number `first` to `last`; windows must ascend. Reports each damaged chunk once,
    /// and sets it aside if it is in the output directory.
    pub fn window(&mut self, first: u64, last: u64) -> HashMap<u64, StoredResult> {
        let mut runs = HashMap::new();
        for (number, folder) in self.folders.iter_mut().enumerate() {
            let in_output = number == 0;
            let loaded = &mut self.loaded;
            let mut take = |folder: &Folder, listed: &ListedChunk| -> Result<(), String> {
                let chunk = match loaded.remove(&(number, listed.chunk)) {
                    Some(chunk) => chunk,
                    None => folder.read(listed)?,
                };
                let found = |(run_id, key, content): (u64, CaseKey, &[u8])| {
                    (run_id, StoredResult { key, content: content.to_vec(), in_output })
                };
                runs.extend(chunk.runs_between(first, last).map(found));
                if listed.last_run > last {
                    loaded.insert((number, listed.chunk), chunk);
                }
                Ok(())
            };
            let mut damaged = Vec::new();
            for (index, listed) in folder.listed.iter().enumerate() {
                if listed.first_run > last || listed.last_run < first {
                    continue;
                }
                if let Err(fault) = take(folder, listed) {
                    say(&format!("{fault}: its runs are {}", what_follows(folder.shared)));
                    damaged.push(index);
                }
            }
            for index in damaged.into_iter().rev() {
                let listed = folder.listed.remove(index);
                if in_output {
                    folder.put_aside(&listed);
                }
            }
        }
        if self.loaded.values().map(Chunk::size).sum::<usize>() > MEMORY {
            self.loaded.clear();
        }
        runs
    }
}
