//! `manifest.json`: the content of an output directory, and when, where and how it was made.

use std::collections::BTreeMap;
use std::fs;
use std::io::{self, Read};
use std::path::Path;

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use super::checked::{Listed, is_file_name};
use super::provenance::{COMMIT, FORMAT, VERSION};
use super::read::TableError;
use super::results::{Circumstances, RUNS};
use super::temporary::write_atomically;
use crate::analysis::LabelCounts;
use crate::classification::{Label, MODEL_VERSION};
use crate::foreign::{is_acted_on, one_line, shell_word, shorten};
use crate::study::Study;

/// Name of the manifest in an output directory.
pub const MANIFEST: &str = "manifest.json";

/// The largest manifest that is read, in bytes.
const MAX_BYTES: u64 = 4 * 1024 * 1024;

/// The largest number of characters of a text in a manifest.
const LONGEST_TEXT: usize = 256;

/// The manifest. No other file contains times or the host.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Manifest {
    /// Version of the layout.
    pub format: u32,
    /// Name of the study.
    pub study: String,
    /// Hash of everything that determines the runs.
    pub study_hash: String,
    /// Version of the program.
    pub version: String,
    /// Commit that the program was built from.
    pub commit: String,
    /// Version of the outcomes; results of another version are not reused.
    #[serde(default)]
    pub model_version: u32,
    /// Part of the study that was run, as `K/N`.
    pub shard: String,
    /// Planned runs of this part; with a precision, the largest number.
    pub runs_planned: u64,
    /// Finished runs, including failed runs.
    pub runs_finished: u64,
    /// Finished runs that were reused from disk.
    #[serde(default)]
    pub runs_kept: u64,
    /// Runs per label.
    pub labels: BTreeMap<String, u64>,
    /// Whether all planned runs have finished; with a precision, all runs that the precision
    /// requires.
    pub complete: bool,
    /// Start time, in seconds since 1970-01-01 UTC.
    pub started_unix_s: f64,
    /// Duration, s.
    pub wall_s: f64,
    /// Number of worker threads.
    pub threads: usize,
    /// Directories of the shards that are being merged, as given. Empty if runs are computed, and
    /// after the merge is complete.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub merging: Vec<String>,
    /// Name of the host.
    pub host: String,
    /// The data files; for a table that is a directory, each of its parts.
    pub files: BTreeMap<String, FileEntry>,
}

/// A data file in the manifest.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct FileEntry {
    /// Number of rows; `None` for a file that is not a table.
    pub rows: Option<u64>,
    /// Size in bytes.
    pub bytes: u64,
    /// SHA-256 hash of the content, in hexadecimal.
    pub sha256: String,
}

impl FileEntry {
    /// Creates the entry of a file on disk.
    ///
    /// # Errors
    /// Returns an error if the file cannot be read.
    pub fn of(path: &Path, rows: Option<u64>) -> io::Result<Self> {
        let mut hasher = HashWriter { hasher: Sha256::new(), bytes: 0 };
        io::copy(&mut fs::File::open(path)?, &mut hasher)?;
        Ok(FileEntry { rows, bytes: hasher.bytes, sha256: hexadecimal(&hasher.hasher.finalize()) })
    }

    /// Creates the entry of a file that has this content and is not a table.
    pub(super) fn of_content(content: &[u8]) -> Self {
        let sha256 = hexadecimal(&Sha256::digest(content));
        FileEntry { rows: None, bytes: content.len() as u64, sha256 }
    }

    /// Returns whether two files have the same content.
    pub(super) fn has_content_of(&self, other: &Self) -> bool {
        (self.bytes, &self.sha256) == (other.bytes, &other.sha256)
    }
}

fn hexadecimal(digest: &[u8]) -> String {
    digest.iter().map(|byte| format!("{byte:02x}")).collect()
}

struct HashWriter {
    hasher: Sha256,
    bytes: u64,
}

impl io::Write for HashWriter {
    fn write(&mut self, content: &[u8]) -> io::Result<usize> {
        self.hasher.update(content);
        self.bytes += content.len() as u64;
        Ok(content.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Manifest {
    /// Creates the manifest of the results of a study.
    pub fn new(
        study: &Study,
        circumstances: Circumstances,
        counts: LabelCounts,
        files: BTreeMap<String, FileEntry>,
    ) -> Self {
        let Circumstances { shard, runs_planned, runs_kept, complete, merging, .. } = circumstances;
        let label = |label: Label| (label.name().to_owned(), counts.of(label));
        Manifest {
            format: FORMAT,
            study: study.name().to_owned(),
            study_hash: study.hash(),
            version: VERSION.to_owned(),
            commit: COMMIT.to_owned(),
            model_version: MODEL_VERSION,
            shard,
            runs_planned,
            runs_finished: counts.total(),
            runs_kept,
            labels: Label::ALL.into_iter().map(label).collect(),
            complete,
            started_unix_s: circumstances.started_unix_s,
            wall_s: circumstances.wall_s,
            threads: circumstances.threads,
            // A merged directory is like any other.
            merging: if complete { Vec::new() } else { merging },
            host: gethostname::gethostname().to_string_lossy().into_owned(),
            files,
        }
    }

    /// Reads the manifest of a directory, or returns `None` if there is no such file.
    ///
    /// # Errors
    /// Returns an error if the manifest cannot be read, with the kind `InvalidData` if it is not a
    /// manifest.
    pub fn read(directory: &Path) -> io::Result<Option<Self>> {
        match read_regular(&directory.join(MANIFEST), MAX_BYTES) {
            Ok(bytes) => {
                let invalid = |error| io::Error::new(io::ErrorKind::InvalidData, error);
                let manifest: Self = serde_json::from_slice(&bytes).map_err(invalid)?;
                if manifest.format != FORMAT {
                    let format = manifest.format;
                    let problem = format!("{MANIFEST} has layout {format}; allowed: {FORMAT}");
                    return Err(io::Error::new(io::ErrorKind::InvalidData, problem));
                }
                let checked = manifest.check_names().and_then(|()| manifest.check_values());
                let damaged = |problem| io::Error::new(io::ErrorKind::InvalidData, problem);
                checked.map(|()| Some(manifest)).map_err(damaged)
            }
            Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
            Err(error) => Err(error),
        }
    }

    /// Checks that every file is in the directory itself.
    fn check_names(&self) -> Result<(), String> {
        match self.files.keys().find(|name| !is_file_name(name)) {
            None => Ok(()),
            Some(name) => {
                let found = one_line(name, LONGEST_TEXT);
                Err(format!("{MANIFEST} names a file outside of its directory: {found}"))
            }
        }
    }

    /// Checks the values: texts must be printable, the shard must be valid, and the numbers of runs
    /// must be consistent.
    fn check_values(&self) -> Result<(), String> {
        let names = self.files.keys().chain(self.labels.keys());
        let texts = [&self.study, &self.study_hash, &self.version, &self.commit, &self.host];
        let shown =
            |text: &&String| text.chars().count() > LONGEST_TEXT || text.chars().any(is_acted_on);
        if let Some(text) = texts.into_iter().chain(names).find(shown) {
            return Err(format!("{MANIFEST} has a text that cannot be shown: {}", shorten(text)));
        }
        let numbers = self.shard.split_once('/').map(|(part, of)| (part.parse(), of.parse()));
        let is_part = |(part, parts): (u64, u64)| {
            (1..=parts).contains(&part) && self.shard == format!("{part}/{parts}")
        };
        if !matches!(numbers, Some((Ok(part), Ok(parts))) if is_part((part, parts))) {
            let found = shorten(&self.shard);
            return Err(format!("`shard` in {MANIFEST} is {found:?}; allowed: K/N, such as 2/8"));
        }
        let finished = self.runs_finished;
        let of_labels = self.labels.values().copied().fold(0, u64::saturating_add);
        let is_run_table = |name: &str| name == RUNS || name.starts_with(&format!("{RUNS}/"));
        let tables = self.files.iter().filter(|(name, _)| is_run_table(name));
        let rows = tables.map(|(_, entry)| entry.rows.unwrap_or(0)).reduce(u64::saturating_add);
        if of_labels != finished || rows.is_some_and(|rows| rows != finished) {
            return Err(format!(
                "{MANIFEST} says {finished} finished runs, {of_labels} by label and {} in {RUNS}",
                rows.map_or("none".to_owned(), |rows| rows.to_string())
            ));
        }
        Ok(())
    }

    /// Checks a file of the manifest's directory against the manifest, if the manifest lists it.
    ///
    /// # Errors
    /// Returns an error if the file differs from the manifest.
    pub fn check_file(&self, directory: &Path, name: &str) -> Result<(), TableError> {
        let remedy = self.remedy(directory);
        let entry = self.files.get(name);
        let listed = self.in_directory(directory, &remedy);
        entry.map_or(Ok(()), |entry| listed.check(name, entry).map(drop))
    }

    /// Returns the files of the manifest in their directory, with [`Self::remedy`].
    pub(super) fn in_directory<'a>(&'a self, directory: &'a Path, remedy: &'a str) -> Listed<'a> {
        Listed { directory, list: MANIFEST, files: &self.files, remedy }
    }

    /// Returns what to do about a file that differs from the manifest.
    pub(super) fn remedy(&self, directory: &Path) -> String {
        format!("`stickslip resume {}` recreates it from the finished runs", shell_word(directory))
    }

    /// Writes the manifest into a directory atomically.
    ///
    /// # Errors
    /// Returns an error if the manifest cannot be written.
    pub fn write(&self, directory: &Path) -> io::Result<()> {
        let text = serde_json::to_string_pretty(self).map_err(io::Error::other)? + "\n";
        write_atomically(&directory.join(MANIFEST), text.as_bytes())
    }
}

/// Reads a regular file of at most `most` bytes.
///
/// # Errors
/// Returns an error if the file is not regular (for example, a link), is larger, or cannot be read.
pub(crate) fn read_regular(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    // Checked before opening: opening a named pipe would wait for a writer, and a link may lead
    // anywhere.
    if !fs::symlink_metadata(path)?.is_file() {
        return Err(io::Error::other("not a regular file"));
    }
    let mut bytes = Vec::new();
    fs::File::open(path)?.take(most + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > most {
        return Err(io::Error::other(format!("larger than {most} bytes")));
    }
    Ok(bytes)
}
