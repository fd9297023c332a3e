//! `stickslip replay`: computes one run again with its motion.

use std::io::{self, IsTerminal};
use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::{Value, json};

use super::arguments::parsed;
use super::output::{CliError, End, print_result};
use super::range::{EvenRange, times};
use super::replay_text::{ending, switch_log, terminal_text};
use crate::engine::{results_study, say};
use crate::model::Model;
use crate::report::{ANIMATION, Replay, SWITCHES, beside};
use crate::responses::merged;
use crate::sanitize::{one_line, shorten};
use crate::study::Study;
use crate::table::{Difference, Manifest};

const EXAMPLES: &str = "\
Examples:
  stickslip replay results/night 17
  stickslip replay results/night 17 --times 0:5:2001 --out figure-3
  stickslip replay results/night 17 | head

Computes the run again with the same engine and compares it with its stored row: all columns, to the \
last bit. If they differ, for example on another kind of processor, it prints the differences and ends with exit \
code 1. Writes trajectory.parquet (angle and speed of table and balls, phase, friction and friction limit of \
each ball), switches.parquet (each change between stick and slip) and replay.html (an animation for any browser, also \
of a system file with the key `draw`); for balls with contact also the gaps between them, and touches.parquet (each \
impact, and each end of lasting contact); for a disc that starts or a table that is kicked also the speed of the disc. \
Prints all changes between stick and slip, and all impacts, to a pipe or a file; a terminal shows a summary and the first \
of them. The Python package's `stickslip-figures` draws figures for papers from these tables.";

/// The number of characters of a run's error message that are printed.
const LONGEST_ERROR: usize = 400;

/// Compute one run of a study again and write its motion
#[derive(Clone, Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct Arguments {
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
    #[arg(value_parser = times, allow_hyphen_values = true)]
    times: Option<EvenRange>,

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
    parsed(text, "a whole number from 0, as in 17", |_| true)
}

/// Computes the run again and writes its motion.
pub fn replay(arguments: &Arguments) -> Result<End, CliError> {
    let Arguments { directory, run_id, .. } = arguments;
    let (study, manifest) = results_study(directory)?;
    let usual = || beside(directory, &format!("-replay-{run_id}"));
    let out = arguments.out.clone().map_or_else(usual, Ok)?;
    Replay::inspect(&out)?;
    let times_s = arguments.times.map(|times| times.values().collect());
    let replay = Replay::of_directory(directory, (&study, &manifest), *run_id, times_s)?;
    let files = replay.write(&study, &out)?;
    let model = replay.record.planned.case.as_ref().map_or(study.model(), |case| &case.model);
    let report =
        ReplayReport { directory, out: &out, study: &study, replay: &replay, model, files };
    report.say(&manifest);
    print_result(arguments.json, || report.json(), || report.text())?;
    let same = replay.differences.as_ref().is_none_or(Vec::is_empty);
    Ok(if same { End::Well } else { End::NotReproduced })
}

/// The messages and the printed output of a replay.
struct ReplayReport<'a> {
    directory: &'a Path,
    out: &'a Path,
    study: &'a Study,
    replay: &'a Replay,
    /// The model of the run, or of the study if the values of the run are impossible.
    model: &'a Model,
    /// The written files.
    files: Vec<&'static str>,
}

impl ReplayReport<'_> {
    /// Prints the messages to standard error.
    fn say(&self, manifest: &Manifest) {
        let ReplayReport { directory, out, replay, model, files, .. } = self;
        let Replay { record, recording, differences, columns, times_s } = replay;
        say(&format!("run {}: {}", record.planned.run_id, ending(&record.outcome)));
        if let Some(error) = record.outcome.evidence.error() {
            say(&format!("  {}", one_line(&error, LONGEST_ERROR)));
        }
        match differences.as_deref() {
            Some([]) => say(&format!("equal to its row in all {columns} columns, to the last bit")),
            Some(differences) => {
                let count = differences.len();
                say(&format!("NOT equal to its row in {count} of {columns} columns:"));
                for Difference { column, stored, replayed } in differences {
                    let [stored, replayed] = [stored, replayed].map(|value| shorten(value));
                    say(&format!("  {column}: {stored} stored, {replayed} computed"));
                }
            }
            None => say(&format!(
                "warning: not compared, because {} has not finished this run yet (the study has {} runs)",
                directory.display(),
                manifest.runs_planned
            )),
        }
        if let (Some(times), false) = (times_s, replay.times_after_end_s().is_empty()) {
            let (rows, asked) = (recording.samples.len(), times.len());
            say(&format!("{rows} of {asked} times; the other times are after the end of the run"));
        }
        if !files.contains(&ANIMATION) {
            say(match model.drawing(&record.planned.start) {
                Some(_) => "no animation: nothing moves in this interval",
                None => "no animation: the system file has no pictures under its key `draw`",
            });
        }
        say(&format!("motion in {}", out.display()));
    }

    /// Returns all switches and impacts, or a summary if a terminal shows it.
    fn text(&self) -> String {
        let ReplayReport { out, study, replay: Replay { record, recording, .. }, model, .. } = self;
        if !io::stdout().is_terminal() {
            return switch_log(model, recording, usize::MAX);
        }
        let file = out.join(SWITCHES);
        terminal_text((model, study.units()), &record.outcome, recording, &file)
    }

    fn json(&self) -> Value {
        let ReplayReport { directory, out, study, replay, files, .. } = self;
        let Replay { record, recording, differences, .. } = replay;
        let outcome = &record.outcome;
        let difference = |gap: &Difference| json!({"column": gap.column, "row": gap.stored, "replay": gap.replayed});
        let differences = differences.as_ref();
        let json = json!({
            "study": study.name(),
            "directory": directory.display().to_string(),
            "run_id": record.planned.run_id,
            "point_id": record.planned.point_id,
            "label": outcome.label().name(),
            "evidence": outcome.evidence.name(),
            "time_to_rest_s": outcome.time_to_rest_s(),
            "end_time_s": outcome.end_time_s,
            "error": outcome.evidence.error(),
            "same_as_row": differences.map(Vec::is_empty),
            "differences": differences.map(|all| all.iter().map(difference).collect::<Vec<_>>()),
            "rows": recording.samples.len(),
            "switches": recording.switches.len(),
            "out": out.display().to_string(),
            "files": files,
        });
        let of_stages = outcome.stages.last().map(|stage| {
            json!({
                "stages": outcome.stages.len(),
                "stage_begins_s": stage.time_s[0],
                "rest_since_s": outcome.evidence.rest().and_then(|rest| rest.since_s),
                "peak_amplitude_m": outcome.peak.map(|peak| peak.amplitude_m),
                "peak_time_s": outcome.peak.map(|peak| peak.time_s),
            })
        });
        let of_touching = outcome.touching.map(|touching| {
            json!({
                "impacts": touching.impacts,
                "touching_time_s": touching.time_s,
                "touching_at_end": touching.at_end,
                "contact_force_n": touching.force_n,
                "lifted_off": touching.lifted_off,
            })
        });
        merged(merged(json, of_stages), of_touching)
    }
}
