//! Finished runs of other studies in the same directory, found by their cases.

use std::collections::{HashMap, VecDeque};
use std::sync::{Arc, Mutex, PoisonError};

use super::chunk::{CaseKey, Chunk};
use super::folder::{Folder, ListedChunk};
use crate::engine::say;

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
