//! The chunks of one study in one directory, and the list of those that are finished.
//!
//! A chunk is finished when the list names it with its hash. It is written under a temporary name and
//! synced; then it is put on the list, which is synced; then it gets its name. Whatever a crash leaves
//! of that is either completed or, where it is not the bytes that the list promises, never read.

use std::collections::HashSet;
use std::fs::{self, File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use super::StoreError;
use super::chunk::Chunk;
use crate::classification::MODEL_VERSION;
use crate::engine::say;
use crate::foreign::shown_path;
use crate::table::{is_inside, make_inside, read_regular, sync_directory};

/// The list of finished chunks, a line of JSON each.
pub(super) const LIST: &str = "manifest.jsonl";
/// Many times what the list of the largest study takes, bytes.
const LONGEST_LIST: u64 = 1 << 27;
/// Many times the largest chunk, bytes.
const LARGEST_CHUNK: u64 = 1 << 30;
/// Chunks have numbers below this one.
const MOST_CHUNKS: u64 = 1 << 48;
/// How many damaged lines of a list are told of.
const MOST_TOLD: usize = 10;

/// A finished chunk, as the list has it.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Listed {
    /// Its number, which is its file's name.
    pub chunk: u64,
    /// Version of the model that its outcomes are of.
    pub model_version: u32,
    /// The number of its first run.
    pub first_run: u64,
    /// The number of its last run.
    pub last_run: u64,
    /// How many runs it has.
    pub runs: u64,
    /// Size of the file, bytes.
    pub bytes: u64,
    /// SHA-256 of its content, hexadecimal.
    pub sha256: String,
}

/// The chunks of one study in one directory.
#[derive(Clone, Debug)]
pub(super) struct Folder {
    path: PathBuf,
    /// The hash of their study, or its first digits.
    study_hash: String,
    /// Whether it is in the directory that is ours alone.
    ours: bool,
    /// Finished chunks, in the order in which they were finished: a later one stands for an earlier one
    /// where both have the same run.
    pub listed: Vec<Listed>,
    next: u64,
}

/// A file and what is wrong with it.
fn fault(path: &Path, what: impl std::fmt::Display) -> String {
    format!("{}: {what}", shown_path(path))
}

impl Folder {
    /// Reads the list of a folder; one that is not there has no chunks. Lines that cannot be read are
    /// told of. Only in a directory that is ours are chunks completed.
    ///
    /// # Errors
    /// Where the operating system refuses, or where a link leads to the folder or to its list.
    pub fn open(path: PathBuf, study_hash: &str, ours: bool) -> Result<Self, StoreError> {
        for folder in path.parent().into_iter().chain([path.as_path()]) {
            is_inside(folder)
                .map_err(|cause| StoreError::Unusable { path: folder.to_owned(), cause })?;
        }
        let list = path.join(LIST);
        let unusable = |cause| StoreError::Unusable { path: list.clone(), cause };
        let content = match read_regular(&list, LONGEST_LIST) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(Vec::new()),
            other => other,
        };
        let content = content.map_err(unusable)?;
        let mut listed: Vec<Listed> = Vec::new();
        let mut known = HashSet::new();
        let mut damaged = 0_usize;
        for (index, line) in String::from_utf8_lossy(&content).lines().enumerate() {
            match serde_json::from_str::<Listed>(line) {
                // Outcomes of another version are no outcomes of this one.
                Ok(entry) if entry.model_version != MODEL_VERSION => {}
                Ok(entry) if entry.first_run <= entry.last_run && entry.chunk < MOST_CHUNKS => {
                    if known.insert(entry.clone()) {
                        listed.push(entry);
                    }
                }
                _ => {
                    damaged += 1;
                    if damaged <= MOST_TOLD {
                        say(&format!(
                            "{}: line {} is damaged: the runs of its chunk are computed again",
                            shown_path(&list),
                            index + 1
                        ));
                    }
                }
            }
        }
        if damaged > MOST_TOLD {
            say(&format!("{}: {damaged} lines are damaged in all", shown_path(&list)));
        }
        let next = Self::next_number(&path, &listed);
        Ok(Folder { path, study_hash: study_hash.to_owned(), ours, listed, next })
    }

    /// A number that no chunk has, not even one that is not on the list.
    fn next_number(path: &Path, listed: &[Listed]) -> u64 {
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

    /// How many runs are on the list; those that are there more than once count as often.
    pub fn runs(&self) -> u64 {
        self.listed.iter().map(|entry| entry.runs).fold(0, u64::saturating_add)
    }

    /// Reads a chunk that is exactly what the list promises.
    ///
    /// # Errors
    /// What is wrong with it, in words.
    pub fn read(&self, entry: &Listed) -> Result<Chunk, String> {
        let path = self.file(entry.chunk);
        let bytes = match read_exactly(&path, entry) {
            Err(cause) if cause.kind() == io::ErrorKind::NotFound => self.adopt(&path, entry),
            other => other,
        };
        let bytes = bytes.map_err(|cause| fault(&path, cause))?;
        let chunk = Chunk::parse(bytes).map_err(|cause| fault(&path, cause))?;
        let ids = || chunk.run_ids();
        let same_study = chunk.study_hash().starts_with(&self.study_hash);
        let same_runs = ids().len() as u64 == entry.runs
            && ids().next() == Some(entry.first_run)
            && ids().last() == Some(entry.last_run);
        match same_study && same_runs {
            true => Ok(chunk),
            false => Err(fault(&path, "another chunk than the list says")),
        }
    }

    /// Completes a chunk that was on the list already but had not got its name.
    fn adopt(&self, path: &Path, entry: &Listed) -> io::Result<Vec<u8>> {
        let temporary = path.with_added_extension("partial");
        let bytes = match read_exactly(&temporary, entry) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => {
                return Err(io::Error::other("it is missing"));
            }
            other => other?,
        };
        if self.ours {
            // Where this is not allowed, the content serves all the same.
            let _ = fs::rename(&temporary, path);
        }
        Ok(bytes)
    }

    /// Puts a damaged chunk aside; it is kept.
    pub fn put_aside(&self, entry: &Listed) {
        let path = self.file(entry.chunk);
        let names = (1..100).map(|number| match number {
            1 => path.with_added_extension("damaged"),
            _ => path.with_added_extension(format!("damaged-{number}")),
        });
        let free = names.into_iter().find(|name| fs::symlink_metadata(name).is_err());
        // Where that fails it stays where it is; its number is not used again.
        let _ = free.map(|name| fs::rename(&path, name));
    }

    /// Adds a chunk to those that are finished.
    ///
    /// # Errors
    /// Where it cannot be written.
    pub fn add(&mut self, bytes: &[u8], run_ids: &[u64]) -> Result<(), StoreError> {
        let (Some(&first_run), Some(&last_run)) = (run_ids.first(), run_ids.last()) else {
            return Ok(());
        };
        let chunk = self.next;
        let path = self.file(chunk);
        let listed = Listed {
            chunk,
            model_version: MODEL_VERSION,
            first_run,
            last_run,
            runs: run_ids.len() as u64,
            bytes: bytes.len() as u64,
            sha256: hexadecimal(bytes),
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
            file.write_all(bytes)?;
            file.sync_all()?;
            self.list(&listed)?;
            fs::rename(&temporary, &path)?;
            sync_directory(&self.path)
        };
        let written = write();
        if written.is_err() {
            // Room for another try; where it is on the list already it is read as missing.
            let _ = fs::remove_file(&temporary);
        }
        written.map_err(|cause| StoreError::Unwritten { path: path.clone(), cause })?;
        self.next += 1;
        Ok(())
    }

    fn list(&self, listed: &Listed) -> io::Result<()> {
        let path = self.path.join(LIST);
        let new = match fs::symlink_metadata(&path) {
            Ok(found) if found.is_file() => false,
            Ok(_) => return Err(io::Error::other("the list of chunks is not a regular file")),
            Err(_) => true,
        };
        let mut file = OpenOptions::new().create(true).append(true).open(&path)?;
        // After a line that a crash has torn, a new one begins.
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

/// The bytes of a file that has the size and the hash that the list says.
fn read_exactly(path: &Path, entry: &Listed) -> io::Result<Vec<u8>> {
    let found = fs::symlink_metadata(path)?;
    if found.is_file() && found.len() != entry.bytes {
        let found = found.len();
        return Err(io::Error::other(format!("{found} bytes, {} on the list", entry.bytes)));
    }
    let bytes = read_regular(path, LARGEST_CHUNK)?;
    if hexadecimal(&bytes) != entry.sha256 {
        return Err(io::Error::other("its content is not what was written"));
    }
    Ok(bytes)
}

fn hexadecimal(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect()
}
