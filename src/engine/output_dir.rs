//! Prepares an output directory for a study: continues, reuses or refuses what it holds.

use std::mem::discriminant;
use std::path::{Path, PathBuf};

use super::command_error::CommandError;
use super::{CHUNKS, EngineOptions, Shard, Store, say};
use crate::classification::MODEL_VERSION;
use crate::study::{Study, changed_keys};
use crate::table::{
    EARLIER, Manifest, OutputState, Results, ResultsError, close_earlier, inspect, manifest_of,
    put_aside,
};

/// The number of differences that an error message lists.
const MOST_LINES: usize = 12;

/// An output directory and how to use it.
pub struct OutputDir<'a> {
    /// The directory.
    pub directory: &'a Path,
    /// The part of the study that goes into it.
    pub shard: Shard,
    /// Whether failed runs are computed again.
    pub retry_failed: bool,
    /// Whether to use a directory of another study even if none of its runs can be reused.
    pub recompute: bool,
    /// Directories of the study's shards, whose runs are reused.
    pub shards: &'a [PathBuf],
    /// Whether to print only warnings.
    pub quiet: bool,
}

/// A prepared directory.
pub enum PreparedDirectory {
    /// All results exist already.
    Complete(Box<Manifest>),
    /// The study can be computed.
    Open(Box<Store>, Box<Results>),
}

impl<'a> OutputDir<'a> {
    /// Returns a directory for a study without shards.
    pub fn new(directory: &'a Path, options: &EngineOptions, quiet: bool) -> Self {
        let EngineOptions { shard, retry_failed, .. } = *options;
        OutputDir { directory, shard, retry_failed, recompute: false, shards: &[], quiet }
    }

    /// Prepares the directory for a study.
    ///
    /// # Errors
    /// Returns an error, and changes nothing, if the directory holds files that are not results, results of another
    /// shard, or results of a study that shares no run with this one, if another process writes to it, or if it cannot
    /// be written to.
    pub fn prepare(&self, study: &Study) -> Result<PreparedDirectory, CommandError> {
        let shard = self.shard.to_string();
        let found = inspect(self.directory, study, &shard, &[CHUNKS, EARLIER])?;
        let report = |line: String| {
            if !self.quiet {
                say(&line);
            }
        };
        let directory = self.directory.display();
        let failed = |manifest: &Manifest| manifest.labels.get("failed").is_some_and(|&n| n > 0);
        let (mut store, has_earlier_results) = match &found {
            OutputState::Complete(manifest) if !(self.retry_failed && failed(manifest)) => {
                return Ok(PreparedDirectory::Complete(manifest.clone()));
            }
            OutputState::Unused | OutputState::Incomplete(_) => {
                (Store::open(self.directory, study)?, false)
            }
            OutputState::Complete(_) | OutputState::WithoutManifest | OutputState::Changed(..) => {
                (Store::open(self.directory, study)?, true)
            }
            OutputState::OtherStudy(manifest) => (self.reopen(study, manifest)?, true),
        };
        // Another process may have written here before the lock was taken, so the directory is inspected again.
        let locked = inspect(self.directory, study, &shard, &[CHUNKS, EARLIER])?;
        if discriminant(&locked) != discriminant(&found) {
            drop(store);
            return self.prepare(study);
        }
        if let OutputState::Changed(manifest, difference) = &found {
            let problem = match manifest.complete {
                true => "these results have been changed since they were written",
                false => "another file has the name of a result",
            };
            report(format!(
                "{directory}: {problem}: {difference}; writing them anew from the finished runs"
            ));
        }
        for part in self.shards {
            let listed = store.add_shard(part)?;
            let finished = manifest_of(part)?.map_or(0, |manifest| manifest.runs_finished);
            if listed < finished {
                say(&format!(
                    "{}: only {listed} of its {finished} finished runs are listed in {CHUNKS}/: the \
                     others are computed again",
                    part.display()
                ));
            }
        }
        let unfinished = match &found {
            OutputState::Incomplete(_) => true,
            OutputState::Changed(manifest, _) => !manifest.complete,
            _ => false,
        };
        if unfinished && self.shards.is_empty() {
            report(format!(
                "{directory}: continuing this study; up to {} of its runs are finished",
                store.listed_runs(),
            ));
        }
        if has_earlier_results {
            let place = put_aside(self.directory)?;
            report(format!("earlier results moved to {}", place.display()));
        } else {
            close_earlier(self.directory)?;
        }
        let results = Results::create(self.directory, study)?;
        let merging = self.merging();
        let announced =
            matches!(&found, OutputState::Incomplete(before) if before.merging == merging);
        if !announced {
            results.announce(&Manifest { merging, ..Manifest::begin(study, self.shard) })?;
        }
        Ok(PreparedDirectory::Open(Box::new(store), Box::new(results)))
    }

    /// Returns the directories that are merged, for the manifest.
    pub fn merging(&self) -> Vec<String> {
        self.shards.iter().map(|part| part.display().to_string()).collect()
    }

    /// Opens the store of a directory with results of another study if this study can reuse any of its runs.
    fn reopen(&self, study: &Study, manifest: &Manifest) -> Result<Store, CommandError> {
        let store = match self.directory.join(CHUNKS).is_dir() || self.recompute {
            true => Some(Store::open(self.directory, study)?),
            false => None,
        };
        let shared = |store: &Store| {
            store.listed_runs() > 0
                || store.has_others()
                    && self.shard.first_run_ids(study).any(|run_id| store.can_reuse(study, run_id))
        };
        match store {
            Some(store) if self.recompute || shared(&store) => Ok(store),
            _ => Err(self.refusal(study, manifest).into()),
        }
    }

    fn refusal(&self, study: &Study, manifest: &Manifest) -> ResultsError {
        let mut lines = Vec::new();
        if manifest.model_version != MODEL_VERSION {
            lines.push(format!(
                "version of the model: {} -> {MODEL_VERSION} (stickslip {} -> {})",
                manifest.model_version,
                manifest.version,
                env!("CARGO_PKG_VERSION")
            ));
        }
        match Study::load(&self.directory.join("study.yaml")) {
            Ok(before) => lines.extend(changed_keys(&before, study)),
            Err(_) => lines.push("its study.yaml can no longer be read".to_owned()),
        }
        if let (true, Some(version)) = (lines.is_empty(), study.model().own_version()) {
            let kind = study.model().kind().name;
            lines.push(format!("version of the equations of {kind}: another one -> {version}"));
        }
        let more = lines.len().saturating_sub(MOST_LINES);
        lines.truncate(MOST_LINES);
        if more > 0 {
            lines.push(format!("and {more} more"));
        }
        let reason = "this directory contains the results of another study, and none of its runs can be reused";
        let found =
            format!("study {}; it differs in\n    {}", manifest.study, lines.join("\n    "));
        let allowed = match self.shards {
            [] => format!(
                "another directory, with --out DIR; or --recompute, which moves those results to \
                 {EARLIER}/ and computes all runs"
            ),
            _ => "another directory, with --out DIR".to_owned(),
        };
        ResultsError::occupied(self.directory, reason, found, allowed)
    }
}
