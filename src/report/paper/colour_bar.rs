//! Colour bars: what the colours of regions and cells mean.

use super::axes::{Ruled, SIZE, Which, ruled};
use super::colours::{self, INK};
use super::layout::{LEADING, TICK, lines, upright};
use super::scene::{Anchor, Box2, Paint, Scene, Step, Stroke};
use crate::report::chart::{AxisKind, Colour, ColourScale, Mark, Panel};

/// How wide it is, pt.
const BAR: f64 = 7.0;

/// A colour bar with its axis.
#[derive(Clone)]
pub struct Bar {
    ruled: Ruled,
    steps: usize,
    /// Its name in lines that have room.
    name: Vec<String>,
}

/// The colour bar of a panel, in steps where its regions are bands of even width.
pub fn bar(panel: &Panel, height: f64) -> Option<Bar> {
    let scale = panel.scale.as_ref()?;
    let mut values: Vec<f64> = Vec::new();
    for layer in panel.layers.iter().filter(|layer| layer.colour == Colour::Scale) {
        if let Mark::Regions { values: more, .. } = &layer.mark {
            values.extend(more);
        }
    }
    values.sort_by(f64::total_cmp);
    values.dedup();
    let [from, to] = scale.range;
    let least = values.windows(2).map(|pair| pair[1] - pair[0]).fold(f64::INFINITY, f64::min);
    let steps = ((to - from) / least).round();
    let middle = |value: &f64| ((value - from) / (to - from) * steps).fract();
    let even = (2.0..=40.0).contains(&steps)
        && values.iter().all(|value| (middle(value) - 0.5).abs() < 1e-6);
    let ruled = scale_axis(scale, height);
    let name = lines(ruled.name.split_whitespace(), height + 8.0, 2);
    Some(Bar { ruled, steps: if even { steps as usize } else { 64 }, name })
}

fn scale_axis(scale: &ColourScale, height: f64) -> Ruled {
    let axis = crate::report::chart::Axis {
        name: String::new(),
        unit: String::new(),
        range: Some(scale.range),
        kind: AxisKind::Linear,
    };
    let panel = Panel {
        title: String::new(),
        part: String::new(),
        x: axis.clone(),
        y: axis,
        scale: None,
        layers: Vec::new(),
    };
    let mut ruled = ruled(&panel, Which::Y, height);
    // A power of ten that was taken out stays with the name.
    ruled.name = match ruled.name.trim() {
        "" => scale.name.clone(),
        factor => format!("{} {factor}", scale.name),
    };
    ruled
}

/// How much room it takes beside a panel.
pub fn bar_width(bar: &Bar) -> f64 {
    6.0 + BAR + TICK + 2.0 + bar.ruled.widest() + LEADING * bar.name.len() as f64 + 7.0
}

/// Draws it between two ordinates.
pub fn draw_bar(scene: &mut Scene, bar: &Bar, [left, top, bottom]: [f64; 3]) {
    let right = left + BAR;
    let height = bottom - top;
    let edge = |step: usize| bottom - height * step as f64 / bar.steps as f64;
    for step in 0..bar.steps {
        let part = (step as f64 + 0.5) / bar.steps as f64;
        // Down to the lower end, so that no seam shows; the next one covers what is above.
        let block = Box2 {
            left,
            top: top.max(edge(step + 1)),
            right,
            bottom: bottom.min(edge(step) + 0.8),
        };
        scene.area(block.steps(), Paint::of(colours::of_scale(part)), None);
    }
    let black = || Stroke { paint: Paint::of(INK), width: 0.6, dash: Vec::new() };
    let mut lines = Box2 { left, top, right, bottom }.steps();
    for (value, words) in &bar.ruled.ticks {
        let y = bottom - bar.ruled.part(*value) * height;
        lines.extend([Step::Move([right, y]), Step::Line([right + TICK, y])]);
        scene.text([right + TICK + 2.0, y + 0.36 * SIZE], SIZE, Anchor::Start, words);
    }
    scene.line(lines, black(), None);
    let x = right + TICK + 2.0 + bar.ruled.widest() + SIZE + 2.0;
    for (place, words) in bar.name.iter().enumerate() {
        upright(scene, [x + LEADING * place as f64, top + height / 2.0], words);
    }
}
