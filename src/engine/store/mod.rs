//! What is on disk of finished runs, so that none is computed twice.
//!
//! A directory of results has a folder `chunks/` with a folder for each study that has been run there,
//! named after its hash. Runs of the same study are found by their numbers, there and in the
//! directories of its shards; runs of other studies by their cases. Whatever is found is checked: the chunk
//! by its hash, the run by its case. What is not found is computed and kept.

mod chunk;
mod chunk_index;
mod folder;
mod lock;
mod record;
mod result_cache;

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use thiserror::Error;

pub use chunk::{Chunk, ChunkFault};
pub(super) use chunk_index::{ChunkIndex, StoredResult};
pub use folder::Listed;
pub(super) use record::{CaseKey, StoredOutcome};
pub(super) use result_cache::ResultCache;

use self::chunk::ChunkWriter;
use self::folder::Folder;
pub use self::lock::Lock;
use crate::study::Study;
use crate::table::{make_directory, make_inside, sync_directory};

/// Folder of the chunks in an output directory.
pub const CHUNKS: &str = "chunks";
const LOCK: &str = "lock";
/// How many digits of a study's hash name its folder.
const DIGITS: usize = 16;
/// Why finished runs could not be kept or read.
#[derive(Debug, Error)]
pub enum StoreError {
    /// A folder or file cannot be used.
    #[error(
        "{}: cannot be used as output directory\n  found:   {cause}\n  allowed: a directory that can \
         be made, read and written to",
        path.display()
    )]
    Unusable {
        /// It.
        path: PathBuf,
        /// What the operating system says.
        cause: io::Error,
    },
    /// Another process writes into the directory.
    #[error(
        "{}: another process is writing into this directory\n  found:   its lock on {}\n  allowed: \
         wait until it has ended, or another directory, with --out DIR",
        path.display(), lock.display()
    )]
    Busy {
        /// The directory.
        path: PathBuf,
        /// The lock, from the directory on.
        lock: PathBuf,
    },
    /// The lock was removed while this process had it.
    #[error(
        "{}: this directory is no longer ours\n  found:   {} was removed while it was held, so that \
         another process may write here, too\n  allowed: no other process; the same command then goes on \
         with what is finished",
        path.display(), lock.display()
    )]
    Lost {
        /// The directory.
        path: PathBuf,
        /// The lock, from the directory on.
        lock: PathBuf,
    },
    /// A chunk could not be written.
    #[error(
        "cannot write {}: {cause}\n  what was finished before is kept; with the cause removed, the same \
         command goes on",
        path.display()
    )]
    Unwritten {
        /// The chunk.
        path: PathBuf,
        /// What the operating system says.
        cause: io::Error,
    },
}

/// How many finished runs of a study are on the list of an output directory, in which others may be
/// writing; those that are there more than once count as often.
///
/// # Errors
/// [`StoreError::Unusable`].
pub fn listed_runs(directory: &Path, study: &Study) -> Result<u64, StoreError> {
    let hash = study.hash();
    Ok(Folder::open(directory.join(CHUNKS).join(&hash[..DIGITS]), &hash, false)?.runs())
}

/// The finished runs in an output directory, ours alone as long as this value lives.
#[derive(Debug)]
pub struct Store {
    pub(super) appender: ChunkAppender,
    pub(super) chunk_index: ChunkIndex,
    pub(super) result_cache: ResultCache,
    lock: Lock,
}

impl Store {
    /// Opens, or makes, the store of an output directory for a study; runs of other studies there are used
    /// again.
    ///
    /// # Errors
    /// [`StoreError::Busy`] where another process has it, [`StoreError::Unusable`].
    pub fn open(directory: &Path, study: &Study) -> Result<Self, StoreError> {
        let chunks = directory.join(CHUNKS);
        let unusable = |path: &Path| {
            let path = path.to_owned();
            move |cause| StoreError::Unusable { path, cause }
        };
        make_directory(directory).map_err(unusable(directory))?;
        make_inside(&chunks).map_err(unusable(&chunks))?;
        let lock = Lock::take(chunks.join(LOCK), directory)?;
        // Whoever made a folder here may have been killed before it had synced it.
        sync_directory(&chunks).map_err(unusable(&chunks))?;
        let study_hash = study.hash();
        let own = chunks.join(&study_hash[..DIGITS]);
        let mut others = Vec::new();
        for entry in fs::read_dir(&chunks).map_err(unusable(&chunks))? {
            let path = entry.map_err(unusable(&chunks))?.path();
            // Also what a link leads to: it is refused like a link in place of any other folder here.
            if path != own && path.is_dir() {
                others.push(path);
            }
        }
        others.sort();
        let open = |path: PathBuf| {
            let hash = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
            Folder::open(path, &hash, true)
        };
        let others: Result<Vec<Folder>, StoreError> = others.into_iter().map(open).collect();
        let own = Folder::open(own, &study_hash, true)?;
        Ok(Store {
            chunk_index: ChunkIndex::new(own.clone()),
            appender: ChunkAppender { folder: own, study_hash },
            result_cache: ResultCache::of(others?),
            lock,
        })
    }

    /// Also finds runs of the same study in another directory, that of a shard; returns how many are on
    /// its list.
    ///
    /// # Errors
    /// [`StoreError::Unusable`].
    pub fn add_shard(&mut self, directory: &Path) -> Result<u64, StoreError> {
        let hash = &self.appender.study_hash;
        let folder = Folder::open(directory.join(CHUNKS).join(&hash[..DIGITS]), hash, false)?;
        let runs = folder.runs();
        self.chunk_index.folders.push(folder);
        Ok(runs)
    }

    /// Whether the directory is still ours alone.
    ///
    /// # Errors
    /// [`StoreError::Lost`] where it is not.
    pub fn check(&self) -> Result<(), StoreError> {
        self.lock.check()
    }

    /// How many finished runs of this study are on lists, here and in its shards.
    pub fn listed_runs(&self) -> u64 {
        self.chunk_index.folders.iter().map(Folder::runs).fold(0, u64::saturating_add)
    }

    /// Whether there are finished runs of other studies.
    pub fn has_others(&self) -> bool {
        !self.result_cache.is_empty()
    }

    /// Whether another study has finished this very run, so that it need not be computed.
    pub fn can_reuse(&self, study: &Study, run_id: u64) -> bool {
        self.result_cache.find(CaseKey::of(&study.planned_run(run_id))).is_some()
    }
}

/// A run that has been finished and is not on disk yet.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct NewResult {
    pub run_id: u64,
    pub key: CaseKey,
    pub content: Vec<u8>,
}

/// Writes chunks of a study.
#[derive(Debug)]
pub(super) struct ChunkAppender {
    folder: Folder,
    study_hash: String,
}

impl ChunkAppender {
    /// Writes these runs, which ascend, as a chunk; they are finished when this returns.
    ///
    /// # Errors
    /// [`StoreError::Unwritten`].
    pub fn append(&mut self, runs: &[NewResult]) -> Result<(), StoreError> {
        let mut chunk = ChunkWriter::new(&self.study_hash);
        runs.iter().for_each(|run| chunk.push(run.run_id, run.key, &run.content));
        let run_ids: Vec<u64> = runs.iter().map(|run| run.run_id).collect();
        self.folder.add(&chunk.bytes, &run_ids)
    }
}
