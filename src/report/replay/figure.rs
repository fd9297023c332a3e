//! `replay.svg`: angles, speeds, the table and friction over time, one below the other, and the table's
//! path.
//!
//! Curves have what the picture can resolve, with all extremes, so that its size has a bound however long
//! the run is. Where a contact sticks, its friction is shaded.

use std::fmt::Write;

use plotters::prelude::*;
use thiserror::Error;

use super::axis::{Axis, time_text};
use super::panel::{
    self, ABOVE, Area, BELOW, BELOW_LAST, Drawn, FINE, LEFT, RIGHT, STUCK, TIMES, place, text,
};
use super::path::{self, Path};
use super::quantity::{Of, Panel, panels};
use crate::ending::Sample;
use crate::model::Model;
use crate::table::{Units, in_circle};

/// The picture could not be drawn: a defect of this program.
#[derive(Debug, Error)]
#[error("the picture could not be drawn: {0}")]
pub struct FigureError(String);

const WIDTH: u32 = 900;
/// Width of what is between the axes of time, px.
const PLOT: u32 = WIDTH - LEFT - RIGHT;
/// Title, and rows of the legend, px.
const TITLE: u32 = 34;
const LEGEND_ROW: u32 = 18;

/// The figure of a recorded run as SVG; `title` goes above it.
///
/// # Errors
/// Where the drawing library fails.
pub fn figure(model: &Model, samples: &[Sample], title: &str) -> Result<String, FigureError> {
    let units = Units::of(model);
    let [begin, end] = [samples.first(), samples.last()]
        .map(|sample| sample.map_or(0.0, |sample| units.seconds(sample.time)));
    let (time, unit) = Axis::time(begin, if end > begin { end } else { begin + 1e-9 }, TIMES);
    let panels = panels(model, &units, samples, (time.from, time.to), PLOT);
    let mut sheet = Sheet { content: String::new(), height: 0 };

    let legend = legend(&panels);
    let rows = 1 + legend.last().map_or(0, |(_, (_, row), _)| *row);
    sheet.add("heading", "", (WIDTH, TITLE + LEGEND_ROW * rows + 4), 0, |area| {
        text(area, title, 15, (LEFT, 12))?;
        legend.iter().try_for_each(|entry| legend_entry(area, entry))
    })?;
    for (index, panel) in panels.iter().enumerate() {
        let last = (index + 1 == panels.len()).then_some(unit);
        let below = if last.is_some() { BELOW_LAST } else { BELOW };
        let size = (WIDTH, ABOVE + panel.height + below);
        let numbered = model.balls() > 1 && ["angle", "speed"].contains(&panel.id.as_str());
        sheet.add(&panel.id, &panel.title, size, 0, |area| {
            panel::draw(area, panel, &time, PLOT, last, numbered)
        })?;
    }
    if model.balls() > 0 {
        let course = |place: &dyn Fn(&Sample) -> Option<[f64; 2]>| {
            let at = |sample: &Sample| Some((units.seconds(sample.time), place(sample)?));
            Path::new(&samples.iter().filter_map(at).collect::<Vec<_>>())
        };
        let on_disc = course(&|sample| {
            let [x, y, ..] = sample.table?;
            Some([x, y].map(|place| 1e3 * units.length_m * place))
        });
        let in_space = course(&|sample| {
            let [x, y, ..] = units.in_space(sample)?;
            Some([x, y].map(|place| 1e3 * place))
        });
        let size = (path::WIDTH, path::HEIGHT);
        let top = sheet.height;
        for (id, left, seen, path) in [
            ("path-disc", 0, "seen from the disc", &on_disc),
            ("path-space", path::WIDTH, "in space", &in_space),
        ] {
            let title = format!("path of the table, {seen} [mm]");
            let tooltip = format!("{title}: {}", path.told());
            sheet.height = top;
            sheet.add(id, &tooltip, size, left, |area| path::draw(area, &title, path))?;
        }
        let told = format!("path of the table: {}", on_disc.told());
        sheet.add("paths", "", (WIDTH, 24), 0, |area| text(area, &told, 12, (LEFT, 4)))?;
    }
    Ok(sheet.finish(title, &description(model, &units, samples, &panels, (begin, end))))
}

/// A picture that grows downwards.
struct Sheet {
    content: String,
    height: u32,
}

impl Sheet {
    /// Adds a part of this size, px, so far from the left, with a name and words that are shown under the
    /// pointer.
    fn add(
        &mut self,
        id: &str,
        title: &str,
        size: (u32, u32),
        left: u32,
        draw: impl FnOnce(&Area<'_>) -> Drawn,
    ) -> Result<(), FigureError> {
        let failed = |error: &dyn std::fmt::Display| FigureError(error.to_string());
        let mut picture = String::new();
        {
            let fine = (FINE * size.0, FINE * size.1);
            let area = SVGBackend::with_string(&mut picture, fine).into_drawing_area();
            draw(&area).map_err(|error| failed(&error))?;
            area.present().map_err(|error| failed(&error))?;
        }
        // What is between the tags of the picture.
        let inside = picture.split_once(">\n").map_or("", |(_, rest)| rest);
        let inside = inside.trim_end().trim_end_matches("</svg>");
        let (x, y) = (FINE * left, FINE * self.height);
        let title = if title.is_empty() {
            String::new()
        } else {
            format!("<title>{}</title>\n", escaped(title))
        };
        // Writing into a string cannot fail.
        let _ = writeln!(
            self.content,
            "<g id=\"{id}\" transform=\"translate({x} {y})\">\n{title}{inside}</g>"
        );
        self.height += size.1;
        Ok(())
    }

    /// The picture, for eyes and for readers that have none.
    fn finish(self, title: &str, description: &str) -> String {
        let Sheet { content, height } = self;
        let (fine_width, fine_height) = (FINE * WIDTH, FINE * height);
        // What the library writes at everything and nothing needs.
        let content = content.replace(" opacity=\"1\"", "");
        format!(
            "<svg width=\"{WIDTH}\" height=\"{height}\" viewBox=\"0 0 {fine_width} {fine_height}\" \
             xmlns=\"http://www.w3.org/2000/svg\" role=\"img\" aria-labelledby=\"title description\">\n\
             <title id=\"title\">{}</title>\n<desc id=\"description\">{}</desc>\n\
             <rect width=\"{fine_width}\" height=\"{fine_height}\" fill=\"#FFFFFF\"/>\n{content}</svg>\n",
            escaped(title),
            escaped(description),
        )
    }
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

/// What a legend explains.
#[derive(Clone, Copy, PartialEq)]
enum Sign {
    Line(Of),
    Shaded,
    None,
}

/// An entry of the legend: its sign, its left edge in px and row, its words.
type Entry = (Sign, (u32, u32), String);

/// The legend: what is there, and no more.
fn legend(panels: &[Panel]) -> Vec<Entry> {
    let curves = || panels.iter().flat_map(|panel| panel.curves.iter().map(|curve| curve.of));
    let balls = panels.iter().any(|panel| panel.angle);
    let contacts = curves().filter_map(|of| match of {
        Of::Contact(contact) => Some(contact + 1),
        _ => None,
    });
    let contacts = contacts.max().unwrap_or(0);
    let mut words: Vec<(Sign, String)> = Vec::new();
    if balls {
        let ball = |ball: usize| (Sign::Line(Of::Contact(ball)), format!("ball {}", ball + 1));
        words.extend((0..contacts).map(ball));
    }
    if curves().any(|of| matches!(of, Of::Running(_))) {
        let told = "pale: turns too short to be told apart, not all of them";
        words.push((Sign::None, told.to_owned()));
    }
    words.push((Sign::Line(Of::Limit), "± the most that friction can hold".to_owned()));
    if panels.iter().any(|panel| !panel.shaded.is_empty()) {
        let who = if balls { "the ball sticks" } else { "the block sticks" };
        words.push((Sign::Shaded, who.to_owned()));
    }
    let (mut left, mut row) = (LEFT, 0);
    let place = |(sign, words): (Sign, String)| {
        // The width of text is estimated, generously.
        let sign_width = if sign == Sign::None { 0 } else { 28 };
        let width = sign_width + 11 * words.chars().count() as u32 / 2 + 20;
        if left + width > WIDTH && left > LEFT {
            (left, row) = (LEFT, row + 1);
        }
        let entry = (sign, (left, row), words);
        left += width;
        entry
    };
    words.into_iter().map(place).collect()
}

fn legend_entry(area: &Area<'_>, (sign, (left, row), words): &Entry) -> Drawn {
    let middle = TITLE + LEGEND_ROW * row + 7;
    match sign {
        Sign::Line(of) => {
            let (colour, width) = of.stroke();
            let line = [place(*left, middle), place(left + 22, middle)];
            // Thicker than the curves: a colour is seen on an area.
            let width = if matches!(of, Of::Contact(_)) { 2 * width } else { width };
            area.draw(&PathElement::new(line, colour.stroke_width(width)))?;
        }
        Sign::None => return text(area, words, 12, (*left, middle - 6)),
        Sign::Shaded => {
            let corners = [place(*left, middle - 6), place(left + 22, middle + 6)];
            area.draw(&Rectangle::new(corners, STUCK.filled()))?;
        }
    }
    text(area, words, 12, (left + 28, middle - 6))
}

/// The figure in words.
fn description(
    model: &Model,
    units: &Units,
    samples: &[Sample],
    panels: &[Panel],
    (begin, end): (f64, f64),
) -> String {
    let mut words = format!("Over time from {} to {}: ", time_text(begin), time_text(end));
    let titles: Vec<&str> = panels.iter().map(|panel| panel.title.as_str()).collect();
    words.push_str(&titles.join("; "));
    words.push('.');
    let Some(last) = samples.last() else { return words };
    words.push_str(" At the end, ");
    let contacts = last.contacts.iter().enumerate().map(|(contact, now)| {
        let does = if now.phase == crate::motion::Phase::Stick { "sticks" } else { "moves" };
        if model.balls() > 0 {
            format!("ball {} {does} at {:.4} rad", contact + 1, in_circle(now.position))
        } else {
            format!("the block {does} at {:.6} m", now.position * units.position)
        }
    });
    words.push_str(&contacts.collect::<Vec<String>>().join(", "));
    if let (true, Some([x, y, ..])) = (model.balls() > 0, last.table) {
        let away = 1e3 * units.length_m * (x * x + y * y).sqrt();
        let _ = write!(words, "; the table is displaced by {away:.4} mm");
    }
    words.push('.');
    words
}
