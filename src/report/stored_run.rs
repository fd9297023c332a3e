//! The stored row of a run, with which a replay compares.

use std::path::Path;

use crate::engine::{CommandError, finished_run};
use crate::study::Study;
use crate::table::{Manifest, StoredRun, Table};

/// Returns the row of a run, from the table or from the finished runs; `None` if the results are incomplete and lack it.
pub fn stored_run(
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
