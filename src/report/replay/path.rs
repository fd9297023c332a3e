//! Draws the path of the table, as the disc sees it and in space.

use plotters::prelude::*;

use super::axis::Axis;
use super::panel::{
    ABOVE, Area, Drawn, FINE, GRID, LEFT, TOLERANCE, font, pale, series_colour, text,
};
use crate::report::course::simplified;

/// Radius of the dot at the end, in the library's pixels.
const DOT: u32 = 3 * FINE;
/// Below the axes, px.
const BELOW: u32 = 22;
/// Side of what is between the axes, px.
pub(super) const SIDE: u32 = 320;

/// Most points of the beginning, and of the end.
const MOST_POINTS: usize = 3000;
/// The end of a path: this part of the time.
const END: f64 = 0.2;

/// A path: places at times, mm and s.
pub(super) struct Path {
    begin: Vec<(f64, f64)>,
    end: Vec<(f64, f64)>,
    /// How long the beginning lasts, and the end, s.
    times: [(f64, f64); 2],
    /// Farthest coordinate from the middle.
    most: f64,
}

impl Path {
    /// The beginning of a path and its end, as far as these many points show it.
    pub(super) fn new(course: &[(f64, [f64; 2])]) -> Self {
        let most = course.iter().flat_map(|(_, place)| place);
        let most = most.fold(0.0_f64, |most, value| most.max(value.abs()));
        let most = if most > 0.0 { most } else { 1.0 };
        let scale = f64::from(SIDE) / (2.0 * most);
        let places = |part: &[(f64, [f64; 2])]| {
            let places: Vec<(f64, f64)> = part.iter().map(|(_, [x, y])| (*x, *y)).collect();
            simplified(&places, (scale, scale), TOLERANCE)
        };
        let from = course.first().map_or(0.0, |(time, _)| *time);
        let to = course.last().map_or(0.0, |(time, _)| *time);
        let late = course.partition_point(|(time, _)| *time < to - END * (to - from));
        // Points lie closer than a picture needs: a part is halved until it has few enough.
        let mut early = course.len();
        let mut begin = places(course);
        while begin.len() > MOST_POINTS {
            early /= 2;
            begin = places(&course[..early]);
        }
        let mut late = late.min(course.len());
        let mut end = places(&course[late..]);
        while end.len() > MOST_POINTS {
            late += (course.len() - late) / 2;
            end = places(&course[late..]);
        }
        let time = |index: usize| course.get(index).map_or(to, |(time, _)| *time);
        let (early, late) = (time(early), time(late));
        Path { begin, end, times: [(from, early.min(late)), (late, to)], most }
    }

    /// Which times are pale, and which dark.
    pub(super) fn told(&self) -> String {
        let [(from, early), (late, to)] = self.times;
        let (axis, unit) = Axis::time(from, to, 100);
        let [from, early, late, to] = [from, early, late, to].map(|time| axis.label(time));
        format!(
            "pale from {from} to {early} {unit}, dark from {late} to {to} {unit}, dot at the end"
        )
    }
}

/// Draws a path on an area of its own.
pub(super) fn draw(area: &Area<'_>, title: &str, path: &Path) -> Drawn {
    text(area, title, 12, (LEFT, 6))?;
    let axis = Axis::new(-1.08 * path.most, 1.08 * path.most, 5);
    let mut chart = ChartBuilder::on(area)
        .margin_top(FINE * ABOVE)
        .x_label_area_size(FINE * BELOW)
        .y_label_area_size(FINE * LEFT)
        .margin_right(FINE * (WIDTH - LEFT - SIDE))
        .build_cartesian_2d(axis.clone(), axis)?;
    chart
        .configure_mesh()
        .axis_desc_style(font(12))
        .label_style(font(11))
        .set_all_tick_mark_size(FINE * 3)
        .light_line_style(TRANSPARENT)
        .bold_line_style(GRID.stroke_width(FINE))
        .axis_style(BLACK.stroke_width(FINE))
        .draw()?;
    let pale = pale(series_colour(0)).stroke_width(2);
    chart.draw_series(LineSeries::new(path.begin.iter().copied(), pale))?;
    let dark = series_colour(0).stroke_width(4);
    chart.draw_series(LineSeries::new(path.end.iter().copied(), dark))?;
    let dot = path.end.last().map(|last| Circle::new(*last, DOT, series_colour(1).filled()));
    chart.draw_series(dot)?;
    Ok(())
}

/// Width of the area of a path, px, and its height.
pub(super) const WIDTH: u32 = 450;
pub(super) const HEIGHT: u32 = ABOVE + SIDE + BELOW;
