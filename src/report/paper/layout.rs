//! Where on a sheet panels, axes, legend and colour bars are.
//!
//! Nothing is put over the data: the legend is above the panels, colour bars are to their right, and words
//! at upright rules above them. All panels have one size; axes that are alike are written once.

use super::axes::{Ruled, SIZE, Which, ruled, with_minus};
use super::colour_bar::{Bar, bar, bar_width, draw_bar};
use super::colours::INK;
use super::font;
use super::legend::{contradict, legend};
use super::marks::{self, Frame};
use super::scene::{Anchor, Box2, Item, Paint, Scene, Step, Stroke};
use crate::report::chart::{AxisKind, Figure, Panel};

const MILLIMETRE: f64 = 72.0 / 25.4;
/// Widths of a column of a journal and of its page, mm.
const WIDTHS: [f64; 2] = [90.0, 180.0];
/// Between the lines of words that belong together.
pub(super) const LEADING: f64 = 10.0;
pub(super) const TICK: f64 = 3.0;
const EDGE: f64 = 2.0;
/// Between an ordinate's ticks with their words and its name.
const NAME: f64 = 6.0;
/// Longest turned name.
const LONGEST: f64 = 110.0;
/// The part of a turned word's length that is to the left and below.
const SLANT: f64 = std::f64::consts::FRAC_1_SQRT_2;

/// What is beside a panel.
struct Cell<'a> {
    panel: &'a Panel,
    x: Ruled,
    y: Ruled,
    title: Vec<String>,
    shows: [bool; 2],
    bar: Option<Bar>,
    turned: bool,
    /// The names of both axes in lines that have room.
    names: [Vec<String>; 2],
    /// Height of a legend of its own.
    legend: f64,
}

/// A colour bar.
/// How many panels are side by side.
fn columns(panels: usize) -> usize {
    match panels {
        0 | 1 => 1,
        2 | 4 => 2,
        _ => 3,
    }
}

/// The height of a panel over its width.
fn aspect(panel: &Panel, columns: usize) -> f64 {
    match (&panel.x.kind, &panel.y.kind) {
        (AxisKind::Angle, AxisKind::Angle) => 1.0,
        (AxisKind::Hidden, AxisKind::Hidden) => {
            let extent = |range: Option<[f64; 2]>| range.map_or(1.0, |[from, to]| to - from);
            (extent(panel.y.range) / extent(panel.x.range)).clamp(0.3, 2.0)
        }
        _ if panel.x.name.starts_with("time") && columns < 3 => 0.6,
        _ => 0.75,
    }
}

/// Draws a figure of some panels; `first` is the number of the first one among all of the figure's.
pub fn scene(figure: &Figure, first: usize, alone: bool) -> Scene {
    let panels = &figure.panels;
    let many_names =
        |panel: &Panel| matches!(&panel.x.kind, AxisKind::Names(names) if names.len() > 6);
    let wide = panels.len() > 1 || panels.iter().any(many_names);
    let width = WIDTHS[usize::from(wide)] * MILLIMETRE;
    let columns = columns(panels.len());
    let rows = panels.len().div_ceil(columns);
    let shape = if wide && panels.len() == 1 {
        0.42
    } else {
        panels.iter().map(|panel| aspect(panel, columns)).fold(0.0, f64::max)
    };
    // The ordinates' words decide how wide the panels can be, and only roughly what their ticks are.
    let guess = width / columns as f64 - 46.0;
    let mut cells: Vec<Cell<'_>> = panels
        .iter()
        .enumerate()
        .map(|(number, panel)| Cell {
            panel,
            x: ruled(panel, Which::X, guess),
            y: ruled(panel, Which::Y, shape * guess),
            title: title(panel, (!alone).then_some(first + number), guess),
            shows: [true; 2],
            bar: bar(panel, shape * guess),
            turned: false,
            names: [Vec::new(), Vec::new()],
            legend: 0.0,
        })
        .collect();
    for cell in &mut cells {
        let spacing = guess / cell.x.ticks.len().max(1) as f64;
        let named = matches!(cell.panel.x.kind, AxisKind::Names(_));
        cell.turned = named && cell.x.widest() + 4.0 > spacing;
        cut_turned(cell);
        let split = |name: &str, room: f64| lines(name.split_whitespace(), room, 2);
        cell.names = [split(&cell.x.name, guess), split(&cell.y.name, shape * guess + 8.0)];
    }
    let common_bar = cells.len() > 1
        && panels.iter().all(|panel| panel.scale.is_some() && panel.scale == panels[0].scale);
    share(&mut cells, columns);
    let own_legends = contradict(panels);

    let names = |cell: &Cell<'_>| {
        let name = LEADING * cell.names[1].len() as f64;
        let shown = cell.shows[1] && !cell.y.hidden;
        let own = if shown { cell.y.widest() + TICK + NAME + name } else { 5.0 };
        let turned = cell.x.ticks.iter().filter(|_| cell.turned).map(|(value, words)| {
            SLANT * (font::width(words, SIZE) + SIZE) - cell.x.part(*value) * guess
        });
        turned.fold(own, f64::max)
    };
    let beyond = |cell: &Cell<'_>| {
        let last = cell.x.ticks.last().filter(|_| !cell.turned);
        let last = last.map_or(0.0, |(_, words)| font::width(words, SIZE) / 2.0);
        let bar = cell.bar.as_ref().filter(|_| !common_bar).map_or(0.0, bar_width);
        (last + 1.0).max(4.0).max(bar)
    };
    let in_column = |column: usize, what: &dyn Fn(&Cell<'_>) -> f64| {
        cells.iter().skip(column).step_by(columns).map(what).fold(0.0, f64::max)
    };
    let left: Vec<f64> = (0..columns).map(|column| in_column(column, &names)).collect();
    let right: Vec<f64> = (0..columns).map(|column| in_column(column, &beyond)).collect();
    let common = cells.first().and_then(|cell| cell.bar.clone()).filter(|_| common_bar);
    let beside = common.as_ref().map_or(0.0, bar_width);
    let taken = left.iter().chain(&right).sum::<f64>() + beside + 2.0 * EDGE;
    let panel_width = ((width - taken) / columns as f64).max(30.0);
    let panel_height = shape * panel_width;

    for cell in &mut cells {
        cell.x = ruled(cell.panel, Which::X, panel_width);
        cut_turned(cell);
        if own_legends {
            let own = std::slice::from_ref(cell.panel);
            cell.legend = legend(&mut Scene::default(), own, [0.0, 0.0, panel_width]);
        }
    }
    let above = |cell: &Cell<'_>| {
        let rules = marks::rule_words(cell.panel).any(|(upright, ..)| upright);
        LEADING * cell.title.len() as f64 + if rules { LEADING } else { 0.0 } + cell.legend + 4.0
    };
    let below = |cell: &Cell<'_>| {
        if !cell.shows[0] || cell.x.hidden {
            return 5.0;
        }
        let ticks = if cell.turned { SLANT * cell.x.widest() + 6.0 } else { SIZE };
        TICK + 3.0 + ticks + LEADING * cell.names[0].len() as f64 + 2.0
    };
    let in_row = |row: usize, what: &dyn Fn(&Cell<'_>) -> f64| {
        cells.iter().skip(row * columns).take(columns).map(what).fold(0.0, f64::max)
    };
    let mut scene = Scene { size: [width, 0.0], items: Vec::new() };
    let mut top = EDGE;
    if !own_legends {
        top += legend(&mut scene, panels, [EDGE + 3.0, EDGE, width - EDGE]);
    }
    let first_top = top + in_row(0, &above);
    let mut last_bottom = first_top + panel_height;
    for row in 0..rows {
        top += in_row(row, &above);
        let mut from = EDGE;
        for (column, cell) in cells.iter().skip(row * columns).take(columns).enumerate() {
            from += left[column];
            let area =
                Box2 { left: from, top, right: from + panel_width, bottom: top + panel_height };
            draw(&mut scene, cell, area);
            if let Some(bar) = cell.bar.as_ref().filter(|_| !common_bar) {
                draw_bar(&mut scene, bar, [area.right + 6.0, area.top, area.bottom]);
            }
            from += panel_width + right[column];
        }
        last_bottom = top + panel_height;
        top += panel_height + in_row(row, &below);
    }
    if let Some(bar) = &common {
        // Not longer than two panels: a reader looks it up at one place.
        let bottom = last_bottom.min(first_top + 2.0 * panel_height);
        draw_bar(&mut scene, bar, [width - EDGE - beside + 6.0, first_top, bottom]);
    }
    scene.size[1] = top + EDGE;
    scene
}

/// Cuts off turned names that would take more room than the panel.
fn cut_turned(cell: &mut Cell<'_>) {
    for (_, words) in cell.x.ticks.iter_mut().filter(|_| cell.turned) {
        *words = shortened(words, LONGEST);
    }
}

/// Axes that all panels have alike are written at the left and below only.
fn share(cells: &mut [Cell<'_>], columns: usize) {
    let count = cells.len();
    let alike =
        |axis: &dyn Fn(&Cell<'_>) -> Ruled| cells.iter().all(|cell| axis(cell) == axis(&cells[0]));
    let x = count > 1 && alike(&|cell| cell.x.clone());
    let y = count > 1 && alike(&|cell| cell.y.clone());
    for (place, cell) in cells.iter_mut().enumerate() {
        cell.shows = [!x || place + columns >= count, !y || place % columns == 0];
    }
}

/// A panel's title with its letter, in lines that have room.
fn title(panel: &Panel, number: Option<usize>, width: f64) -> Vec<String> {
    let letter = number.map(|number| {
        let letters = b"abcdefghijklmnopqrstuvwxyz";
        let last = char::from(letters[number % 26]);
        let before = number / 26;
        match before {
            0 => format!("({last})"),
            _ => format!("({}{last})", char::from(letters[(before - 1) % 26])),
        }
    });
    let dash = if panel.title.is_empty() || panel.part.is_empty() { "" } else { "–" };
    let words = [&panel.title, dash, &panel.part].into_iter().flat_map(str::split_whitespace);
    let words: Vec<String> = letter.into_iter().chain(words.map(with_minus)).collect();
    lines(words.iter().map(String::as_str), width, 3)
}

/// Words in at most so many lines that have room; what has none is cut off.
pub(super) fn lines<'a>(
    words: impl Iterator<Item = &'a str>,
    width: f64,
    most: usize,
) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in words {
        match lines.last_mut() {
            Some(line) if font::width(&format!("{line} {word}"), SIZE) <= width => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(shortened(word, width)),
        }
    }
    if lines.len() > most {
        lines.truncate(most);
        if let Some(last) = lines.last_mut() {
            *last = shortened(&format!("{last} …"), width);
        }
    }
    lines
}

/// Words cut off where they have no room.
pub(super) fn shortened(words: &str, width: f64) -> String {
    if font::width(words, SIZE) <= width {
        return words.to_owned();
    }
    let mut short: String = words.to_owned();
    while !short.is_empty() && font::width(&format!("{short}…"), SIZE) > width {
        short.pop();
    }
    short + "…"
}

fn draw(scene: &mut Scene, cell: &Cell<'_>, area: Box2) {
    let frame = Frame { area, x: &cell.x, y: &cell.y };
    marks::draw(scene, &frame, cell.panel);
    let black = |width| Stroke { paint: Paint::of(INK), width, dash: Vec::new() };
    if !(cell.x.hidden && cell.y.hidden) {
        scene.line(area.steps(), black(0.6), None);
    }
    let [width, height] = [area.right - area.left, area.bottom - area.top];
    let mut ticks = Vec::new();
    let inside = |part: &f64| (-1e-6..=1.0 + 1e-6).contains(part);
    for (value, length) in every_tick(&cell.x) {
        let part = cell.x.part(value);
        if inside(&part) {
            let x = area.left + part * width;
            ticks.extend([Step::Move([x, area.bottom]), Step::Line([x, area.bottom + length])]);
        }
    }
    for (value, length) in every_tick(&cell.y) {
        let part = cell.y.part(value);
        if inside(&part) {
            let y = area.bottom - part * height;
            ticks.extend([Step::Move([area.left, y]), Step::Line([area.left - length, y])]);
        }
    }
    scene.line(ticks, black(0.6), None);
    if cell.shows[0] && !cell.x.hidden {
        let line = area.bottom + TICK + 1.0 + 0.85 * SIZE;
        let mut lowest = line;
        for (value, words) in &cell.x.ticks {
            let part = cell.x.part(*value);
            if !inside(&part) {
                continue;
            }
            let x = area.left + part * width;
            if cell.turned {
                let words = words.clone();
                let at = [x + 2.0, line - 0.3 * SIZE];
                let item = Item::Text { at, size: SIZE, anchor: Anchor::End, turned: -45.0, words };
                scene.items.push(item);
                lowest = line + SLANT * cell.x.widest() - 2.0;
            } else {
                scene.text([x, line], SIZE, Anchor::Middle, words);
            }
        }
        let middle = area.left + width / 2.0;
        for (place, words) in cell.names[0].iter().enumerate() {
            let y = lowest + LEADING * (place + 1) as f64 + 1.0;
            scene.text([middle, y], SIZE, Anchor::Middle, words);
        }
    }
    if cell.shows[1] && !cell.y.hidden {
        for (value, words) in &cell.y.ticks {
            let part = cell.y.part(*value);
            if inside(&part) {
                let y = area.bottom - part * height + 0.36 * SIZE;
                scene.text([area.left - TICK - 2.0, y], SIZE, Anchor::End, words);
            }
        }
        let right = area.left - TICK - NAME - cell.y.widest();
        for (place, words) in cell.names[1].iter().rev().enumerate() {
            upright(scene, [right - LEADING * place as f64, area.top + height / 2.0], words);
        }
    }
    rules(scene, cell, area);
    let rules = marks::rule_words(cell.panel).any(|(upright, ..)| upright);
    let lift = if rules { LEADING } else { 0.0 } + cell.legend;
    if cell.legend > 0.0 {
        let own = std::slice::from_ref(cell.panel);
        legend(scene, own, [area.left, area.top - 2.0 - lift, area.right]);
    }
    for (place, line) in cell.title.iter().rev().enumerate() {
        let y = area.top - 4.0 - lift - LEADING * place as f64;
        scene.text([area.left, y], SIZE, Anchor::Start, line);
    }
}

/// Words that are read from below.
pub(super) fn upright(scene: &mut Scene, at: [f64; 2], words: &str) {
    let words = words.to_owned();
    let item = Item::Text { at, size: SIZE, anchor: Anchor::Middle, turned: -90.0, words };
    scene.items.push(item);
}

fn every_tick(ruled: &Ruled) -> impl Iterator<Item = (f64, f64)> {
    let major = ruled.ticks.iter().map(|(value, _)| (*value, TICK));
    major.chain(ruled.minor.iter().map(|value| (*value, 0.6 * TICK)))
}

/// What is written at rules: above upright ones, as far as there is room beside each other; at the right
/// end of others.
fn rules(scene: &mut Scene, cell: &Cell<'_>, area: Box2) {
    let mut upright: Vec<(f64, &str, f64)> = Vec::new();
    for (stands, at, words, width) in marks::rule_words(cell.panel) {
        if stands {
            let x = area.left + cell.x.part(at) * (area.right - area.left);
            if (area.left - 1e-6..=area.right + 1e-6).contains(&x) {
                let most = (area.right - width / 2.0).max(area.left + width / 2.0);
                upright.push((x.clamp(area.left + width / 2.0, most), words, width));
            }
        } else {
            let y = area.bottom - cell.y.part(at) * (area.bottom - area.top);
            if (area.top - 1e-6..=area.bottom + 1e-6).contains(&y) {
                // Under the line where there is no room above it.
                let under = y - SIZE < area.top + 2.0;
                let line = if under { y + SIZE + 1.0 } else { y - 2.5 };
                scene.text([area.right - 3.0, line], SIZE, Anchor::End, words);
            }
        }
    }
    upright.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut taken = f64::NEG_INFINITY;
    for (x, words, width) in upright {
        if x - width / 2.0 > taken {
            scene.text([x, area.top - 3.0], SIZE, Anchor::Middle, words);
            taken = x + width / 2.0 + 3.0;
        }
    }
}
