//! `replay.html`: an animation of a machine in one file that needs no network.

use std::f64::consts::{PI, TAU};
use std::path::Path;

use serde_json::{Value, json};

use crate::classification::{
    Evidence, Instants, MotionSample, RecordedRun, RunRecorder, simulate_recorded,
};
use crate::engine::{CommandError, MOST_INSTANTS};
use crate::model::{Drawing, DrawnFrame, DrawnQuantity, DrawnShape, DrawnView, Model};
use crate::motion::Phase;
use crate::study::Study;
use crate::table::{FileList, ResultsError, RunRecord};

/// Name of the animation's file.
pub const ANIMATION: &str = "replay.html";

/// Markup, style and script of the page, with marks for title, data and formulas.
const PAGE: &str = include_str!("animation.html");
const DATA: &str = "/*data*/null";
const FORMULAS: &str = "/*formulas*/null";
const TITLE: &str = "<!--title-->";

/// Frames per turn of the part that turns, or per period of the machine.
const FRAMES_PER_TURN: f64 = 24.0;
/// Frames per step of the integration, which is short where forces change fast.
const FRAMES_PER_STEP: f64 = 4.0;
const FRAMES: (f64, f64) = (200.0, 20_000.0);
/// The largest number of values in all frames.
const MOST_VALUES: f64 = 400_000.0;

/// Writes an animation of a run, or of an interval of it, s. Returns `false` without a file if the model has no
/// pictures or if the run did not start.
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
    let Some(drawing) = case.model.drawing(&case.start) else { return Ok(false) };
    let title = format!(
        "{}, run {}: {} ({}) at {}",
        study.name(),
        record.planned.run_id,
        outcome.label().name(),
        outcome.evidence.name(),
        time_text(end),
    );
    let steps = outcome.effort.steps as f64 * (to - from) / end;
    let frames = frames(&case.model, &drawing, to - from, steps);
    let (natural, last) = (case.model.units().natural_rad_s, f64::from(frames - 1));
    let time = |frame: u32| natural * (from + (to - from) * (f64::from(frame) / last));
    let mut recorder =
        RunRecorder::new(Instants::At((0..frames).map(time).collect()), MOST_INSTANTS);
    simulate_recorded(case, &mut recorder);
    let page = animation((&case.model, &drawing), &recorder.finish(), &title);
    list.write(out, ANIMATION, page.as_bytes(), false)
        .map_err(ResultsError::unusable(&out.join(ANIMATION)))?;
    Ok(true)
}

/// Returns the number of frames of a motion of this length, which takes so many steps.
fn frames(model: &Model, drawing: &Drawing, seconds: f64, steps: f64) -> u32 {
    let turning = model.disc_motion().map_or(0.0, |disc| disc.fastest_rad_s());
    let rate = turning + model.units().natural_rad_s;
    let frames = (seconds * rate / TAU * FRAMES_PER_TURN).max(FRAMES_PER_STEP * steps);
    let most = FRAMES.1.min(MOST_VALUES / drawing.quantities.len().max(1) as f64);
    frames.clamp(FRAMES.0, most.max(FRAMES.0)) as u32
}

/// Returns the animation of a machine from equally spaced samples, with the touches between them; `title` is the
/// heading.
fn animation((model, drawing): (&Model, &Drawing), recording: &RecordedRun, title: &str) -> String {
    let samples = &recording.samples;
    let units = model.units();
    let [begin, end] = [samples.first(), samples.last()]
        .map(|sample| sample.map_or(0.0, |sample| units.seconds(sample.time)));
    let values = samples.iter().map(|sample| values((model, drawing), sample)).collect::<Vec<_>>();
    let quantities = drawing.quantities.iter().enumerate();
    let quantities = quantities.map(|(number, DrawnQuantity { name, angular, enlarged, .. })| {
        let values = values.iter().map(|values| values[number]).collect();
        let values = if *angular { unwrapped(values) } else { rounded(values) };
        json!({"name": name, "enlarged": enlarged, "values": values})
    });
    let mut data = json!({
        "from_s": begin,
        "seconds": end - begin,
        "frames": samples.len(),
        "quantities": quantities.collect::<Vec<Value>>(),
        "contacts": contacts((model, drawing), recording, [begin, end]),
        "views": drawing.views.iter().map(view).collect::<Vec<Value>>(),
        "plots": drawing.plots.iter().map(|[name, _]| name).collect::<Vec<_>>(),
        "note": drawing.note,
    });
    if let Some(disc) = model.disc_motion() {
        // The begin of each segment of the speed, the angle turned before, and the coefficients of the speed as a polynomial of
        // the time since the begin.
        let segments = disc.segments.iter();
        let segments = segments
            .map(|(segment, turned)| (segment.begins_s, *turned, segment.terms))
            .collect::<Vec<_>>();
        data["disc"] = json!(segments);
    }
    if model.has_stages() {
        let kicks = model.ball_balancer().map_or(&[][..], |machine| &machine.kicks);
        data["kicks"] = json!(kicks.iter().map(|kick| kick.at_s).collect::<Vec<f64>>());
        data["last_stage_s"] = model.last_stage_begins_s().into();
    }
    let escaped = title.replace('&', "&amp;").replace('<', "&lt;");
    let function = |values: String| format!("(q, turned, t) => {values}");
    let lists = |texts: Vec<String>| format!("[{}]", texts.join(","));
    let shapes = drawing.views.iter().map(|DrawnView { shapes, .. }| {
        lists(shapes.iter().map(|shape| lists(shape.values.clone())).collect())
    });
    let plots = drawing.plots.iter().map(|[_, formula]| formula.clone());
    let of_views = shapes.map(function).collect::<Vec<String>>();
    let formulas = format!("[{}, {}]", lists(of_views), function(lists(plots.collect())));
    // The data are numbers and names, which do not end the script element.
    PAGE.replace(TITLE, &escaped)
        .replacen(DATA, &data.to_string().replace('<', "\\u003c"), 1)
        .replacen(FORMULAS, &formulas, 1)
}

/// Returns the drawn quantities in SI units.
fn values((model, drawing): (&Model, &Drawing), sample: &MotionSample) -> Vec<f64> {
    let (units, motions) = (model.units(), model.given_motions());
    match sample.table {
        Some([x, y, ..]) if model.ball_balancer().is_some() => {
            let angles = sample.contacts.iter().map(|contact| contact.position);
            [x, y].map(|value| value * units.length_m).into_iter().chain(angles).collect()
        }
        _ => {
            let coordinates = drawing.quantities.len() - motions.len();
            let outputs = sample.outputs.iter().zip(&units.outputs).take(coordinates);
            let given = motions.iter().map(|motion| motion.at(units.seconds(sample.time)));
            outputs.map(|(value, units)| value * units.size).chain(given).collect()
        }
    }
}

/// Returns lengths or other values with nine significant digits of the largest one, so that differences of them are smooth, too.
fn rounded(values: Vec<f64>) -> Vec<f64> {
    let largest = values.iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
    let scale = 10.0_f64.powf((9.0 - largest.log10().ceil()).clamp(-300.0, 300.0));
    values.into_iter().map(|value| (value * scale).round() / scale).collect()
}

/// Returns angles with seven decimals and without jumps by whole turns.
fn unwrapped(mut values: Vec<f64>) -> Vec<f64> {
    let mut turns = 0.0;
    for place in 1..values.len() {
        let change = values[place] + turns - values[place - 1];
        turns -= TAU * ((change + PI) / TAU).floor();
        values[place] += turns;
    }
    values.into_iter().map(|value| (value * 1e7).round() / 1e7).collect()
}

fn view(DrawnView { name, frame, shapes }: &DrawnView) -> Value {
    let frame = match frame {
        DrawnFrame::Only => "only",
        DrawnFrame::Fixed => "fixed",
        DrawnFrame::Turning => "turning",
    };
    let shape = |DrawnShape { name, form, contact, .. }: &DrawnShape| json!({"name": name, "form": form.name(), "contact": contact});
    json!({"name": name, "frame": frame, "shapes": shapes.iter().map(shape).collect::<Vec<Value>>()})
}

/// Returns the contacts, and after them the gaps between contacts: their phases in each sample, a letter for each, and when they
/// close in the picture, counted from its first instant.
fn contacts(
    (model, drawing): (&Model, &Drawing),
    recording: &RecordedRun,
    [begin, end]: [f64; 2],
) -> Vec<Value> {
    let RecordedRun { samples, touches, landings, .. } = recording;
    let units = model.units();
    let within = |time: f64| {
        let time = units.seconds(time) - begin;
        Some(time).filter(|time| (0.0..=end - begin).contains(time))
    };
    let letters = |phase: &dyn Fn(&MotionSample) -> Phase| -> String {
        let letter = |sample| match phase(sample) {
            Phase::Stick => 's',
            Phase::Apart => 'a',
            Phase::Open => 'o',
            Phase::Closed => 'c',
            _ => 'l',
        };
        samples.iter().map(letter).collect()
    };
    let contact = |number: usize| {
        let closes = landings.iter().filter(|(_, contact)| *contact == number);
        let is_it = |quantity: &DrawnQuantity| quantity.contact == Some(number);
        json!({
            "name": model.contact_in_words(number).replace('`', "").replace('_', " "),
            "phases": letters(&|sample| sample.contacts[number].phase),
            "closes": closes.filter_map(|(time, _)| within(*time)).collect::<Vec<f64>>(),
            "angle": drawing.quantities.iter().position(is_it),
        })
    };
    let gaps = samples.first().map_or(&[][..], |sample| &sample.gaps[..]);
    let gap = |(number, gap): (usize, &crate::classification::GapSample)| {
        let impacts = touches
            .iter()
            .filter(|touch| touch.is_impact() && touch.after.contacts == gap.contacts);
        let [behind, ahead] = gap.contacts.map(|contact| contact + 1);
        json!({
            "name": format!("balls {behind} and {ahead}"),
            "phases": letters(&|sample| sample.gaps[number].phase),
            "closes": impacts.filter_map(|touch| within(touch.time)).collect::<Vec<f64>>(),
            "angle": null,
        })
    };
    let count = samples.first().map_or(0, |sample| sample.contacts.len());
    (0..count).map(contact).chain(gaps.iter().enumerate().map(gap)).collect()
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
