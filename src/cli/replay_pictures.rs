//! The pictures of a replayed run.

use std::path::Path;

use super::exit::CliError;
use super::replay_times::{MOST_TIMES, Times};
use crate::ending::{Evidence, Instants, Recorder, Recording, simulate_recorded};
use crate::model::Case;
use crate::report::{animation, figure, frames, time_text};
use crate::study::Study;
use crate::table::{FileList, ResultsError, RunRecord};

/// Instants inside of each step, so that curves are smooth; none where the run has so many steps that it
/// makes no difference.
const INSIDE: u32 = 3;
const MANY_STEPS: u64 = 50_000;

/// Draws a run, or the part of it that `times` begin and end: a figure, and of a balancer an animation.
/// Returns the names of the files. There are none of a run that did not begin to move.
///
/// # Errors
/// Where a file cannot be written.
pub fn draw(
    out: &Path,
    list: &mut FileList,
    study: &Study,
    record: &RunRecord,
    times: Option<Times>,
) -> Result<Vec<&'static str>, CliError> {
    let outcome = &record.outcome;
    let (Ok(case), Some(end)) = (&record.planned.case, outcome.end_time_s) else {
        return Ok(Vec::new());
    };
    let [from, to] = times.map_or([0.0, end], |times| times.ends());
    let to = to.min(end);
    if outcome.evidence == Evidence::Panic || from >= to {
        return Ok(Vec::new());
    }
    let natural = case.model.natural_frequency_rad_s();
    let title = format!(
        "{}, run {}: {} ({}) at {}",
        study.name(),
        record.planned.run_id,
        outcome.label().name(),
        outcome.evidence.name(),
        time_text(end),
    );
    let inside = if outcome.effort.steps < MANY_STEPS { INSIDE } else { 0 };
    let mut dense = recorded(case, Instants::EveryStep { inside });
    dense.samples.retain(|sample| (from..=to).contains(&(sample.time / natural)));
    let mut files = Vec::new();
    let mut write = |name: &str, content: String| {
        let unusable = |cause| ResultsError::Unusable { path: out.join(name), cause };
        list.write_once(out, name, content.as_bytes()).map_err(unusable)
    };
    write(FIGURE, figure(&case.model, &dense.samples, &title).map_err(std::io::Error::other)?)?;
    files.push(FIGURE);
    if let (Some(machine), Some(frames)) =
        (case.model.ball_balancer(), frames(&case.model, to - from))
    {
        let last = f64::from(frames - 1);
        let time = |frame: u32| natural * (from + (to - from) * (f64::from(frame) / last));
        let even = recorded(case, Instants::At((0..frames).map(time).collect()));
        write(ANIMATION, animation(machine, &even.samples, &title))?;
        files.push(ANIMATION);
    }
    Ok(files)
}

/// A figure of the motion.
pub const FIGURE: &str = "replay.svg";
/// An animation of it.
pub const ANIMATION: &str = "replay.html";

fn recorded(case: &Case, instants: Instants) -> Recording {
    let mut recorder = Recorder::new(instants, MOST_TIMES as usize);
    simulate_recorded(case, &mut recorder);
    recorder.finish()
}
