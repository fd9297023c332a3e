//! `stickslip replay`: computes one run again with its motion.

use std::io::{self, IsTerminal};
use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::{Value, json};

use super::exclusive_directory::ExclusiveDirectory;
use super::exit::{CliError, End};
use super::output::{print, print_json};
use super::overwrite::beside;
use super::range::{MOST_TIMES, Times};
use super::replay_animation::{ANIMATION, animate};
use super::replay_text::{switch_log, terminal_text};
use super::results_study::results_study;
use crate::classification::Recording;
use crate::engine::{finished_run, record, say};
use crate::sanitize::{one_line, shorten};
use crate::study::Study;
use crate::table::column::Column;
use crate::table::{
    Difference, FILES, FileList, Kind, Manifest, RunRecord, StoredRun, Table, TableWriter,
    provenance_with, switch_columns, touch_columns, trajectory_columns,
};

const EXAMPLES: &str = "\
Examples:
  stickslip replay results/night 17
  stickslip replay results/night 17 --times 0:5:2001 --out figure-3
  stickslip replay results/night 17 | head

Computes the run again with the same engine and compares it with its stored row: all columns, to the \
last bit. If they differ, for example on another kind of processor, it prints the differences and ends with exit \
code 1. Writes trajectory.parquet (angle and speed of table and balls, phase, friction and friction limit of \
each ball), switches.parquet (each change between stick and slip) and replay.html (an animation for any browser); for \
balls with contact also the gaps between them, and touches.parquet (each impact, and each end of lasting contact); for a \
disc that starts or a table that is kicked also the speed of the disc. \
Prints all changes between stick and slip, and all impacts, to a pipe or a file; a terminal shows a summary and the first \
of them. The Python package's `stickslip-figures` draws figures for papers from these tables.";

/// The number of characters of a run's error message that are printed.
const LONGEST_ERROR: usize = 400;

/// Compute one run of a study again and write its motion
#[derive(Clone, Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct ReplayArguments {
    /// Directory with the results of a study, finished or not
    #[arg(value_name = "DIR")]
    directory: PathBuf,

    /// Number of the run: column run_id of runs.parquet
    #[arg(value_name = "RUN_ID", value_parser = run_number, allow_negative_numbers = true)]
    run_id: u64,

    /// Directory for the motion; never overwritten [default: DIR-replay-RUN_ID]
    ///
    /// It may not lie in DIR, whose manifest names all files of the study.
    #[arg(long, short, value_name = "DIR2")]
    out: Option<PathBuf>,

    /// Write the motion at N times from FROM to TO, both included, in s; the animation shows this interval
    #[arg(long, value_name = "FROM:TO:N", conflicts_with = "every_step")]
    #[arg(allow_hyphen_values = true)]
    times: Option<Times>,

    /// Write the motion at the end of every integration step, and before and after each switch; the default
    ///
    /// Steps are as short as the motion needs; evenly spaced times may miss events between them.
    #[arg(long)]
    every_step: bool,

    /// Print the result as JSON
    #[arg(long)]
    json: bool,
}

fn run_number(text: &str) -> Result<u64, String> {
    text.parse().map_err(|_| format!("found {text:?}, allowed: a whole number from 0, as in 17"))
}

const TRAJECTORY: &str = "trajectory.parquet";
const SWITCHES: &str = "switches.parquet";
const TOUCHES: &str = "touches.parquet";
/// All files that a replay may write.
const OWN: [&str; 4] = [TRAJECTORY, SWITCHES, TOUCHES, ANIMATION];

/// Computes the run again and writes its motion.
///
/// # Errors
/// Returns an error if the directory holds no results or not this run, or if a table cannot be written.
pub fn replay(arguments: &ReplayArguments) -> Result<End, CliError> {
    let ReplayArguments { directory, run_id, .. } = arguments;
    let (study, manifest) = results_study(directory)?;
    let stored = stored_run(directory, &study, &manifest, *run_id)?;
    let usual = || beside(directory, &format!("-replay-{run_id}"));
    let out = arguments.out.clone().map_or_else(usual, Ok)?;
    ExclusiveDirectory::inspect(&out, &OWN)?;
    let times = arguments.times.map(|times| times.values().collect::<Vec<f64>>());
    let (record, recording) = record(&study, *run_id, times.as_deref(), MOST_TIMES as usize);
    if recording.cut_off {
        let what = format!("the motion of run {run_id} is too long");
        let found = format!("more than {MOST_TIMES} steps, switches or impacts");
        let allowed = "fewer; choose an interval with --times FROM:TO:N";
        return Err(CliError::refusal(what, found, allowed));
    }
    let differences = match &stored {
        Some(stored) => Some(stored.differences(&study, &record)?),
        None => None,
    };
    let mut place = ExclusiveDirectory::open(&out, &OWN)?;
    let mut files = write(&out, &mut place.list, &study, arguments, &record, &recording)?;
    if animate(&out, &mut place.list, &study, &record, arguments.times)? {
        files.push(ANIMATION);
    }
    files.push(FILES);
    place.finish()?;
    let (out, study) = (&*out, &study);
    let report = Report { directory, out, study, record, recording, differences, files };
    let manifest = stored.is_none().then_some(&manifest);
    report.say(arguments.times, stored.as_ref().map_or(0, StoredRun::columns), manifest);
    match arguments.json {
        true => print_json(&format!("{:#}\n", report.json()))?,
        false => print(&report.text())?,
    };
    let same = report.differences.is_none_or(|differences| differences.is_empty());
    Ok(if same { End::Well } else { End::NotReproduced })
}

/// Returns the row of a run, from the table or from the finished runs; `None` if the results are incomplete and lack it.
fn stored_run(
    directory: &Path,
    study: &Study,
    manifest: &Manifest,
    run_id: u64,
) -> Result<Option<StoredRun>, CliError> {
    let runs = study.run_count();
    let refused = |found: String, allowed: String| {
        let what = format!("{}: there is no such run", directory.display());
        Err(CliError::refusal(what, found, allowed))
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
fn runs_of_point(directory: &Path, manifest: &Manifest, point_id: u64) -> Result<u64, CliError> {
    let points = Table::open(directory, manifest, "points")?;
    for batch in points.read(&[("point_id", Kind::Count), ("runs", Kind::Count)])? {
        let batch = batch?;
        let row = batch.counts("point_id")?.iter().position(|found| *found == Some(point_id));
        if let Some(row) = row {
            return Ok(batch.count("runs", row)?.unwrap_or(0));
        }
    }
    Ok(0)
}

/// Writes the tables and returns their names.
fn write(
    out: &Path,
    list: &mut FileList,
    study: &Study,
    arguments: &ReplayArguments,
    record: &RunRecord,
    recording: &Recording,
) -> Result<Vec<&'static str>, CliError> {
    let times = arguments.times.map(|times| times.values().collect::<Vec<f64>>());
    let options = json!({
        "run_id": arguments.run_id,
        "times": times.as_ref().map(|times| json!([times.first(), times.last(), times.len()])),
    });
    // Invalid parameters have no units; the table is then empty.
    let model = record.planned.case.as_ref().map_or(study.model(), |case| &case.model);
    let gaps = model.gaps(&record.planned.start);
    let columns = trajectory_columns(model, gaps.as_deref().unwrap_or_default());
    table(out, list, study, "trajectory", &options, columns, &recording.samples)?;
    table(out, list, study, "switches", &options, switch_columns(model), &recording.switches)?;
    if gaps.is_none() {
        return Ok(vec![TRAJECTORY, SWITCHES]);
    }
    table(out, list, study, "touches", &options, touch_columns(model), &recording.touches)?;
    Ok(vec![TRAJECTORY, SWITCHES, TOUCHES])
}

fn table<R: Clone>(
    out: &Path,
    list: &mut FileList,
    study: &Study,
    name: &str,
    options: &Value,
    columns: Vec<Column<R>>,
    rows: &[R],
) -> Result<(), CliError> {
    let path = out.join(format!("{name}.parquet"));
    let mut table = TableWriter::create(&path, columns, &provenance_with(study, name, options))?;
    for row in rows {
        table.push(row.clone())?;
    }
    table.finish_once(|files| list.announce(out, files))?;
    Ok(())
}

/// The messages and the printed output of a replay.
struct Report<'a> {
    directory: &'a Path,
    out: &'a Path,
    study: &'a Study,
    record: RunRecord,
    recording: Recording,
    /// The differences from the stored row; `None` if there is no stored row.
    differences: Option<Vec<Difference>>,
    /// The written files.
    files: Vec<&'static str>,
}

impl Report<'_> {
    /// Prints the messages to standard error; `unfinished` is the manifest of results without a row of this run.
    fn say(&self, times: Option<Times>, columns: usize, unfinished: Option<&Manifest>) {
        let Report { directory, out, record, recording, differences, files, .. } = self;
        let run_id = record.planned.run_id;
        let (label, evidence) = (record.outcome.label().name(), record.outcome.evidence.name());
        let end = record.outcome.end_time_s.map(|end| format!(" at {end:.4} s"));
        let end = end.unwrap_or_default();
        say(&format!("run {run_id}: {label} ({evidence}){end}"));
        if let Some(error) = &record.outcome.error {
            say(&format!("  {}", one_line(error, LONGEST_ERROR)));
        }
        if let Some(Manifest { runs_planned, .. }) = unfinished {
            say(&format!(
                "warning: not compared, because {} has not finished this run yet (the study has {runs_planned} runs)",
                directory.display()
            ));
        }
        match differences.as_deref() {
            Some([]) => say(&format!("equal to its row in all {columns} columns, to the last bit")),
            Some(differences) => {
                say(&format!(
                    "NOT equal to its row in {} of {columns} columns:",
                    differences.len()
                ));
                for Difference { column, stored, replayed } in differences {
                    let [stored, replayed] = [stored, replayed].map(|value| shorten(value));
                    say(&format!("  {column}: {stored} stored, {replayed} computed"));
                }
            }
            None => {}
        }
        let asked = times.map_or(0, |times| times.values().count());
        let rows = recording.samples.len();
        if rows < asked {
            say(&format!("{rows} of {asked} times; the other times are after the end of the run"));
        }
        let model = record.planned.case.as_ref().map_or(self.study.model(), |case| &case.model);
        if model.kind().offers.animation && !files.contains(&ANIMATION) {
            say("no animation: nothing moves in this interval");
        }
        say(&format!("motion in {}", out.display()));
    }

    /// Returns all switches and impacts, or a summary if a terminal shows it.
    fn text(&self) -> String {
        let Report { out, study, record, recording, .. } = self;
        let model = record.planned.case.as_ref().map_or(study.model(), |case| &case.model);
        match io::stdout().is_terminal() {
            true => terminal_text(model, &record.outcome, recording, &out.join(SWITCHES)),
            false => switch_log(model, recording, usize::MAX),
        }
    }

    fn json(&self) -> Value {
        let Report { directory, out, study, record, recording, differences, files } = self;
        let differences = differences.as_ref();
        let mut json = json!({
            "study": study.name(),
            "directory": directory.display().to_string(),
            "run_id": record.planned.run_id,
            "point_id": record.planned.point_id,
            "label": record.outcome.label().name(),
            "evidence": record.outcome.evidence.name(),
            "time_to_rest_s": record.outcome.time_to_rest_s,
            "end_time_s": record.outcome.end_time_s,
            "error": record.outcome.error,
            "same_as_row": differences.map(Vec::is_empty),
            "differences": differences.map(|differences| differences.iter().map(|one| json!({
                "column": one.column,
                "row": one.stored,
                "replay": one.replayed,
            })).collect::<Vec<Value>>()),
            "rows": recording.samples.len(),
            "switches": recording.switches.len(),
            "out": out.display().to_string(),
            "files": files,
        });
        if let Some(stage) = record.outcome.stages.last() {
            json["stages"] = record.outcome.stages.len().into();
            json["stage_begins_s"] = stage.time_s[0].into();
            json["rest_since_s"] = record.outcome.rest_since_s.into();
            json["peak_amplitude_m"] = record.outcome.peak.map(|peak| peak.amplitude_m).into();
            json["peak_time_s"] = record.outcome.peak.map(|peak| peak.time_s).into();
        }
        if let Some(touching) = &record.outcome.touching {
            json["impacts"] = touching.impacts.into();
            json["touching_time_s"] = touching.time_s.into();
            json["touching_at_end"] = touching.at_end.into();
            json["contact_force_n"] = touching.force_n.into();
            json["lifted_off"] = touching.lifted_off.into();
        }
        json
    }
}
