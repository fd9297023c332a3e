//! `replay.html`: an animation of disc, ring and balls in one file that needs no network.

use std::path::Path;

use serde_json::json;

use crate::classification::{
    Evidence, Instants, MotionSample, RecordedRun, RunRecorder, simulate_recorded,
};
use crate::engine::{CommandError, MOST_INSTANTS};
use crate::model::{Machine, Model, SPEED_TERMS};
use crate::motion::Phase;
use crate::study::Study;
use crate::table::{FileList, ResultsError, RunRecord};

/// Name of the animation's file.
pub const ANIMATION: &str = "replay.html";

/// Markup, style and script of the page, with marks for title and data.
const PAGE: &str = include_str!("animation.html");
const DATA: &str = "/*data*/null";
const TITLE: &str = "<!--title-->";

/// Frames per turn of the disc.
const FRAMES_PER_TURN: f64 = 24.0;
const FRAMES: (f64, f64) = (200.0, 20_000.0);

/// Writes an animation of a run, or of an interval of it, s. Returns `false` without a file if the model has no
/// balls or if the run did not start.
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
    if matches!(outcome.evidence, Evidence::Panic(_)) || from >= to {
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
    let mut recorder =
        RunRecorder::new(Instants::At((0..frames).map(time).collect()), MOST_INSTANTS);
    simulate_recorded(case, &mut recorder);
    let page = animation(machine, &recorder.finish(), &title);
    list.write_once(out, ANIMATION, page.as_bytes())
        .map_err(ResultsError::unusable(&out.join(ANIMATION)))?;
    Ok(true)
}

/// Returns the number of frames of a motion of this length; `None` for a model without balls.
pub fn frames(model: &Model, seconds: f64) -> Option<u32> {
    let machine = model.ball_balancer()?;
    let rate = machine.disc_motion().fastest_rad_s() + machine.natural_frequency_rad_s();
    let frames = seconds * rate / std::f64::consts::TAU * FRAMES_PER_TURN;
    Some(frames.clamp(FRAMES.0, FRAMES.1) as u32)
}

/// Returns the animation of a balancer from equally spaced samples, with the touches between them; `title` is the
/// heading.
pub fn animation(machine: &Machine, recording: &RecordedRun, title: &str) -> String {
    let samples = &recording.samples;
    let model = Model::from(machine.clone());
    let units = model.units();
    let rounded = |value: f64, digits: i32| {
        let scale = 10.0_f64.powi(digits);
        (value * scale).round() / scale
    };
    let balls = machine.balls.len();
    let of_table = |axis: usize| -> Vec<f64> {
        // Rounded to 1e-5 of the ring's radius, far below a screen pixel.
        samples.iter().map(|sample| rounded(sample.table.map_or(0.0, |t| t[axis]), 6)).collect()
    };
    let angles: Vec<Vec<f64>> = (0..balls)
        .map(|ball| {
            samples.iter().map(|sample| rounded(sample.contacts[ball].position, 4)).collect()
        })
        .collect();
    // One character per sample, whether something holds.
    let flags = |holds: &dyn Fn(&MotionSample) -> bool| -> String {
        samples.iter().map(|sample| if holds(sample) { '1' } else { '0' }).collect()
    };
    let stick = |ball: usize| flags(&|sample| sample.contacts[ball].phase == Phase::Stick);
    let sticks: Vec<String> = (0..balls).map(stick).collect();
    // Balls that may touch, and for each such pair whether they do.
    let gaps = samples.first().map_or(&[][..], |sample| &sample.gaps[..]);
    let closed = |gap: usize| flags(&|sample| sample.gaps[gap].phase == Phase::Closed);
    let touching: Vec<String> = (0..gaps.len()).map(closed).collect();
    let [begin, end] = [samples.first(), samples.last()]
        .map(|sample| sample.map_or(0.0, |sample| units.seconds(sample.time)));
    // The times of the impacts in the picture, counted from its first one, with the balls.
    let impacts = recording.touches.iter().filter(|touch| touch.is_impact());
    let impacts = impacts.map(|touch| (units.seconds(touch.time) - begin, touch.after.contacts));
    let impacts: Vec<(f64, [usize; 2])> =
        impacts.filter(|(time, _)| (0.0..=end - begin).contains(time)).collect();
    let mut data = json!({
        "from_s": begin,
        "seconds": end - begin,
        "disc_rad_s": machine.speed_rad_s,
        "ball_over_ring": machine.balls.iter()
            .map(|ball| ball.diameter_m / machine.ring_radius_m).collect::<Vec<f64>>(),
        "radius_mm": rounded(1e3 * machine.ring_radius_m, 6),
        "x": of_table(0),
        "y": of_table(1),
        "angles": angles,
        "sticks": sticks,
    });
    if machine.contact.is_some() {
        data["gaps"] = json!(gaps.iter().map(|gap| gap.contacts).collect::<Vec<_>>());
        data["touching"] = json!(touching);
        data["impacts"] = json!(impacts);
    }
    if model.has_stages() {
        data["disc"] = json!(disc(machine));
        data["kicks"] = json!(machine.kicks.iter().map(|kick| kick.at_s).collect::<Vec<f64>>());
        data["last_stage_s"] = model.last_stage_begins_s().into();
    }
    let escaped = title.replace('&', "&amp;").replace('<', "&lt;");
    // The data are numbers, which cannot end the script element.
    PAGE.replace(TITLE, &escaped).replacen(DATA, &data.to_string(), 1)
}

/// Returns the segments of the speed of the disc: the begin of each, the angle turned before, and the coefficients of the
/// speed as a polynomial of the time since the begin.
fn disc(machine: &Machine) -> Vec<(f64, f64, [f64; SPEED_TERMS])> {
    let disc = machine.disc_motion();
    let segments = disc.segments.iter();
    segments.map(|(segment, turned)| (segment.begins_s, *turned, segment.terms)).collect()
}

/// Returns a time, given in s, as text with its unit and four decimals.
pub fn time_text(time_s: f64) -> String {
    let (unit, factor) = match 5.0 * time_s {
        span if time_s <= 0.0 || span >= 0.5 => ("s", 1.0),
        span if span >= 5e-4 => ("ms", 1e3),
        span if span >= 5e-7 => ("µs", 1e6),
        _ => ("ns", 1e9),
    };
    format!("{:.4} {unit}", factor * time_s)
}
