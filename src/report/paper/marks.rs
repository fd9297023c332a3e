//! Marks of a panel as paths.

use super::axes::{Ruled, SIZE};
use super::colours::{self, INK};
use super::font;
use super::scene::{Anchor, Box2, Item, Paint, Scene, Step, Stroke};
use crate::report::chart::{Colour, Layer, Mark, Panel, Symbol};

/// The rectangle of a panel with its axes: where coordinates are on paper.
pub struct Frame<'a> {
    /// The rectangle.
    pub area: Box2,
    /// The abscissa.
    pub x: &'a Ruled,
    /// The ordinate.
    pub y: &'a Ruled,
}

impl Frame<'_> {
    /// Where coordinates are; nothing where one has no place.
    fn at(&self, [x, y]: [f64; 2]) -> Option<[f64; 2]> {
        let Box2 { left, top, right, bottom } = self.area;
        let place =
            [left + self.x.part(x) * (right - left), bottom - self.y.part(y) * (bottom - top)];
        // Far outside is outside; numbers stay small.
        place.iter().all(|value| value.is_finite()).then(|| place.map(|v| v.clamp(-1e4, 1e4)))
    }

    fn inside(&self, [x, y]: [f64; 2]) -> bool {
        let Box2 { left, top, right, bottom } = self.area;
        let near = 1e-6;
        (left - near..=right + near).contains(&x) && (top - near..=bottom + near).contains(&y)
    }

    /// A line, broken where a point has no place.
    fn line(&self, points: &[[f64; 2]]) -> Vec<Step> {
        let mut steps = Vec::new();
        let mut pen_is_down = false;
        for point in points {
            let place = self.at(*point);
            if let Some(place) = place {
                steps.push(if pen_is_down { Step::Line(place) } else { Step::Move(place) });
            }
            pen_is_down = place.is_some();
        }
        steps
    }

    fn ring(&self, ring: &[[f64; 2]]) -> Vec<Step> {
        let places: Vec<[f64; 2]> = ring.iter().filter_map(|point| self.at(*point)).collect();
        if places.len() < 3 {
            return Vec::new();
        }
        let mut steps: Vec<Step> = places.into_iter().map(Step::Line).collect();
        if let Step::Line(first) = steps[0] {
            steps[0] = Step::Move(first);
        }
        steps.push(Step::Close);
        steps
    }

    fn rectangle(&self, [left, right, low, high]: [f64; 4]) -> Option<Box2> {
        let (one, other) = (self.at([left, low])?, self.at([right, high])?);
        let [x, y] = [0, 1].map(|axis| [one[axis].min(other[axis]), one[axis].max(other[axis])]);
        Some(Box2 { left: x[0], top: y[0], right: x[1], bottom: y[1] })
    }
}

/// A line that stays at a value until the next point.
fn steps_of(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let mut corners = Vec::with_capacity(2 * points.len());
    for (place, point) in points.iter().enumerate() {
        corners.push(*point);
        if let Some(next) = points.get(place + 1) {
            corners.push([next[0], point[1]]);
        }
    }
    corners
}

/// A line of this width.
fn pen(paint: Paint, width: f64) -> Stroke {
    Stroke { paint, width, dash: Vec::new() }
}

/// How lines of a layer look: the dashes say which series it is, unless dashes have a meaning of their own.
pub fn line_style(layer: &Layer, dashed: bool, dashes_mean: bool) -> Stroke {
    let width = match layer.colour {
        Colour::Faint => 0.4,
        Colour::Ink => 0.8,
        _ => 1.1,
    };
    let pattern = if dashes_mean { usize::from(dashed) } else { colours::pattern(layer.colour) };
    Stroke { paint: colours::of(layer.colour), width, dash: colours::dash(pattern) }
}

/// Whether dashes in a panel mean what its layers say.
pub fn dashes_mean(panel: &Panel) -> bool {
    panel.layers.iter().any(|layer| matches!(layer.mark, Mark::Line { dashed: true, .. }))
}

/// Draws the marks of a panel.
pub fn draw(scene: &mut Scene, frame: &Frame<'_>, panel: &Panel) {
    let dashes_mean = dashes_mean(panel);
    for layer in &panel.layers {
        layer_of(scene, frame, panel, layer, dashes_mean);
    }
}

fn layer_of(scene: &mut Scene, frame: &Frame<'_>, panel: &Panel, layer: &Layer, dashes_mean: bool) {
    let paint = colours::of(layer.colour);
    let clip = Some(frame.area);
    let by_value = |value: f64| match (&panel.scale, layer.colour) {
        (Some(scale), Colour::Scale) => {
            let [from, to] = scale.range;
            Paint::of(colours::of_scale((value - from) / (to - from)))
        }
        _ => paint,
    };
    match &layer.mark {
        Mark::Line { points, dashed } => {
            scene.line(frame.line(points), line_style(layer, *dashed, dashes_mean), clip);
        }
        Mark::Steps { points } => {
            let style = line_style(layer, false, dashes_mean);
            scene.line(frame.line(&steps_of(points)), style, clip);
        }
        Mark::Band { x, low, high, steps } => {
            let edge = |values: &[f64]| -> Vec<[f64; 2]> {
                let points: Vec<[f64; 2]> =
                    x.iter().zip(values).map(|(x, value)| [*x, *value]).collect();
                if *steps { steps_of(&points) } else { points }
            };
            let upper = edge(high).into_iter().rev();
            let ring: Vec<[f64; 2]> = edge(low).into_iter().chain(upper).collect();
            scene.area(frame.ring(&ring), Paint { opacity: 0.22, ..paint }, clip);
        }
        Mark::Intervals { x, low, high } => {
            let mut steps = Vec::new();
            for ((x, low), high) in x.iter().zip(low).zip(high) {
                let (Some(low), Some(high)) = (frame.at([*x, *low]), frame.at([*x, *high])) else {
                    continue;
                };
                steps.extend([Step::Move(low), Step::Line(high)]);
                for [x, y] in [low, high] {
                    steps.extend([Step::Move([x - 1.6, y]), Step::Line([x + 1.6, y])]);
                }
            }
            scene.line(steps, pen(paint, 0.8), clip);
        }
        Mark::Bars { x, base, top, width } => {
            let pattern = colours::pattern(layer.colour);
            let mut lines = Vec::new();
            let mut outlines = Vec::new();
            for ((x, base), top) in x.iter().zip(base).zip(top) {
                let edges = [x - 0.5 * width, x + 0.5 * width, *base, *top];
                let Some(bar) = frame.rectangle(edges) else { continue };
                lines.extend(colours::hatch(pattern, bar));
                outlines.extend(bar.steps());
            }
            filled(scene, outlines, lines, paint, clip);
        }
        Mark::Dots { symbol, x, y, .. } => {
            let places = x.iter().zip(y).filter_map(|(x, y)| frame.at([*x, *y]));
            let places: Vec<[f64; 2]> = places.filter(|place| frame.inside(*place)).collect();
            symbols(scene, *symbol, &places, paint);
        }
        Mark::Regions { rings, values } => {
            // Rings of one colour that follow each other are one path.
            let mut run: Option<(Paint, Vec<Step>)> = None;
            for (place, ring) in rings.iter().enumerate() {
                let colour = by_value(values.get(place).copied().unwrap_or(f64::NAN));
                let steps = frame.ring(ring);
                match &mut run {
                    Some((kept, path)) if *kept == colour => path.extend(steps),
                    _ => region(scene, run.replace((colour, steps)), clip),
                }
            }
            region(scene, run, clip);
        }
        Mark::Cells { edges, values, .. } => {
            for (edges, value) in edges.iter().zip(values) {
                let (Some(cell), Some(value)) = (frame.rectangle(*edges), value) else { continue };
                region(scene, Some((by_value(*value), cell.steps())), clip);
            }
        }
        Mark::Rule { upright, at, .. } => {
            let [x, y] = [frame.x.range, frame.y.range];
            let ends =
                if *upright { [[*at, y[0]], [*at, y[1]]] } else { [[x[0], *at], [x[1], *at]] };
            let style = Stroke { dash: vec![2.5, 2.0], ..pen(paint, 0.7) };
            scene.line(frame.line(&ends), style, clip);
        }
        Mark::Words { at, words } => {
            for (at, words) in at.iter().zip(words) {
                if let Some([x, y]) = frame.at(*at) {
                    scene.text([x, y + 0.35 * SIZE], SIZE, Anchor::Middle, words);
                }
            }
        }
    }
}

/// A region, with a line of its own colour so that no seam shows.
fn region(scene: &mut Scene, region: Option<(Paint, Vec<Step>)>, clip: Option<Box2>) {
    let Some((paint, steps)) = region.filter(|(_, steps)| !steps.is_empty()) else { return };
    let stroke = Some(pen(paint, 0.15));
    scene.items.push(Item::Path { steps, fill: Some(paint), stroke, clip });
}

/// Areas, hatched or not, with a thin outline.
fn filled(
    scene: &mut Scene,
    outlines: Vec<Step>,
    hatching: Vec<Step>,
    paint: Paint,
    clip: Option<Box2>,
) {
    if outlines.is_empty() {
        return;
    }
    let hatched = !hatching.is_empty();
    // Under lines a paler colour; without them as it is.
    let pale = if hatched { Paint { opacity: 0.35, ..paint } } else { paint };
    scene.area(outlines.clone(), Paint::of([255; 3]), clip);
    scene.area(outlines.clone(), pale, clip);
    scene.line(hatching, pen(paint, 0.7), clip);
    scene.line(outlines, pen(Paint::of(INK), 0.35), clip);
}

/// Draws symbols at points.
pub fn symbols(scene: &mut Scene, symbol: Symbol, places: &[[f64; 2]], paint: Paint) {
    if symbol == Symbol::Dot {
        let points = places.iter().copied().map(Step::Point).collect();
        scene.line(points, pen(paint, 1.1), None);
        return;
    }
    if places.is_empty() {
        return;
    }
    let white = Paint::of([255; 3]);
    let steps: Vec<Step> = places.iter().flat_map(|place| shape(symbol, *place)).collect();
    let item = |fill, stroke| Item::Path { steps: steps.clone(), fill, stroke, clip: None };
    match symbol {
        Symbol::Circle => {
            scene.items.push(item(None, Some(pen(white, 2.0))));
            scene.items.push(item(Some(white), Some(pen(paint, 1.0))));
        }
        Symbol::Cross => {
            scene.items.push(item(None, Some(pen(white, 2.2))));
            scene.items.push(item(None, Some(pen(paint, 1.2))));
        }
        _ => {
            scene.items.push(item(None, Some(pen(white, 1.0))));
            scene.items.push(item(Some(paint), None));
        }
    }
}

/// The outline of a symbol.
fn shape(symbol: Symbol, [x, y]: [f64; 2]) -> Vec<Step> {
    let polygon = |corners: &[[f64; 2]]| {
        let mut steps: Vec<Step> =
            corners.iter().map(|[dx, dy]| Step::Line([x + dx, y + dy])).collect();
        if let Some(Step::Line(first)) = steps.first().copied() {
            steps[0] = Step::Move(first);
        }
        steps.push(Step::Close);
        steps
    };
    match symbol {
        Symbol::Dot | Symbol::Disc => vec![Step::Circle([x, y], 1.7)],
        Symbol::Circle => vec![Step::Circle([x, y], 1.7)],
        Symbol::Cross => vec![
            Step::Move([x - 2.1, y - 2.1]),
            Step::Line([x + 2.1, y + 2.1]),
            Step::Move([x - 2.1, y + 2.1]),
            Step::Line([x + 2.1, y - 2.1]),
        ],
        Symbol::Diamond => polygon(&[[0.0, -2.6], [2.6, 0.0], [0.0, 2.6], [-2.6, 0.0]]),
        Symbol::Triangle => polygon(&[[0.0, -2.6], [2.4, 1.8], [-2.4, 1.8]]),
        Symbol::Square => polygon(&[[-1.9, -1.9], [1.9, -1.9], [1.9, 1.9], [-1.9, 1.9]]),
        Symbol::Star => {
            // Five points; the inner corners of the regular star.
            let corner = |k: u32| {
                let radius = if k.is_multiple_of(2) { 3.4 } else { 3.4 * 0.4 };
                let (sine, cosine) = libm::sincos(f64::from(k) * std::f64::consts::PI / 5.0);
                [radius * sine, -radius * cosine]
            };
            polygon(&(0..10).map(corner).collect::<Vec<_>>())
        }
    }
}

/// The sample of a layer in the legend: 16 points wide, about a line of height.
pub fn sample(scene: &mut Scene, layer: &Layer, dashes_mean: bool, [x, y]: [f64; 2]) {
    let paint = colours::of(layer.colour);
    let across = || vec![Step::Move([x, y]), Step::Line([x + SAMPLE, y])];
    let block = Box2 { left: x + 2.0, top: y - 3.0, right: x + SAMPLE - 2.0, bottom: y + 3.0 };
    match &layer.mark {
        Mark::Line { dashed, .. } => {
            scene.line(across(), line_style(layer, *dashed, dashes_mean), None);
        }
        Mark::Steps { .. } => scene.line(across(), line_style(layer, false, dashes_mean), None),
        Mark::Rule { .. } => {
            scene.line(across(), Stroke { dash: vec![2.5, 2.0], ..pen(paint, 0.7) }, None);
        }
        Mark::Band { .. } => scene.area(block.steps(), Paint { opacity: 0.22, ..paint }, None),
        Mark::Intervals { .. } => {
            let x = x + SAMPLE / 2.0;
            let mut steps = vec![Step::Move([x, y - 3.2]), Step::Line([x, y + 3.2])];
            for y in [y - 3.2, y + 3.2] {
                steps.extend([Step::Move([x - 1.6, y]), Step::Line([x + 1.6, y])]);
            }
            scene.line(steps, pen(paint, 0.8), None);
        }
        Mark::Bars { .. } | Mark::Regions { .. } | Mark::Cells { .. } => {
            let pattern = match layer.mark {
                Mark::Bars { .. } => colours::pattern(layer.colour),
                _ => 0,
            };
            filled(scene, block.steps(), colours::hatch(pattern, block), paint, None);
        }
        Mark::Dots { symbol, .. } => {
            // A dot alone would not be seen.
            let symbol = if *symbol == Symbol::Dot { Symbol::Disc } else { *symbol };
            symbols(scene, symbol, &[[x + SAMPLE / 2.0, y]], paint);
        }
        Mark::Words { .. } => {}
    }
}

/// Width of a sample.
pub const SAMPLE: f64 = 17.0;

/// Words over a rule, and how wide they are.
pub fn rule_words(panel: &Panel) -> impl Iterator<Item = (bool, f64, &str, f64)> {
    panel.layers.iter().filter_map(|layer| match &layer.mark {
        Mark::Rule { upright, at, label } if !label.is_empty() => {
            Some((*upright, *at, label.as_str(), font::width(label, SIZE)))
        }
        _ => None,
    })
}
