//! The legend: a sample and a name for each series, in rows.

use super::axes::{SIZE, with_minus};
use super::font;
use super::layout::{LEADING, shortened};
use super::marks::{self, SAMPLE};
use super::scene::{Anchor, Scene};
use crate::report::chart::{Colour, Layer, Mark, Panel};

/// Whether a look has one name in one panel and another in the next: a legend for all would mislead.
pub fn contradict(panels: &[Panel]) -> bool {
    let named = |panel: &Panel| -> Vec<(Colour, String)> {
        let named = panel.layers.iter().filter(|layer| !layer.name.is_empty());
        let series = named.filter(|layer| matches!(layer.colour, Colour::Series(_)));
        series.map(|layer| (layer.colour, layer.name.clone())).collect()
    };
    let all: Vec<Vec<(Colour, String)>> = panels.iter().map(named).collect();
    all.iter().enumerate().any(|(place, one)| {
        let later = all[place + 1..].iter().flatten();
        let has = |colour: Colour, name: &str| one.iter().any(|(c, n)| *c == colour && n == name);
        later
            .clone()
            .any(|(colour, name)| one.iter().any(|(own, _)| own == colour) && !has(*colour, name))
    })
}

/// Draws the legend in rows between two abscissas, from the top; returns how high it is.
pub fn legend(scene: &mut Scene, panels: &[Panel], [left, top, right]: [f64; 3]) -> f64 {
    let mut names: Vec<&str> = Vec::new();
    for layer in panels.iter().flat_map(|panel| &panel.layers) {
        let by_value = layer.colour == Colour::Scale
            && matches!(layer.mark, Mark::Regions { .. } | Mark::Cells { .. });
        if !layer.name.is_empty() && !by_value && !names.contains(&layer.name.as_str()) {
            names.push(&layer.name);
        }
    }
    if names.is_empty() {
        return 0.0;
    }
    let [mut x, mut y] = [left, top + 0.5 * LEADING];
    for name in names {
        let room = right - left - SAMPLE - 6.0;
        let words = shortened(&with_minus(name), room);
        let wide = SAMPLE + 4.0 + font::width(&words, SIZE);
        if x > left && x + wide > right {
            [x, y] = [left, y + LEADING + 1.5];
        }
        // All layers of the name in the first panel that has it.
        let of_name = |layer: &&Layer| layer.name == name;
        if let Some(panel) = panels.iter().find(|panel| panel.layers.iter().any(|l| l.name == name))
        {
            let dashes_mean = marks::dashes_mean(panel);
            for layer in panel.layers.iter().filter(of_name) {
                marks::sample(scene, layer, dashes_mean, [x, y]);
            }
        }
        scene.text([x + SAMPLE + 4.0, y + 0.36 * SIZE], SIZE, Anchor::Start, &words);
        x += wide + 12.0;
    }
    y - top + 0.5 * LEADING + 2.0
}
