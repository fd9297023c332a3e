//! The finished runs on disk, so that no run is computed twice.
//!
//! A directory of results has a folder `chunks/` with one folder per study that was run there, named after its hash.
//! Runs of the same study are found by their numbers, in this directory and in those of its shards; runs of other
//! studies are found by their cases. Every chunk is verified by its hash and every run by its case. Runs that are not
//! found are computed and stored.
//!
//! Read `chunk` first: one finished run, and a file of such runs. `folder` has the chunks of one study with their list.
//! `chunk_index` finds runs by their numbers and by their cases, and `lock` keeps other processes away. [`Store`] combines
//! them.

mod chunk;
mod chunk_index;
mod folder;
mod lock;
mod store_error;

use std::fs;
use std::path::{Path, PathBuf};

pub(super) use chunk::{CaseKey, NewResult, StoredOutcome};
pub use chunk::{Chunk, ChunkFault};
pub(super) use chunk_index::{ChunkIndex, ResultCache, StoredResult};
pub use folder::ListedChunk;
pub use store_error::StoreError;

pub(super) use self::folder::Folder;
pub use self::lock::Lock;
use crate::study::Study;
use crate::table::{ResultsError, make_directory, make_inside, sync_directory};

/// Name of the folder of chunks in an output directory.
pub const CHUNKS: &str = "chunks";
const LOCK: &str = "lock";
/// Number of digits of a study's hash in its folder's name.
const DIGITS: usize = 16;
/// Returns the number of finished runs of a study in the list of an output directory, to which another process may
/// be writing; repeated runs count repeatedly.
///
/// # Errors
/// Returns [`StoreError::Unusable`] if the list cannot be read.
pub fn listed_runs(directory: &Path, study: &Study) -> Result<u64, StoreError> {
    Ok(folder_of(directory, &study.hash(), true)?.runs())
}

/// Opens the folder of a study in an output directory, which this process does not change.
fn folder_of(directory: &Path, study_hash: &str, shared: bool) -> Result<Folder, StoreError> {
    let path = directory.join(CHUNKS).join(&study_hash[..DIGITS]);
    Folder::open(path, study_hash, false, shared)
}

/// The finished runs in an output directory, which is locked as long as this value lives, unless it was opened with
/// [`Store::open_shared`].
#[derive(Debug)]
pub struct Store {
    /// The folder to which new chunks are added.
    pub(super) output: Folder,
    pub(super) chunk_index: ChunkIndex,
    pub(super) result_cache: ResultCache,
    /// `None` of a store for reading.
    lock: Option<Lock>,
}

impl Store {
    /// Opens or creates the store of an output directory for a study, including reusable runs of other studies.
    ///
    /// # Errors
    /// Returns [`StoreError::Busy`] if another process holds the lock, or [`StoreError::Unusable`].
    pub fn open(directory: &Path, study: &Study) -> Result<Self, StoreError> {
        let chunks = directory.join(CHUNKS);
        make_directory(directory).map_err(ResultsError::unusable(directory))?;
        make_inside(&chunks).map_err(ResultsError::unusable(&chunks))?;
        let lock = Lock::take(chunks.join(LOCK), directory)?;
        // A process that created a folder here may have been killed before it synced the directory.
        sync_directory(&chunks).map_err(ResultsError::unusable(&chunks))?;
        let study_hash = study.hash();
        let here = chunks.join(&study_hash[..DIGITS]);
        let mut others = Vec::new();
        for entry in fs::read_dir(&chunks).map_err(ResultsError::unusable(&chunks))? {
            let path = entry.map_err(ResultsError::unusable(&chunks))?.path();
            // Includes links to directories, which `Folder::open` refuses.
            if path != here && path.is_dir() {
                others.push(path);
            }
        }
        others.sort();
        let open = |path: PathBuf| {
            let hash = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
            Folder::open(path, &hash, true, false)
        };
        let others: Result<Vec<Folder>, StoreError> = others.into_iter().map(open).collect();
        let output = Folder::open(here, &study_hash, true, false)?;
        Ok(Store {
            chunk_index: ChunkIndex::new(output.clone()),
            output,
            result_cache: ResultCache::of(others?),
            lock: Some(lock),
        })
    }

    /// Opens the finished runs of a study for reading, without the lock: another process may be writing to the
    /// directory, which this value never changes. Reusable runs of other studies are not included.
    ///
    /// # Errors
    /// Returns [`StoreError::Unusable`] if the list of chunks cannot be read.
    pub fn open_shared(directory: &Path, study: &Study) -> Result<Self, StoreError> {
        let output = folder_of(directory, &study.hash(), true)?;
        Ok(Store {
            chunk_index: ChunkIndex::new(output.clone()),
            output,
            result_cache: ResultCache::of(Vec::new()),
            lock: None,
        })
    }

    /// Adds the runs of the same study in the directory of a shard; returns the number of runs on its list.
    ///
    /// # Errors
    /// Returns [`StoreError::Unusable`] if the list cannot be read.
    pub fn add_shard(&mut self, directory: &Path) -> Result<u64, StoreError> {
        let folder = folder_of(directory, &self.output.study_hash, false)?;
        let runs = folder.runs();
        self.chunk_index.folders.push(folder);
        Ok(runs)
    }

    /// Checks that this process still holds the lock.
    ///
    /// # Errors
    /// Returns [`StoreError::Lost`] if it does not.
    pub fn check(&self) -> Result<(), StoreError> {
        self.lock.as_ref().map_or(Ok(()), Lock::check)
    }

    /// Returns the number of finished runs of this study on all lists, here and in its shards.
    pub fn listed_runs(&self) -> u64 {
        self.chunk_index.folders.iter().map(Folder::runs).fold(0, u64::saturating_add)
    }

    /// Whether there are finished runs of other studies.
    pub fn has_others(&self) -> bool {
        !self.result_cache.index.is_empty()
    }

    /// Whether another study has finished this run, so that it need not be computed.
    pub fn can_reuse(&self, study: &Study, run_id: u64) -> bool {
        self.result_cache.find(CaseKey::of(&study.planned_run(run_id))).is_some()
    }
}
