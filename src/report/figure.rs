//! `replay.svg`: angles, speeds, the table and friction over time, one below the other.
//!
//! Curves are thinned to what the picture can resolve, with all extremes. Where a contact sticks, its
//! friction is shaded.

use plotters::coord::Shift;
use plotters::prelude::*;
use thiserror::Error;

use super::course::{stretches, thinned};
use super::paper::SERIES;
use crate::ending::{ContactSample, Sample};
use crate::model::Model;
use crate::motion::Phase;
use crate::table::{Units, in_circle};

/// The picture could not be drawn: a defect of this program.
#[derive(Debug, Error)]
#[error("the picture could not be drawn: {0}")]
pub struct FigureError(String);

const STUCK: RGBColor = RGBColor(222, 222, 222);
const GRID: RGBColor = RGBColor(232, 232, 232);
const LIMIT: RGBColor = RGBColor(60, 60, 60);

/// The library draws on whole pixels: so many of its pixels are one of the figure.
const FINE: u32 = 4;
const WIDTH: u32 = 900;
const PANEL: u32 = 150;
const ORBIT: u32 = 340;
/// Places along the time axis that can be told apart.
const BINS: u32 = 1500;

/// A colour that colour-blind readers can tell from its neighbours.
fn series_colour(number: usize) -> RGBColor {
    let [red, green, blue] = SERIES[number % SERIES.len()];
    RGBColor(red, green, blue)
}

/// A curve with its colour.
type Curve = (RGBColor, Vec<(f64, f64)>);

/// One part of the figure.
struct Panel {
    title: String,
    unit: &'static str,
    curves: Vec<Curve>,
    /// Shaded stretches of time.
    shaded: Vec<(f64, f64)>,
    /// Whether the ordinate is an angle, from 0 to 2π.
    angle: bool,
}

/// The figure of a recorded run as SVG; `title` goes above it.
///
/// # Errors
/// Where the drawing library fails.
pub fn figure(model: &Model, samples: &[Sample], title: &str) -> Result<String, FigureError> {
    let failed = |error: &dyn std::fmt::Display| FigureError(error.to_string());
    let units = Units::of(model);
    let [begin, end] = [samples.first(), samples.last()]
        .map(|sample| sample.map_or(0.0, |sample| units.seconds(sample.time)));
    let range = (begin, if end > begin { end } else { begin + 1e-9 });
    let panels = panels(model, &units, samples, range);
    let orbit = if model.balls() > 0 { ORBIT } else { 0 };
    let height = 36 + PANEL * panels.len() as u32 + 24 + orbit;
    let size = (FINE * WIDTH, FINE * height);
    let mut picture = String::new();
    {
        let root = SVGBackend::with_string(&mut picture, size).into_drawing_area();
        root.fill(&WHITE).map_err(|error| failed(&error))?;
        let style = TextStyle::from(("sans-serif", FINE * 15).into_font()).color(&BLACK);
        root.draw(&Text::new(title.to_owned(), (FINE as i32 * 64, FINE as i32 * 12), style))
            .map_err(|error| failed(&error))?;
        let mut top = 36;
        for (index, panel) in panels.iter().enumerate() {
            let last = index + 1 == panels.len();
            let below = top + PANEL + if last { 24 } else { 0 };
            let area = root.clone().shrink((0, FINE * top), (FINE * WIDTH, FINE * (below - top)));
            draw(&area, panel, range, last).map_err(|error| failed(&error))?;
            top = below;
        }
        if orbit > 0 {
            let area = root.clone().shrink((0, FINE * top), (FINE * WIDTH, FINE * orbit));
            orbits(&area, &units, samples).map_err(|error| failed(&error))?;
        }
        root.present().map_err(|error| failed(&error))?;
    }
    let fine = format!("width=\"{}\" height=\"{}\"", size.0, size.1);
    Ok(picture.replacen(&fine, &format!("width=\"{WIDTH}\" height=\"{height}\""), 1))
}

fn panels(model: &Model, units: &Units, samples: &[Sample], range: (f64, f64)) -> Vec<Panel> {
    let contacts = model.contacts();
    let series = |value: &dyn Fn(&Sample) -> Option<f64>| -> Vec<(f64, f64)> {
        let point = |sample: &Sample| Some((units.seconds(sample.time), value(sample)?));
        thinned(&samples.iter().filter_map(point).collect::<Vec<_>>(), range, BINS)
    };
    let mut panels = Vec::new();
    if model.balls() > 0 {
        let curves = |ball: usize| {
            turns(units, samples, ball)
                .into_iter()
                .map(move |turn| (series_colour(ball), thinned(&turn, range, BINS)))
        };
        panels.push(Panel {
            title: "angle of the balls from the imbalance".to_owned(),
            unit: "rad",
            curves: (0..contacts).flat_map(curves).collect(),
            shaded: Vec::new(),
            angle: true,
        });
    } else {
        let place =
            |sample: &Sample| sample.contacts.first().map(|block| block.position * units.position);
        panels.push(Panel {
            title: "position of the block".to_owned(),
            unit: "m",
            curves: vec![(series_colour(0), series(&place))],
            shaded: Vec::new(),
            angle: false,
        });
    }
    let speed = |contact: usize| {
        let value =
            move |sample: &Sample| sample.contacts.get(contact).map(|c| units.sliding_speed(c));
        (series_colour(contact), series(&value))
    };
    let balls = model.balls() > 0;
    panels.push(Panel {
        title: if balls { "speed of the balls relative to the ring" } else { "sliding speed" }
            .to_owned(),
        unit: if balls { "rad/s" } else { "m/s" },
        curves: (0..contacts).map(speed).collect(),
        shaded: Vec::new(),
        angle: false,
    });
    if balls {
        let away = |sample: &Sample| {
            let [x, y, ..] = sample.table?;
            Some(1e3 * units.length_m * x.hypot(y))
        };
        panels.push(Panel {
            title: "displacement of the table".to_owned(),
            unit: "mm",
            curves: vec![(LIMIT, series(&away))],
            shaded: Vec::new(),
            angle: false,
        });
    }
    let (fraction, unit) = if balls { (1e3, "mN") } else { (1.0, "N") };
    for contact in 0..contacts {
        let force = |value: fn(&ContactSample) -> f64| {
            move |sample: &Sample| {
                let newtons = value(sample.contacts.get(contact)?);
                Some(fraction * units.newtons(contact, newtons)?)
            }
        };
        let course = |sample: &Sample| {
            let stuck = sample.contacts.get(contact)?.phase == Phase::Stick;
            Some((units.seconds(sample.time), stuck))
        };
        let course: Vec<(f64, bool)> = samples.iter().filter_map(course).collect();
        let whose = if balls { format!(" on ball {}", contact + 1) } else { String::new() };
        panels.push(Panel {
            title: format!("friction{whose}, its limit (thin), sticking (shaded)"),
            unit,
            curves: vec![
                (LIMIT, series(&force(|contact| contact.limit))),
                (LIMIT, series(&force(|contact| -contact.limit))),
                (series_colour(contact), series(&force(|contact| contact.friction))),
            ],
            shaded: stretches(&course, range, BINS as usize),
            angle: false,
        });
    }
    panels
}

/// The angle of a ball over time, one curve for each turn.
fn turns(units: &Units, samples: &[Sample], ball: usize) -> Vec<Vec<(f64, f64)>> {
    let mut curves: Vec<Vec<(f64, f64)>> = Vec::new();
    let mut turn = f64::NAN;
    for sample in samples {
        let Some(contact) = sample.contacts.get(ball) else { continue };
        let now = (contact.position / std::f64::consts::TAU).floor();
        if now != turn {
            curves.push(Vec::new());
            turn = now;
        }
        if let Some(curve) = curves.last_mut() {
            curve.push((units.seconds(sample.time), in_circle(contact.position)));
        }
    }
    curves
}

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type Drawn = Result<(), Box<dyn std::error::Error>>;

fn font(size: u32) -> (&'static str, u32) {
    ("sans-serif", FINE * size)
}

/// Writes the numbers along an axis that spans so much, with the digits that tell its ticks apart.
fn label(span: f64) -> impl Fn(&f64) -> String {
    let digits = (1.4 - span.log10()).ceil().clamp(0.0, 15.0) as usize;
    move |value| {
        let text = format!("{value:.digits$}");
        if text.trim_start_matches('-').chars().all(|c| "0.".contains(c)) {
            "0".to_owned()
        } else {
            text
        }
    }
}

fn draw(area: &Area<'_>, panel: &Panel, (from, to): (f64, f64), last: bool) -> Drawn {
    let values = panel.curves.iter().flat_map(|(_, points)| points.iter().map(|(_, value)| *value));
    let finite = values.filter(|value| value.is_finite());
    let (least, most) =
        finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)));
    let (least, most) = if panel.angle {
        (0.0, std::f64::consts::TAU)
    } else if least < most {
        (least - 0.06 * (most - least), most + 0.06 * (most - least))
    } else if least.is_finite() {
        let around = least.abs().max(1e-9);
        (least - around, least + around)
    } else {
        (0.0, 1.0)
    };
    let mut chart = ChartBuilder::on(area)
        .caption(&panel.title, font(12))
        .margin_left(FINE * 6)
        .margin_right(FINE * 14)
        .x_label_area_size(FINE * if last { 38 } else { 14 })
        .y_label_area_size(FINE * 64)
        .build_cartesian_2d(from..to, least..most)?;
    chart.draw_series(
        panel
            .shaded
            .iter()
            .map(|(begin, end)| Rectangle::new([(*begin, least), (*end, most)], STUCK.filled())),
    )?;
    let (in_time, ordinate) = (label(to - from), label(most - least));
    let mut mesh = chart.configure_mesh();
    mesh.y_desc(panel.unit)
        .axis_desc_style(font(12))
        .label_style(font(11))
        .x_labels(9)
        .y_labels(5)
        .x_label_formatter(&in_time)
        .y_label_formatter(&ordinate)
        .set_all_tick_mark_size(FINE * 3)
        .light_line_style(TRANSPARENT)
        .bold_line_style(GRID.stroke_width(FINE))
        .axis_style(BLACK.stroke_width(FINE));
    if last {
        mesh.x_desc("time [s]");
    }
    mesh.draw()?;
    for (colour, points) in &panel.curves {
        let width = if *colour == LIMIT && panel.curves.len() > 1 { 2 } else { 4 };
        let line = LineSeries::new(points.iter().copied(), colour.stroke_width(width));
        chart.draw_series(line)?;
    }
    Ok(())
}

/// The path of the ring's centre, as the disc sees it and in space; the last fifth of the time dark.
fn orbits(area: &Area<'_>, units: &Units, samples: &[Sample]) -> Drawn {
    let (left, right) = area.split_horizontally(FINE * WIDTH / 2);
    let millimetres = |sample: &Sample| {
        let [x, y, ..] = sample.table?;
        Some([x, y].map(|place| 1e3 * units.length_m * place))
    };
    let in_space = |sample: &Sample| {
        let [x, y, ..] = units.in_space(sample)?;
        Some([x, y].map(|place| 1e3 * place))
    };
    orbit(&left, "path of the table, in the frame that turns", samples, &millimetres)?;
    orbit(&right, "path of the table, in space", samples, &in_space)
}

/// Most points of a path.
const MOST_POINTS: usize = 6000;

fn orbit(
    area: &Area<'_>,
    title: &str,
    samples: &[Sample],
    place: &dyn Fn(&Sample) -> Option<[f64; 2]>,
) -> Drawn {
    let every = samples.len().div_ceil(MOST_POINTS).max(1);
    let points: Vec<(f64, f64)> =
        samples.iter().step_by(every).filter_map(place).map(|[x, y]| (x, y)).collect();
    let most = points.iter().fold(1e-9_f64, |most, (x, y)| most.max(x.abs()).max(y.abs()));
    let range = -1.08 * most..1.08 * most;
    let place = label(2.0 * most);
    let mut chart = ChartBuilder::on(area)
        .caption(title, font(12))
        .margin_left(FINE * 6)
        .margin_right(FINE * 104)
        .x_label_area_size(FINE * 38)
        .y_label_area_size(FINE * 64)
        .build_cartesian_2d(range.clone(), range)?;
    chart
        .configure_mesh()
        .x_desc("mm")
        .y_desc("mm")
        .axis_desc_style(font(12))
        .label_style(font(11))
        .x_labels(5)
        .y_labels(5)
        .x_label_formatter(&place)
        .y_label_formatter(&place)
        .set_all_tick_mark_size(FINE * 3)
        .light_line_style(TRANSPARENT)
        .bold_line_style(GRID.stroke_width(FINE))
        .axis_style(BLACK.stroke_width(FINE))
        .draw()?;
    let late = points.len() - points.len() / 5;
    let pale = RGBColor(170, 190, 205).stroke_width(2);
    chart.draw_series(LineSeries::new(points.iter().copied(), pale))?;
    let dark = series_colour(0).stroke_width(4);
    chart.draw_series(LineSeries::new(points[late..].iter().copied(), dark))?;
    Ok(())
}
