//! Figure: how the disc starts and how the balls follow, for a sample of runs whose motion was computed again.

use crate::numbers::significant;
use crate::report::chart::{
    Axis, AxisKind, Colour, Figure, Layer, Mark, Panel, Symbol, Tooltips, axis,
};
use crate::report::data::{ReportData, SampledMotion, SampledRun, SampledRunUps};
use crate::study::{Study, Unit};

/// The number of decades of an axis of amplitudes at most.
const DECADES: i32 = 5;

/// Plots amplitude over time and over the speed of the disc, the speed of the disc and the speed of each ball over time.
pub fn figure(data: &ReportData<'_>) -> Option<Figure> {
    let SampledRunUps { points, left_out, .. } = &*data.run_up;
    let mut panels = Vec::new();
    for (point_id, runs) in points {
        let point = data.points.iter().find(|point| point.point_id == *point_id)?;
        let title = if points.len() > 1 { point.title.clone() } else { String::new() };
        let of_point = panels_of(data.study, *point_id, runs);
        panels.extend(of_point.into_iter().map(|panel| Panel { title: title.clone(), ..panel }));
    }
    let runs = points.iter().map(|(_, runs)| runs.len()).max().unwrap_or(0);
    let of_points = match (points.len(), data.point_count) {
        (shown, all) if shown as u64 == all => String::new(),
        (shown, all) => format!(" {shown} of {all} points are shown."),
    };
    let left_out = match left_out {
        0 => String::new(),
        runs => format!(" {runs} runs of many integration steps are not shown."),
    };
    Figure::new(
        "run-up",
        "Run-up",
        format!(
            "The motion of up to {runs} runs of each point, computed again: the first run, the run with the largest \
             amplitude, and runs with the smallest, median, 90 % and largest amplitude at the end. Amplitude: the \
             largest displacement of the table in each of 160 intervals before the last stage and of 160 in it; a \
             diamond is the largest one of the run. The curves over the speed of the disc show the times at which the speed changes. Speed of \
             a ball: relative to the ring, the mean of each interval.{of_points}{left_out}"
        ),
        words(data, points),
        panels,
    )
}

/// Returns the panels of a point.
fn panels_of(study: &Study, point_id: u64, runs: &[SampledRun]) -> Vec<Panel> {
    let time = || axis("time", "s");
    let units = (study.units().vibration(), study.units().speed());
    let (vibration, speed_unit) = &units;
    let amplitude = amplitude_axis(runs, vibration);
    let part = |part: &str, x: Axis, y: Axis, layers: Vec<Layer>| Panel {
        part: part.to_owned(),
        ..Panel::new(x, y, layers)
    };
    let over_time = |y: &dyn Fn(&SampledMotion, usize) -> f64| {
        let line = move |run: &SampledRun| {
            let times = run.motion.time_s.iter().enumerate();
            times.map(|(place, time)| [*time, y(&run.motion, place)]).collect()
        };
        let mut layers = lines(runs, &line);
        layers.extend(rules(runs));
        layers
    };
    // An amplitude of 0, which a logarithmic axis does not show, breaks the line.
    let shown = |motion: &SampledMotion, place: usize| match motion.amplitude_m[place] {
        metres if metres > 0.0 => vibration.of(metres),
        _ => f64::NAN,
    };
    let mut layers = over_time(&shown);
    layers.push(peaks(runs, &units, &|run| run.peak.time_s));
    let mut panels = vec![part("amplitude over time", time(), amplitude.clone(), layers)];
    let disc_speed =
        |motion: &SampledMotion, time_s: f64| speed_unit.of(motion.disc.speed_rad_s(time_s));
    let speed_of = |motion: &SampledMotion, place: usize| disc_speed(motion, motion.time_s[place]);
    let is_ramp = |run: &SampledRun| (0..run.motion.time_s.len()).any(|at| run.motion.is_ramp(at));
    if runs.iter().any(is_ramp) {
        let line = |run: &SampledRun| {
            let point = |place: usize| match run.motion.is_ramp(place) {
                true => [speed_of(&run.motion, place), shown(&run.motion, place)],
                false => [f64::NAN; 2],
            };
            (0..run.motion.time_s.len()).map(point).collect()
        };
        let mut layers = lines(runs, &line);
        layers.extend(resonance(study, point_id, runs));
        layers.push(peaks(runs, &units, &|run| disc_speed(&run.motion, run.peak.time_s)));
        let name = "amplitude over the speed of the disc";
        panels.push(part(name, axis("speed of the disc", &speed_unit.symbol), amplitude, layers));
        let layers = over_time(&speed_of);
        let name = "speed of the disc over time";
        panels.push(part(name, time(), axis("speed of the disc", &speed_unit.symbol), layers));
    }
    let balls = runs.iter().map(|run| run.motion.ball_speed_rad_s.len()).max().unwrap_or(0);
    for ball in 0..balls {
        let speed = |motion: &SampledMotion, place: usize| {
            motion
                .ball_speed_rad_s
                .get(ball)
                .map_or(f64::NAN, |speeds| speed_unit.of(speeds[place]))
        };
        let name = format!("speed of ball {} over time", ball + 1);
        let y = axis(&format!("speed of ball {}", ball + 1), &speed_unit.symbol);
        panels.push(part(&name, time(), y, over_time(&speed)));
    }
    panels
}

/// Returns the axis of all amplitudes of some runs, by decades.
fn amplitude_axis(runs: &[SampledRun], unit: &Unit) -> Axis {
    let all = || {
        let values = runs
            .iter()
            .flat_map(|run| run.motion.amplitude_m.iter().copied().chain([run.peak.amplitude_m]));
        values.map(|metres| unit.of(metres)).filter(|value| *value > 0.0 && value.is_finite())
    };
    let least = all().fold(f64::INFINITY, f64::min);
    let most = all().fold(0.0, f64::max);
    let axis = axis("amplitude", &unit.symbol);
    if most <= 0.0 {
        return axis;
    }
    let high = most.log10().ceil() as i32;
    let low = (least.log10().floor() as i32).clamp(high - DECADES, high - 1);
    let range = Some([low, high].map(|decade| 10.0_f64.powi(decade)));
    Axis { kind: AxisKind::Logarithmic, range, ..axis }
}

/// Returns the name of a run in the legend.
fn name(run: &SampledRun) -> String {
    format!("run {}: {}", run.peak.run_id, run.why)
}

/// Returns a line for each run.
fn lines(runs: &[SampledRun], line: &dyn Fn(&SampledRun) -> Vec<[f64; 2]>) -> Vec<Layer> {
    let layer = |(place, run): (usize, &SampledRun)| {
        let mark = Mark::Line { points: line(run), dashed: false };
        Layer::new(&name(run), Colour::Series(place), mark)
    };
    runs.iter().enumerate().map(layer).collect()
}

/// Returns the largest amplitude of each run as a dot.
fn peaks(
    runs: &[SampledRun],
    (vibration, speed): &(Unit, Unit),
    x: &dyn Fn(&SampledRun) -> f64,
) -> Layer {
    let column = |of: &dyn Fn(&SampledRun) -> f64| runs.iter().map(of).collect::<Vec<f64>>();
    let tooltips = Tooltips {
        run_ids: runs.iter().map(|run| run.peak.run_id).collect(),
        ..Tooltips::numbers([
            ("time [s]", column(&|run| run.peak.time_s)),
            (
                &*format!("speed of the disc [{}]", speed.symbol),
                column(&|run| speed.of(run.motion.disc.speed_rad_s(run.peak.time_s))),
            ),
        ])
    };
    let y = column(&|run| vibration.of(run.peak.amplitude_m));
    let mark = Mark::Dots { symbol: Symbol::Diamond, x: column(x), y, tooltips };
    Layer::new("largest amplitude", Colour::Ink, mark)
}

/// Returns the begin of the last stage and the kicks, as far as all runs agree on them.
fn rules(runs: &[SampledRun]) -> Vec<Layer> {
    let Some(SampledRun { motion: first, .. }) = runs.first() else { return Vec::new() };
    let agree = runs.iter().all(|SampledRun { motion, .. }| {
        motion.last_stage_s == first.last_stage_s && motion.kicks_s == first.kicks_s
    });
    if !agree {
        return Vec::new();
    }
    let rule = |at: f64, label: &str| {
        let mark = Mark::Rule { upright: true, at, label: label.to_owned() };
        Layer::new("", Colour::Faint, mark)
    };
    let kicks = first.kicks_s.iter().map(|at| rule(*at, "kick"));
    let is_kick = first.kicks_s.contains(&first.last_stage_s);
    let last = (!is_kick).then(|| rule(first.last_stage_s, "last stage"));
    kicks.chain(last).collect()
}

/// Returns a rule at the natural frequency, if the disc passes it in all of these runs.
fn resonance(study: &Study, point_id: u64, runs: &[SampledRun]) -> Option<Layer> {
    let point = study.point(point_id);
    let natural = point.model().natural_frequency_rad_s();
    let sign = point.model().ball_balancer()?.speed_rad_s.signum();
    let passes = |run: &SampledRun| run.motion.disc.fastest_rad_s() > natural;
    let mark = Mark::Rule {
        upright: true,
        at: study.units().speed().of(sign * natural),
        label: "natural frequency".to_owned(),
    };
    runs.iter().all(passes).then(|| Layer::new("", Colour::Faint, mark))
}

/// Returns a sentence for each point.
fn words(data: &ReportData<'_>, points: &[(u64, Vec<SampledRun>)]) -> String {
    let sentence = |(point_id, runs): &(u64, Vec<SampledRun>)| {
        let title = &data.points.iter().find(|point| point.point_id == *point_id)?.title;
        let most = runs
            .iter()
            .max_by(|left, right| left.peak.amplitude_m.total_cmp(&right.peak.amplitude_m))?;
        let peak = &most.peak;
        let unit = data.study.units().speed();
        let speed = significant(unit.of(most.motion.disc.speed_rad_s(peak.time_s)));
        let vibration = data.study.units().vibration();
        Some(format!(
            "{title}: the largest amplitude is {} {}, in run {} after {} s, at {speed} {}",
            significant(vibration.of(peak.amplitude_m)),
            vibration.symbol,
            peak.run_id,
            significant(peak.time_s),
            unit.symbol,
        ))
    };
    points.iter().filter_map(sentence).collect::<Vec<_>>().join("; ")
}
