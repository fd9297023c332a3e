//! Figures for papers: as SVG, with words that stay words, and as PNG with 300 dots per inch.
//!
//! Own drawing rather than a library's: dots as one path, dashes, clipping and a description for those who
//! do not see it keep a figure of 20,000 dots small and readable, and one font in the program makes its
//! layout, and its bitmap to the byte, the same on every machine.

mod axes;
mod colour_bar;
mod colours;
mod font;
mod layout;
mod legend;
mod marks;
mod raster;
mod scene;
mod svg;

use thiserror::Error;

use super::chart::{Figure, Mark, TipValues};
use super::course::thinned;

pub use colours::SERIES;

/// A figure could not be drawn.
#[derive(Debug, Error)]
#[error("the figure could not be drawn: {0}")]
pub struct PaperError(String);

/// What figures are written as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Lines and words.
    Svg,
    /// Pixels.
    Png,
}

impl Format {
    /// The end of files' names.
    pub fn extension(self) -> &'static str {
        match self {
            Format::Svg => "svg",
            Format::Png => "png",
        }
    }
}

/// Most panels on a sheet.
const SHEET: usize = 12;
/// Most dots of a panel.
const DOTS: usize = 20_000;
/// Places along a line that can be told apart.
const BINS: u32 = 1200;

/// A figure on paper: a sheet, or several where it has more panels than one holds. Each has a name, that of
/// the figure with a number where there are several.
pub fn sheets(figure: &Figure) -> Vec<(String, Sheet)> {
    let mut figure = reduced(figure);
    let panels = std::mem::take(&mut figure.panels);
    let alone = panels.len() < 2;
    let several = panels.len() > SHEET;
    let mut sheets = Vec::new();
    for (number, part) in panels.chunks(SHEET).enumerate() {
        let name = match several {
            false => figure.id.clone(),
            true => format!("{}-{}", figure.id, number + 1),
        };
        let part = Figure { id: name.clone(), panels: part.to_vec(), ..figure.clone() };
        sheets.push((name, Sheet { figure: part, first: number * SHEET, alone }));
    }
    sheets
}

/// A page's worth of a figure.
#[derive(Clone, Debug)]
pub struct Sheet {
    figure: Figure,
    first: usize,
    alone: bool,
}

impl Sheet {
    /// The caption, which says where dots were left out.
    pub fn caption(&self) -> &str {
        &self.figure.caption
    }

    /// The file in a format.
    ///
    /// # Errors
    /// Where its pixels have no room.
    pub fn file(&self, format: Format) -> Result<Vec<u8>, PaperError> {
        let scene = layout::scene(&self.figure, self.first, self.alone);
        match format {
            Format::Svg => Ok(svg::svg(&scene, &self.figure).into_bytes()),
            Format::Png => raster::png(&scene, &self.figure),
        }
    }
}

/// A figure with no more dots than paper shows, and no more points of a line than it resolves; the caption
/// says where dots were left out.
fn reduced(figure: &Figure) -> Figure {
    let mut figure = figure.clone();
    let (mut shown, mut of) = (0, 0);
    for panel in &mut figure.panels {
        let all: usize = panel.layers.iter().map(|layer| dots(&layer.mark)).sum();
        let part = (DOTS as f64 / all.max(1) as f64).min(1.0);
        for layer in &mut panel.layers {
            if part < 1.0 {
                of += dots(&layer.mark);
                thin_out(&mut layer.mark, part);
                shown += dots(&layer.mark);
            }
            if let Mark::Line { points, .. } = &mut layer.mark {
                *points = resolved(points);
            }
        }
    }
    if of > 0 {
        let note = format!("Of {of} dots {shown} are drawn, evenly chosen.");
        figure.caption = [figure.caption.trim_end(), &note].join(" ").trim_start().to_owned();
    }
    figure
}

fn dots(mark: &Mark) -> usize {
    match mark {
        Mark::Dots { x, .. } => x.len(),
        _ => 0,
    }
}

/// Keeps a part of the dots, evenly by their numbers.
fn thin_out(mark: &mut Mark, part: f64) {
    let Mark::Dots { x, y, tips, .. } = mark else { return };
    let kept: Vec<usize> = (0..x.len())
        .filter(|&k| ((k + 1) as f64 * part).floor() > (k as f64 * part).floor())
        .collect();
    let chosen = |values: &[f64]| kept.iter().filter_map(|&k| values.get(k).copied()).collect();
    (*x, *y) = (chosen(x), chosen(y));
    tips.run_ids = kept.iter().filter_map(|&k| tips.run_ids.get(k).copied()).collect();
    for column in &mut tips.columns {
        match &mut column.values {
            TipValues::Numbers(values) => *values = chosen(values),
            TipValues::Words(words) => {
                *words = kept.iter().filter_map(|&k| words.get(k).cloned()).collect();
            }
        }
    }
}

/// A line over ascending abscissas as far as paper resolves it, with all extremes; others as they are.
fn resolved(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let gap = |point: &[f64; 2]| !point.iter().all(|value| value.is_finite());
    let whole = points.iter().filter(|point| !gap(point));
    let ascending = whole.clone().zip(whole.clone().skip(1)).all(|(a, b)| a[0] <= b[0]);
    let (Some(first), Some(last)) = (whole.clone().next(), whole.clone().next_back()) else {
        return Vec::new();
    };
    if points.len() < 4 * BINS as usize || !ascending {
        return points.to_vec();
    }
    let range = (first[0], last[0]);
    let piece = |piece: &[[f64; 2]]| -> Vec<[f64; 2]> {
        let pairs: Vec<(f64, f64)> = piece.iter().map(|[x, y]| (*x, *y)).collect();
        thinned(&pairs, range, BINS).into_iter().map(|(x, y)| [x, y]).collect()
    };
    let pieces: Vec<Vec<[f64; 2]>> = points.split(gap).map(piece).collect();
    pieces.join(&[[f64::NAN; 2]][..])
}

/// Whether a file says of itself that this program has made it.
pub fn is_ours(content: &[u8]) -> bool {
    let head = &content[..content.len().min(4096)];
    let has = |sign: &[u8]| head.windows(sign.len()).any(|part| part == sign);
    has(b"made by stickslip ") || has(b"Software\0stickslip ")
}
