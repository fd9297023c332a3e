//! The chunks of one study in one directory, and the list of finished chunks.
//!
//! A chunk is finished when the list names it with its hash. It is written under a temporary name and synced; then
//! its line is appended to the list, which is synced; then it is renamed. After a crash, a listed chunk that still has its
//! temporary name is renamed when it is read. A chunk whose bytes differ from the listed hash is never used.

use std::collections::HashSet;
use std::fs::{self, File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::StoreError;
use super::chunk::{Chunk, NewResult, chunk_bytes};
use crate::classification::MODEL_VERSION;
use crate::engine::say;
use crate::sanitize::shown_path;
use crate::table::{ResultsError, is_inside, make_inside, read_regular, sha256, sync_directory};

/// File name of the list of finished chunks, one line of JSON each.
pub(super) const LIST: &str = "manifest.jsonl";
/// The largest list that is read, in bytes: far above the list of the largest study.
const LONGEST_LIST: u64 = 1 << 27;
/// The largest chunk that is read, in bytes: far above the largest chunk.
const LARGEST_CHUNK: u64 = 1 << 30;
/// Upper bound of chunk numbers.
const MOST_CHUNKS: u64 = 1 << 48;
/// The number of damaged lines of a list that are reported one by one.
const MOST_REPORTED: usize = 10;

/// A finished chunk in the list.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ListedChunk {
    /// Number of the chunk, which is its file's name.
    pub chunk: u64,
    /// Version of the model that computed its outcomes.
    pub model_version: u32,
    /// Number of its first run.
    pub first_run: u64,
    /// Number of its last run.
    pub last_run: u64,
    /// Number of its runs.
    pub runs: u64,
    /// Size of the file, bytes.
    pub bytes: u64,
    /// SHA-256 of the content, hexadecimal.
    pub sha256: String,
}

/// The chunks of one study in one directory.
#[derive(Clone, Debug)]
pub(in crate::engine) struct Folder {
    path: PathBuf,
    /// The hash of the study, or its first digits.
    pub(super) study_hash: String,
    /// Whether this process holds the lock of the directory.
    ours: bool,
    /// Whether another process may be writing to the folder.
    pub shared: bool,
    /// Finished chunks in order of completion; where two hold the same run, the later one is valid.
    pub listed: Vec<ListedChunk>,
    next: u64,
}

/// Returns a message on a faulty file.
fn fault(path: &Path, what: impl std::fmt::Display) -> String {
    format!("{}: {what}", shown_path(path))
}

/// Returns what happens to the runs of a damaged chunk, for messages.
pub(super) fn what_follows(shared: bool) -> &'static str {
    if shared { "left out" } else { "computed again" }
}

impl Folder {
    /// Reads the list of a folder; a missing folder has no chunks. Reports lines that cannot be read. `ours` says
    /// whether the folder may be modified. If another process may be adding chunks to it (`shared`), a last line that is not
    /// finished is ignored, and the folder never changes.
    ///
    /// # Errors
    /// Returns an error if the operating system refuses access, or if the folder or its list is a symbolic link.
    pub fn open(
        path: PathBuf,
        study_hash: &str,
        ours: bool,
        shared: bool,
    ) -> Result<Self, StoreError> {
        for folder in path.parent().into_iter().chain([path.as_path()]) {
            is_inside(folder).map_err(ResultsError::unusable(folder))?;
        }
        let list = path.join(LIST);
        let content = match read_regular(&list, LONGEST_LIST) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(Vec::new()),
            other => other,
        };
        let mut content = content.map_err(ResultsError::unusable(&list))?;
        if shared {
            let finished =
                content.iter().rposition(|byte| *byte == b'\n').map_or(0, |last| last + 1);
            content.truncate(finished);
        }
        let consequence = what_follows(shared);
        let mut listed: Vec<ListedChunk> = Vec::new();
        let mut known = HashSet::new();
        let mut damaged = 0_usize;
        for (index, line) in String::from_utf8_lossy(&content).lines().enumerate() {
            match serde_json::from_str::<ListedChunk>(line) {
                // Outcomes of another model version cannot be used.
                Ok(entry) if entry.model_version != MODEL_VERSION => {}
                Ok(entry) if entry.first_run <= entry.last_run && entry.chunk < MOST_CHUNKS => {
                    if known.insert(entry.clone()) {
                        listed.push(entry);
                    }
                }
                _ => {
                    damaged += 1;
                    if damaged <= MOST_REPORTED {
                        say(&format!(
                            "{}: line {} is damaged: the runs of its chunk are {consequence}",
                            shown_path(&list),
                            index + 1
                        ));
                    }
                }
            }
        }
        if damaged > MOST_REPORTED {
            say(&format!("{}: {damaged} damaged lines in total", shown_path(&list)));
        }
        let next = Self::next_number(&path, &listed);
        Ok(Folder { path, study_hash: study_hash.to_owned(), ours, shared, listed, next })
    }

    /// Returns a number above those of all chunks, including files that are not on the list.
    fn next_number(path: &Path, listed: &[ListedChunk]) -> u64 {
        let numbered = fs::read_dir(path).into_iter().flatten().flatten().filter_map(|entry| {
            let name = entry.file_name();
            let name = name.to_str()?;
            name.split_once('.').and_then(|(number, _)| number.parse::<u64>().ok())
        });
        let on_list = listed.iter().map(|entry| entry.chunk);
        let ours = numbered.chain(on_list).filter(|number| *number < MOST_CHUNKS);
        ours.max().map_or(0, |most| most + 1)
    }

    fn file(&self, chunk: u64) -> PathBuf {
        self.path.join(format!("{chunk:06}.chunk"))
    }

    /// Returns the number of runs on the list, counting repeated runs repeatedly.
    pub fn runs(&self) -> u64 {
        self.listed.iter().map(|entry| entry.runs).fold(0, u64::saturating_add)
    }

    /// Reads a chunk that matches the list.
    ///
    /// # Errors
    /// Returns what is wrong with the chunk.
    pub fn read(&self, entry: &ListedChunk) -> Result<Chunk, String> {
        let path = self.file(entry.chunk);
        let bytes = match read_exactly(&path, entry) {
            Err(cause) if cause.kind() == io::ErrorKind::NotFound => self.adopt(&path, entry),
            other => other,
        };
        let bytes = bytes.map_err(|cause| fault(&path, cause))?;
        let chunk = Chunk::parse(bytes).map_err(|cause| fault(&path, cause))?;
        let ids = || chunk.run_ids();
        let same_study = chunk.study_hash.starts_with(&self.study_hash);
        let same_runs = ids().len() as u64 == entry.runs
            && ids().next() == Some(entry.first_run)
            && ids().last() == Some(entry.last_run);
        match same_study && same_runs {
            true => Ok(chunk),
            false => Err(fault(&path, "not the chunk on the list")),
        }
    }

    /// Reads a chunk that is on the list but was not renamed, and renames it.
    fn adopt(&self, path: &Path, entry: &ListedChunk) -> io::Result<Vec<u8>> {
        let temporary = path.with_added_extension("partial");
        let bytes = match read_exactly(&temporary, entry) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => {
                // Another process may have renamed the chunk since the first attempt.
                return match read_exactly(path, entry) {
                    Err(error) if error.kind() == io::ErrorKind::NotFound => {
                        Err(io::Error::other("missing file"))
                    }
                    other => other,
                };
            }
            other => other?,
        };
        if self.ours {
            // If the rename fails, the content is still valid.
            let _ = fs::rename(&temporary, path);
        }
        Ok(bytes)
    }

    /// Renames a damaged chunk so that it is no longer read; it is not deleted. Does nothing unless this process holds
    /// the lock.
    pub fn put_aside(&self, entry: &ListedChunk) {
        if !self.ours {
            return;
        }
        let path = self.file(entry.chunk);
        let names = (1..100).map(|number| match number {
            1 => path.with_added_extension("damaged"),
            _ => path.with_added_extension(format!("damaged-{number}")),
        });
        let free = names.into_iter().find(|name| fs::symlink_metadata(name).is_err());
        // If the rename fails, the chunk stays; its number is not reused.
        let _ = free.map(|name| fs::rename(&path, name));
    }

    /// Writes these runs, in ascending order, as a chunk and adds it to the list; they are on disk when the function
    /// returns.
    ///
    /// # Errors
    /// Returns [`StoreError::Unwritten`] if the chunk cannot be written.
    pub fn append(&mut self, runs: &[NewResult]) -> Result<(), StoreError> {
        let (Some(first), Some(last)) = (runs.first(), runs.last()) else { return Ok(()) };
        let bytes = chunk_bytes(&self.study_hash, runs);
        let chunk = self.next;
        let path = self.file(chunk);
        let listed = ListedChunk {
            chunk,
            model_version: MODEL_VERSION,
            first_run: first.run_id,
            last_run: last.run_id,
            runs: runs.len() as u64,
            bytes: bytes.len() as u64,
            sha256: sha256(&bytes),
        };
        let temporary = path.with_added_extension("partial");
        let write = || -> io::Result<()> {
            if !is_inside(&self.path)? {
                make_inside(&self.path)?;
            }
            match fs::remove_file(&temporary) {
                Err(error) if error.kind() != io::ErrorKind::NotFound => return Err(error),
                _ => {}
            }
            let mut file = File::create_new(&temporary)?;
            file.write_all(&bytes)?;
            file.sync_all()?;
            self.list(&listed)?;
            fs::rename(&temporary, &path)?;
            sync_directory(&self.path)
        };
        let written = write();
        if written.is_err() {
            // Frees the name for another attempt; a chunk that is already on the list then counts as missing.
            let _ = fs::remove_file(&temporary);
        }
        written.map_err(|cause| StoreError::Unwritten { path: path.clone(), cause })?;
        self.next += 1;
        Ok(())
    }

    fn list(&self, listed: &ListedChunk) -> io::Result<()> {
        let path = self.path.join(LIST);
        let new = match fs::symlink_metadata(&path) {
            Ok(found) if found.is_file() => false,
            Ok(_) => return Err(io::Error::other("the list of chunks is not a regular file")),
            Err(_) => true,
        };
        let mut file = OpenOptions::new().create(true).append(true).open(&path)?;
        // A crash may have left an incomplete last line.
        let line = format!("{}\n", serde_json::to_string(listed).map_err(io::Error::other)?);
        let torn = !new && !ends_with_newline(&path)?;
        file.write_all(if torn { format!("\n{line}") } else { line }.as_bytes())?;
        file.sync_all()?;
        if new { sync_directory(&self.path) } else { Ok(()) }
    }
}

fn ends_with_newline(path: &Path) -> io::Result<bool> {
    use std::io::{Read, Seek, SeekFrom};
    let mut file = File::open(path)?;
    if file.metadata()?.len() == 0 {
        return Ok(true);
    }
    file.seek(SeekFrom::End(-1))?;
    let mut last = [0];
    file.read_exact(&mut last)?;
    Ok(last == *b"\n")
}

/// Returns the bytes of a file whose size and hash match the list.
fn read_exactly(path: &Path, entry: &ListedChunk) -> io::Result<Vec<u8>> {
    let found = fs::symlink_metadata(path)?;
    if found.is_file() && found.len() != entry.bytes {
        let found = found.len();
        return Err(io::Error::other(format!("{found} bytes, {} on the list", entry.bytes)));
    }
    let bytes = read_regular(path, LARGEST_CHUNK)?;
    if sha256(&bytes) != entry.sha256 {
        return Err(io::Error::other("its content has been changed"));
    }
    Ok(bytes)
}
