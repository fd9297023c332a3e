//! `manifest.json`: the content of an output directory, and when, where and how it was made.

use std::collections::BTreeMap;
use std::io;
use std::path::Path;
use std::time::{SystemTime, UNIX_EPOCH};

use serde::{Deserialize, Serialize};

use super::durable_files::write_atomically;
use super::file_entry::{FileEntry, ListedFiles, is_file_name, read_regular};
use super::provenance::{COMMIT, FORMAT, VERSION};
use super::shard::Shard;
use super::table_error::TableError;
use crate::analysis::{FailureCounts, LabelCounts};
use crate::classification::{Label, MODEL_VERSION};
use crate::motion::SimdLevel;
use crate::sanitize::{is_acted_on, one_line, shell_word, shorten};
use crate::study::Study;

/// Name of the manifest in an output directory.
pub const MANIFEST: &str = "manifest.json";
/// Name of the table of runs.
pub(super) const RUNS: &str = "runs.parquet";

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
    /// Failed runs per kind of failure; empty in results of earlier versions.
    #[serde(default)]
    pub failures: BTreeMap<String, u64>,
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
    /// The vector instructions, and whether recorded equations run as machine code or in an interpreter. The results do not
    /// depend on it.
    #[serde(default)]
    pub computed_by: String,
    /// The data files; for a table that is a directory, each of its parts.
    pub files: BTreeMap<String, FileEntry>,
}

impl Manifest {
    /// Returns the manifest of a part of a study that is about to start.
    pub fn begin(study: &Study, shard: Shard) -> Self {
        // A clock before 1970 is wrong.
        let started = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
        let begun = Manifest {
            format: FORMAT,
            study: study.name().to_owned(),
            study_hash: study.hash(),
            version: VERSION.to_owned(),
            commit: COMMIT.to_owned(),
            model_version: MODEL_VERSION,
            shard: shard.to_string(),
            runs_planned: shard.most_runs(study),
            runs_finished: 0,
            runs_kept: 0,
            labels: BTreeMap::new(),
            failures: BTreeMap::new(),
            complete: false,
            started_unix_s: started.as_secs_f64(),
            wall_s: 0.0,
            threads: 0,
            merging: Vec::new(),
            host: gethostname::gethostname().to_string_lossy().into_owned(),
            computed_by: SimdLevel::best().path(),
            files: BTreeMap::new(),
        };
        begun.with_runs(LabelCounts::default(), &FailureCounts::default())
    }

    /// Sets the numbers of finished runs.
    pub fn with_runs(mut self, counts: LabelCounts, failures: &FailureCounts) -> Self {
        let label = |label: Label| (label.name().to_owned(), counts.of(label));
        self.labels = Label::ALL.into_iter().map(label).collect();
        self.runs_finished = counts.total();
        self.failures = failures.by_name();
        self
    }

    /// Reads the manifest of a directory, or returns `None` if there is no such file.
    ///
    /// # Errors
    /// Returns an error if the manifest cannot be read, with the kind `InvalidData` if it is not a
    /// manifest.
    pub fn read(directory: &Path) -> io::Result<Option<Self>> {
        let bytes = match read_regular(&directory.join(MANIFEST), MAX_BYTES) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
            read => read?,
        };
        let invalid = |problem: String| io::Error::new(io::ErrorKind::InvalidData, problem);
        let manifest: Self =
            serde_json::from_slice(&bytes).map_err(|error| invalid(error.to_string()))?;
        if manifest.format != FORMAT {
            let format = manifest.format;
            return Err(invalid(format!("{MANIFEST} has layout {format}; allowed: {FORMAT}")));
        }
        manifest.check_names().and_then(|()| manifest.check_values()).map_err(invalid)?;
        Ok(Some(manifest))
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
        let names = self.files.keys().chain(self.labels.keys()).chain(self.failures.keys());
        let texts = [&self.study, &self.study_hash, &self.version, &self.commit];
        let texts = texts.into_iter().chain([&self.host, &self.computed_by]);
        let shown =
            |text: &&String| text.chars().count() > LONGEST_TEXT || text.chars().any(is_acted_on);
        if let Some(text) = texts.chain(names).find(shown) {
            return Err(format!("{MANIFEST} has a text that cannot be shown: {}", shorten(text)));
        }
        if !self.shard.parse::<Shard>().is_ok_and(|shard| shard.to_string() == self.shard) {
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
        let entry = self.files.get(name);
        entry.map_or(Ok(()), |entry| self.in_directory(directory).check(name, entry).map(drop))
    }

    /// Returns the files of the manifest in their directory.
    pub(super) fn in_directory<'a>(&'a self, directory: &'a Path) -> ListedFiles<'a> {
        let directory_word = shell_word(directory);
        let remedy =
            format!("`stickslip resume {directory_word}` recreates it from the finished runs");
        ListedFiles { directory, list: MANIFEST, files: &self.files, remedy }
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
