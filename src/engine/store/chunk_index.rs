//! Finished runs on disk: those of the same study, found by their numbers, one window of numbers at a time, and those of other
//! studies in the same directory, found by their cases.

use std::collections::{HashMap, VecDeque};
use std::sync::{Arc, Mutex, PoisonError};

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

/// Number of chunks in memory.
const CACHED_CHUNKS: usize = 32;

/// An index of finished runs by case; it takes about forty bytes per run.
#[derive(Debug, Default)]
pub(in crate::engine) struct ResultCache {
    folders: Vec<Folder>,
    /// Folder index and list entry of each chunk.
    chunks: Vec<(usize, ListedChunk)>,
    /// Chunk number and index in the chunk, by case.
    pub(super) index: HashMap<CaseKey, (u32, u32)>,
    /// The chunks read last, the most recent at the end.
    loaded: Mutex<VecDeque<(u32, Arc<Chunk>)>>,
}

impl ResultCache {
    /// Indexes all chunks of these folders; reports and skips damaged chunks.
    pub(super) fn of(folders: Vec<Folder>) -> Self {
        let mut cache = ResultCache { folders, ..ResultCache::default() };
        for (number, folder) in cache.folders.iter().enumerate() {
            for listed in &folder.listed {
                let Ok(place) = u32::try_from(cache.chunks.len()) else { break };
                match folder.read(listed) {
                    Ok(chunk) => {
                        let keys = chunk.keys().zip(0_u32..);
                        cache.index.extend(keys.map(|(key, at)| (key, (place, at))));
                        cache.chunks.push((number, listed.clone()));
                    }
                    Err(fault) => say(&format!("{fault}: its runs cannot be reused")),
                }
            }
        }
        cache
    }

    /// Returns the content of a finished run of this case.
    pub fn find(&self, key: CaseKey) -> Option<Vec<u8>> {
        let (place, at) = *self.index.get(&key)?;
        let chunk = self.chunk(place)?;
        Some(chunk.content(usize::try_from(at).ok()?)?.to_vec())
    }

    fn chunk(&self, place: u32) -> Option<Arc<Chunk>> {
        // Every entry is complete, even after a panic of another thread.
        let mut loaded = self.loaded.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, chunk)) = loaded.iter().find(|(other, _)| *other == place) {
            return Some(Arc::clone(chunk));
        }
        let (folder, listed) = self.chunks.get(usize::try_from(place).ok()?)?;
        // The chunk was valid when it was indexed; if it no longer is, its runs are computed.
        let chunk = Arc::new(self.folders[*folder].read(listed).ok()?);
        if loaded.len() == CACHED_CHUNKS {
            loaded.pop_front();
        }
        loaded.push_back((place, Arc::clone(&chunk)));
        Some(chunk)
    }
}
