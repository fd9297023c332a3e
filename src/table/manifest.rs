//! `manifest.json`: what an output directory holds, and when, where and how it was made.

use std::collections::BTreeMap;
use std::fs;
use std::io::{self, Read};
use std::path::{Component, Path};

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use super::directory::sync_directory;
use super::provenance::{COMMIT, FORMAT, VERSION};
use super::results::Circumstances;
use crate::analysis::LabelCounts;
use crate::ending::{Label, MODEL_VERSION};
use crate::study::Study;

/// Name of the manifest in an output directory.
pub const MANIFEST: &str = "manifest.json";

/// The largest manifest that is read, bytes.
const MAX_BYTES: u64 = 4 * 1024 * 1024;

/// The manifest. Times and host are here and nowhere else.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Manifest {
    /// Version of the layout.
    pub format: u32,
    /// Name of the study.
    pub study: String,
    /// Hash of what decides its runs.
    pub study_hash: String,
    /// Version of the program.
    pub version: String,
    /// Commit that the program was built from.
    pub commit: String,
    /// Version of what decides outcomes; results of another are not used again.
    #[serde(default)]
    pub model_version: u32,
    /// Part of the study that was run, as `K/N`.
    pub shard: String,
    /// Runs planned in this part; with a precision, the most.
    pub runs_planned: u64,
    /// Runs finished, failed ones included.
    pub runs_finished: u64,
    /// Finished runs that did not have to be computed: they were on disk already.
    #[serde(default)]
    pub runs_kept: u64,
    /// Runs per label.
    pub labels: BTreeMap<String, u64>,
    /// Whether all planned runs are finished; with a precision, all that it needs.
    pub complete: bool,
    /// When it started, seconds since 1970-01-01 UTC.
    pub started_unix_s: f64,
    /// How long it took, s.
    pub wall_s: f64,
    /// Worker threads.
    pub threads: usize,
    /// Directories of the shards that are being merged, as they were given; none where runs are computed,
    /// and none once all are merged.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub merging: Vec<String>,
    /// Name of the machine.
    pub host: String,
    /// The data files; of a table that is a directory, each of its parts.
    pub files: BTreeMap<String, FileEntry>,
}

/// A data file in the manifest.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct FileEntry {
    /// Rows of the table; none for a file that is not a table.
    pub rows: Option<u64>,
    /// Size, bytes.
    pub bytes: u64,
    /// SHA-256 of its content, hexadecimal.
    pub sha256: String,
}

impl FileEntry {
    /// The entry of a file on disk.
    ///
    /// # Errors
    /// Where the file cannot be read.
    pub fn of(path: &Path, rows: Option<u64>) -> io::Result<Self> {
        let mut hasher = HashWriter { hasher: Sha256::new(), bytes: 0 };
        io::copy(&mut fs::File::open(path)?, &mut hasher)?;
        let digest = hasher.hasher.finalize();
        let sha256 = digest.iter().map(|byte| format!("{byte:02x}")).collect();
        Ok(FileEntry { rows, bytes: hasher.bytes, sha256 })
    }
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
    /// The manifest of what has been done of a study.
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
            // What is merged is a directory like any other.
            merging: if complete { Vec::new() } else { merging },
            host: gethostname::gethostname().to_string_lossy().into_owned(),
            files,
        }
    }

    /// Reads the manifest of a directory; none where there is no such file.
    ///
    /// # Errors
    /// Where there is one that cannot be read; of the kind `InvalidData` where it is not a manifest.
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
                manifest.check_names()?;
                Ok(Some(manifest))
            }
            Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
            Err(error) => Err(error),
        }
    }

    /// Whether every file is one of the directory itself.
    fn check_names(&self) -> io::Result<()> {
        let inside = |part: Component<'_>| matches!(part, Component::Normal(_));
        let plain = |name: &str| !name.is_empty() && Path::new(name).components().all(inside);
        match self.files.keys().find(|name| !plain(name)) {
            None => Ok(()),
            Some(name) => {
                let found: String = name.escape_debug().take(100).collect();
                let problem = format!("{MANIFEST} names a file outside of its directory: {found}");
                Err(io::Error::new(io::ErrorKind::InvalidData, problem))
            }
        }
    }

    /// Writes the manifest into a directory, whole or not at all.
    ///
    /// # Errors
    /// Where it cannot be written.
    pub fn write(&self, directory: &Path) -> io::Result<()> {
        let text = serde_json::to_string_pretty(self).map_err(io::Error::other)? + "\n";
        write_atomically(&directory.join(MANIFEST), text.as_bytes())
    }
}

/// Reads a regular file of at most so many bytes.
///
/// # Errors
/// Where it is another thing, a link included, larger, or cannot be read.
pub(crate) fn read_regular(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    // Asked before it is opened: opening a named pipe would wait for a writer, and a link may lead anywhere.
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

/// Writes a file whose place nothing else may lose: where it is there already, it has this very content, and
/// is left as it is.
///
/// # Errors
/// Where something else has the name, of the kind `AlreadyExists`; where it cannot be written.
pub fn write_once(path: &Path, content: &[u8]) -> io::Result<()> {
    match fs::symlink_metadata(path) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => write_atomically(path, content),
        Err(error) => Err(error),
        Ok(found) => {
            let same = found.is_file()
                && found.len() == content.len() as u64
                && read_regular(path, found.len())? == content;
            if same { Ok(()) } else { Err(taken()) }
        }
    }
}

/// Something else has the name of a file that is to be written.
pub(super) fn taken() -> io::Error {
    let problem = "its name belongs to something else, which is not replaced";
    io::Error::new(io::ErrorKind::AlreadyExists, problem)
}

/// Writes a file under a temporary name, syncs it and renames it.
///
/// # Errors
/// Where it cannot be written or renamed.
pub fn write_atomically(path: &Path, content: &[u8]) -> io::Result<()> {
    use std::io::Write;
    let temporary = path.with_added_extension("partial");
    // Whatever has that name, a link or a pipe, is replaced, never written through.
    match fs::remove_file(&temporary) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => return Err(error),
        _ => {}
    }
    let mut file = fs::File::create_new(&temporary)?;
    file.write_all(content)?;
    file.sync_all()?;
    fs::rename(&temporary, path)?;
    sync_directory(path.parent().unwrap_or(Path::new("")))
}
