//! Draws what is shown over time: axes, shading, curves, and at their ends whose they are.

use plotters::coord::Shift;
use plotters::prelude::*;

use super::axis::Axis;
use super::quantity::{Of, Panel};
use crate::report::course::simplified;
use crate::report::paper::SERIES;

/// The library draws on whole pixels: so many of its pixels are one of the figure.
pub(super) const FINE: u32 = 4;
/// Beside the axes, px: titles above, numbers to the left, balls' numbers to the right.
pub(super) const ABOVE: u32 = 24;
pub(super) const LEFT: u32 = 64;
pub(super) const RIGHT: u32 = 34;
/// Below the axes, and below the last ones, which have numbers, px.
pub(super) const BELOW: u32 = 10;
pub(super) const BELOW_LAST: u32 = 36;

pub(super) const STUCK: RGBColor = RGBColor(222, 222, 222);
pub(super) const GRID: RGBColor = RGBColor(232, 232, 232);
pub(super) const LIMIT: RGBColor = RGBColor(120, 120, 120);
const TABLE: RGBColor = RGBColor(60, 60, 60);

/// A colour that colour-blind readers can tell from its neighbours.
pub(super) fn series_colour(number: usize) -> RGBColor {
    let [red, green, blue] = SERIES[number % SERIES.len()];
    RGBColor(red, green, blue)
}

/// What no eye sees, px.
pub(super) const TOLERANCE: f64 = 0.15;
/// Rows of text, px.
const ROW: f64 = 11.0;

pub(super) type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
pub(super) type Drawn = Result<(), Box<dyn std::error::Error>>;

pub(super) fn font(size: u32) -> (&'static str, u32) {
    ("sans-serif", FINE * size)
}

/// Text at a place in px.
pub(super) fn text(area: &Area<'_>, words: &str, size: u32, (x, y): (u32, u32)) -> Drawn {
    let style = TextStyle::from(font(size).into_font()).color(&BLACK);
    area.draw(&Text::new(words.to_owned(), place(x, y), style))?;
    Ok(())
}

/// A place in px as one of the library.
pub(super) fn place(x: u32, y: u32) -> (i32, i32) {
    ((FINE * x) as i32, (FINE * y) as i32)
}

impl Of {
    /// The colour of a curve, and its width in the library's pixels.
    pub(super) fn stroke(self) -> (RGBColor, u32) {
        match self {
            Of::Contact(contact) => (series_colour(contact), 4),
            Of::Running(contact) => (pale(series_colour(contact)), 3),
            Of::Table => (TABLE, 4),
            Of::Limit => (LIMIT, 3),
        }
    }
}

/// The colour on white paper, thin.
pub(super) fn pale(RGBColor(red, green, blue): RGBColor) -> RGBColor {
    let mixed = |part: u8| 255 - (255 - part) / 3;
    RGBColor(mixed(red), mixed(green), mixed(blue))
}

/// Draws a panel on an area of its own; the last one has the numbers of the time axis, and their unit. The
/// panels of balls number the ends of curves.
pub(super) fn draw(
    area: &Area<'_>,
    panel: &Panel,
    time: &Axis,
    width: u32,
    last: Option<&str>,
    numbered: bool,
) -> Drawn {
    let values = panel.curves.iter().flat_map(|curve| curve.points.iter().map(|(_, value)| *value));
    let about = if panel.height < 100 { 3 } else { 5 };
    let ordinate = if panel.angle { Axis::angle() } else { Axis::around(values, about) };
    text(area, &panel.title, 12, (LEFT, 6))?;
    let mut chart = ChartBuilder::on(area)
        .margin_top(FINE * ABOVE)
        .margin_right(FINE * RIGHT)
        .x_label_area_size(FINE * if last.is_some() { BELOW_LAST } else { BELOW })
        .y_label_area_size(FINE * LEFT)
        .build_cartesian_2d(time.clone(), ordinate.clone())?;
    chart.draw_series(panel.shaded.iter().map(|(begin, end)| {
        Rectangle::new([(*begin, ordinate.from), (*end, ordinate.to)], STUCK.filled())
    }))?;
    let mut mesh = chart.configure_mesh();
    mesh.axis_desc_style(font(12))
        .label_style(font(11))
        .set_all_tick_mark_size(FINE * 3)
        .light_line_style(TRANSPARENT)
        .bold_line_style(GRID.stroke_width(FINE))
        .axis_style(BLACK.stroke_width(FINE));
    match last {
        Some(unit) => mesh.x_desc(format!("time [{unit}]")),
        None => mesh.x_label_formatter(&|_| String::new()),
    };
    mesh.draw()?;
    let scale = (
        f64::from(width) / (time.to - time.from),
        f64::from(panel.height) / (ordinate.to - ordinate.from),
    );
    for curve in &panel.curves {
        let (colour, stroke) = curve.of.stroke();
        let points = simplified(&curve.points, scale, TOLERANCE);
        chart.draw_series(LineSeries::new(points, colour.stroke_width(stroke)))?;
    }
    if !numbered {
        return Ok(());
    }
    // The last curve of each ball ends at the right.
    let mut ends: Vec<(usize, f64)> = Vec::new();
    for curve in &panel.curves {
        if let (Of::Contact(ball), Some((_, value))) = (curve.of, curve.points.last()) {
            ends.retain(|(other, _)| *other != ball);
            ends.push((ball, f64::from(ABOVE) + (ordinate.to - value) * scale.1));
        }
    }
    let range = (f64::from(ABOVE), f64::from(ABOVE + panel.height));
    for ((ball, end), row) in ends.iter().zip(rows(&ends, range)) {
        let right = LEFT + width;
        let fine = |y: f64| (f64::from(FINE) * y).round() as i32;
        let [from, to] = [right + 2, right + 14].map(|x| (FINE * x) as i32);
        let line = [(from, fine(*end)), (to, fine(row))];
        area.draw(&PathElement::new(line, series_colour(*ball).stroke_width(4)))?;
        let style = TextStyle::from(font(11).into_font()).color(&BLACK);
        let number =
            Text::new((ball + 1).to_string(), (to + FINE as i32 * 3, fine(row - 3.5)), style);
        area.draw(&number)?;
    }
    Ok(())
}

/// Ticks of the time axis, about.
pub(super) const TIMES: u32 = 9;

/// Rows of text near the places that they belong to, in the same order from above and apart from each
/// other, as far as there is room.
fn rows(ends: &[(usize, f64)], (top, bottom): (f64, f64)) -> Vec<f64> {
    let mut order: Vec<usize> = (0..ends.len()).collect();
    order.sort_by(|a, b| ends[*a].1.total_cmp(&ends[*b].1).then(a.cmp(b)));
    let mut places = vec![0.0; ends.len()];
    let mut least = top;
    for index in &order {
        places[*index] = ends[*index].1.max(least);
        least = places[*index] + ROW;
    }
    let mut most = bottom;
    for index in order.iter().rev() {
        places[*index] = places[*index].min(most);
        most = places[*index] - ROW;
    }
    places
}

#[cfg(test)]
mod tests {
    use super::{ROW, rows};

    #[test]
    fn numbers_do_not_lie_upon_each_other() {
        let ends: Vec<(usize, f64)> =
            [150.0, 148.0, 149.0, 10.0, 150.0].into_iter().enumerate().collect();
        let places = rows(&ends, (0.0, 150.0));
        let mut sorted = places.clone();
        sorted.sort_by(f64::total_cmp);
        assert!(sorted.windows(2).all(|pair| pair[1] - pair[0] >= ROW), "{places:?}");
        assert_eq!((places[3], sorted[4]), (10.0, 150.0));
        assert!(places[1] < places[2] && places[2] < places[0] && places[0] < places[4]);
    }
}
