//! A run that is computed again with its motion, compared with its stored row, and written as tables and an animation.

use std::path::Path;

use serde_json::{Value, json};

use super::animation::{ANIMATION, animate};
use crate::classification::RecordedRun;
use crate::engine::{CommandError, ExclusiveDirectory, MOST_INSTANTS, finished_run, record};
use crate::study::Study;
use crate::table::{
    Difference, FILES, FileList, Manifest, RunRecord, StoredRun, Table, provenance_with,
    switch_columns, touch_columns, trajectory_columns,
};

/// The table of switches.
pub const SWITCHES: &str = "switches.parquet";
const TRAJECTORY: &str = "trajectory.parquet";
const TOUCHES: &str = "touches.parquet";
/// All files that a replay may write.
const OWN: [&str; 4] = [TRAJECTORY, SWITCHES, TOUCHES, ANIMATION];

/// A run that has been computed again.
pub struct Replay {
    /// The run.
    pub record: RunRecord,
    /// Its motion.
    pub recording: RecordedRun,
    /// The differences from the stored row; `None` if there is no stored row.
    pub differences: Option<Vec<Difference>>,
    /// The number of compared columns.
    pub columns: usize,
    /// The times of the motion, s; `None` for every step.
    pub times_s: Option<Vec<f64>>,
}

impl Replay {
    /// Computes a run of a directory of results again, at the given times (ascending, in s) or at every step.
    ///
    /// # Errors
    /// Returns an error if the directory lacks this run, or if the motion is too long.
    pub fn of_directory(
        directory: &Path,
        (study, manifest): (&Study, &Manifest),
        run_id: u64,
        times_s: Option<Vec<f64>>,
    ) -> Result<Replay, CommandError> {
        let stored = stored_run(directory, study, manifest, run_id)?;
        let mut replay = Replay::of_study(study, run_id, times_s)?;
        if let Some(stored) = stored {
            replay.differences = Some(stored.differences(study, &replay.record)?);
            replay.columns = StoredRun::columns(&stored);
        }
        Ok(replay)
    }

    /// Computes a run of a study without a stored row to compare.
    ///
    /// # Errors
    /// Returns an error if the motion is too long.
    ///
    /// # Panics
    /// If `run_id` is not below [`crate::study::Plan::run_count`].
    pub fn of_study(
        study: &Study,
        run_id: u64,
        times_s: Option<Vec<f64>>,
    ) -> Result<Replay, CommandError> {
        let (record, recording) = record(study, run_id, times_s.as_deref());
        if recording.cut_off {
            let what = format!("the motion of run {run_id} is too long");
            let found = format!("more than {MOST_INSTANTS} steps, switches or impacts");
            let allowed =
                "fewer; choose an interval with --times FROM:TO:N, or with `times_s` in Python";
            return Err(CommandError::refusal(what, found, allowed));
        }
        Ok(Replay { record, recording, differences: None, columns: 0, times_s })
    }

    /// Returns the times after the end of the run, at which there is no motion.
    pub fn times_after_end_s(&self) -> &[f64] {
        let times = self.times_s.as_deref().unwrap_or_default();
        &times[self.recording.samples.len().min(times.len())..]
    }

    /// Returns the options of the replay, for the provenance of its tables.
    pub fn options(&self) -> Value {
        let times = self.times_s.as_ref();
        json!({
            "run_id": self.record.planned.run_id,
            "times": times.map(|times| json!([times.first(), times.last(), times.len()])),
        })
    }

    /// Checks that a directory can hold a replay: it is empty, missing, or left unfinished by an earlier replay.
    ///
    /// # Errors
    /// Returns an error if the directory holds anything else or cannot be read.
    pub fn inspect(out: &Path) -> Result<(), CommandError> {
        Ok(ExclusiveDirectory::inspect(out, &OWN)?)
    }

    /// Writes the tables and the animation of a run of the study, and returns the names of the files.
    ///
    /// # Errors
    /// Returns an error if the directory holds anything else, or if a file cannot be written.
    pub fn write(&self, study: &Study, out: &Path) -> Result<Vec<&'static str>, CommandError> {
        let mut place = ExclusiveDirectory::open(out, &OWN)?;
        let mut files = self.write_tables(study, out, &mut place.list)?;
        let times = self.times_s.as_deref();
        let interval = times.and_then(|times| Some([*times.first()?, *times.last()?]));
        if animate(out, &mut place.list, study, &self.record, interval)? {
            files.push(ANIMATION);
        }
        files.push(FILES);
        place.finish()?;
        Ok(files)
    }

    fn write_tables(
        &self,
        study: &Study,
        out: &Path,
        list: &mut FileList,
    ) -> Result<Vec<&'static str>, CommandError> {
        let Replay { record, recording, .. } = self;
        let options = self.options();
        let about = |name| provenance_with(study, name, &options);
        // Invalid parameters have no units; the table is then empty.
        let model = record.planned.case.as_ref().map_or(study.model(), |case| &case.model);
        let gaps = model.gaps(&record.planned.start);
        let columns = trajectory_columns(model, gaps.as_deref().unwrap_or_default());
        let samples = recording.samples.iter().cloned();
        list.write_table(out, "trajectory", &about("trajectory"), columns, samples, false)?;
        let (columns, switches) = (switch_columns(model), recording.switches.iter().cloned());
        list.write_table(out, "switches", &about("switches"), columns, switches, false)?;
        if gaps.is_none() {
            return Ok(vec![TRAJECTORY, SWITCHES]);
        }
        let (columns, touches) = (touch_columns(model), recording.touches.iter().cloned());
        list.write_table(out, "touches", &about("touches"), columns, touches, false)?;
        Ok(vec![TRAJECTORY, SWITCHES, TOUCHES])
    }
}

/// Returns the row of a run, from the table or from the finished runs; `None` if the results are incomplete and lack it.
fn stored_run(
    directory: &Path,
    study: &Study,
    manifest: &Manifest,
    run_id: u64,
) -> Result<Option<StoredRun>, CommandError> {
    let runs = study.run_count();
    let refused = |found: String, allowed: String| {
        let what = format!("{}: there is no such run", directory.display());
        Err(CommandError::refusal(what, found, allowed))
    };
    if run_id >= runs {
        let allowed = match runs {
            0 => "nothing: this study has no runs".to_owned(),
            _ => format!("run numbers from 0 to {}", runs - 1),
        };
        return refused(format!("run {run_id} of a study with {runs} runs"), allowed);
    }
    let stored = StoredRun::find(directory, manifest, run_id)?;
    if stored.is_some() {
        return Ok(stored);
    }
    if !manifest.complete {
        // The study is running or was killed, or its last tables are older than its finished runs.
        let finished = finished_run(study, directory, run_id)?;
        let stored = finished.map(|record| StoredRun::of_record(directory, study, &record));
        return Ok(stored.transpose()?);
    }
    if study.precision().is_some() {
        let point = study.point(study.planned_run(run_id).point_id);
        let computed = runs_of_point(directory, manifest, point.point_id)?;
        if computed > 0 {
            let (first, number) = (point.first_run, point.point_id);
            let found = format!(
                "run {run_id}, which was not computed: point {number} reached the `precision` of the study \
                 after {computed} runs"
            );
            let last = first + computed - 1;
            let allowed = format!("run numbers from {first} to {last} at point {number}");
            return refused(found, allowed);
        }
    }
    let found = format!(
        "run {run_id}, which is not among the {} runs of these results (shard {})",
        manifest.runs_finished, manifest.shard
    );
    refused(found, "a run_id of runs.parquet; other shards have the other runs".to_owned())
}

/// Returns the number of computed runs of a point, which are its first ones; 0 if another shard has the point.
fn runs_of_point(
    directory: &Path,
    manifest: &Manifest,
    point_id: u64,
) -> Result<u64, CommandError> {
    let points = Table::open(directory, manifest, "points")?;
    let mut found = 0;
    points.for_each(|row| {
        let known = row.count("point_id").zip(row.count("runs"));
        found = known.filter(|(point, _)| *point == point_id).map_or(found, |(_, runs)| runs);
    })?;
    Ok(found)
}
