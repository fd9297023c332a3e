//! The animation of a replayed run.

use std::path::Path;

use super::animation::{animation, frames, time_text};
use super::replay::MOST_INSTANTS;
use crate::classification::{Evidence, Instants, Recorder, simulate_recorded};
use crate::command_error::CommandError;
use crate::study::Study;
use crate::table::{FileList, ResultsError, RunRecord};

/// Name of the animation's file.
pub const ANIMATION: &str = "replay.html";

/// Writes an animation of a run, or of an interval of it, s. Returns `false` without a file if the model has no
/// balls or if the run did not start.
///
/// # Errors
/// Returns an error if the file cannot be written.
pub fn animate(
    out: &Path,
    list: &mut FileList,
    study: &Study,
    record: &RunRecord,
    interval_s: Option<[f64; 2]>,
) -> Result<bool, CommandError> {
    let outcome = &record.outcome;
    let (Ok(case), Some(end)) = (&record.planned.case, outcome.end_time_s) else {
        return Ok(false);
    };
    let [from, to] = interval_s.unwrap_or([0.0, end]);
    let to = to.min(end);
    if outcome.evidence == Evidence::Panic || from >= to {
        return Ok(false);
    }
    let (Some(machine), Some(frames)) =
        (case.model.ball_balancer(), frames(&case.model, to - from))
    else {
        return Ok(false);
    };
    let title = format!(
        "{}, run {}: {} ({}) at {}",
        study.name(),
        record.planned.run_id,
        outcome.label().name(),
        outcome.evidence.name(),
        time_text(end),
    );
    let natural = case.model.natural_frequency_rad_s();
    let last = f64::from(frames - 1);
    let time = |frame: u32| natural * (from + (to - from) * (f64::from(frame) / last));
    let mut recorder = Recorder::new(Instants::At((0..frames).map(time).collect()), MOST_INSTANTS);
    simulate_recorded(case, &mut recorder);
    let page = animation(machine, &recorder.finish(), &title);
    let unusable = |cause| ResultsError::Unusable { path: out.join(ANIMATION), cause };
    list.write_once(out, ANIMATION, page.as_bytes()).map_err(unusable)?;
    Ok(true)
}
