//! The amplitude over the equilibrium set of two balls as a surface in space (thesis figure 5.2).
//!
//! An oblique projection: the angle of ball 1 to the right, that of ball 2 to the back, the amplitude
//! upwards. What is in front is drawn later and covers what is behind.

use std::f64::consts::{PI, TAU};

use crate::analysis::{RestForm, amplitude_without_balls};
use crate::model::Machine;
use crate::report::chart::{Axis, AxisKind, Colour, ColourScale, Figure, Layer, Mark, Panel};

/// Cells per axis.
const CELLS: usize = 80;
/// Cells between lines on the surface.
const LINES: usize = 8;
/// How far one radian to the back moves a point to the right and up, in radians to the right.
const BACK: [f64; 2] = [0.42, 0.66];
/// Height of the largest amplitude, in the same unit.
const HEIGHT: f64 = 3.8;

/// A corner of the surface: angles, amplitude in µm, friction margin.
#[derive(Clone, Copy)]
struct Corner {
    beta: [f64; 2],
    amplitude: f64,
    margin: f64,
}

/// The figure; none unless the machine has two balls and turns.
pub fn surface(machine: &Machine) -> Option<Figure> {
    let form = RestForm::new(machine)?;
    if form.mass.len() != 2 || form.speed == 0.0 || !form.transfer.is_finite() {
        return None;
    }
    let corner = |[i, j]: [usize; 2]| {
        let beta = [i, j].map(|k| k as f64 / CELLS as f64 * TAU);
        let rest = form.at_rest(&beta);
        let (amplitude, margin) = (1e6 * rest.amplitude_m, rest.friction_margin().max(-1e3));
        Corner { beta, amplitude, margin }
    };
    let corners: Vec<Vec<Corner>> =
        (0..=CELLS).map(|i| (0..=CELLS).map(|j| corner([i, j])).collect()).collect();
    let all = corners.iter().flatten();
    let highest = all.map(|corner| corner.amplitude).fold(0.0, f64::max);
    let step = step_below(highest);
    let top = (highest / step).ceil() * step;
    let place = |[first, second]: [f64; 2], amplitude: f64| {
        let [right, up] = BACK;
        let place = [first + right * second, up * second + HEIGHT * amplitude / top];
        place.map(|value| (value * 1e4).round() / 1e4)
    };

    let mut layers = floor(&place, step, top);
    for j in (0..CELLS).rev() {
        let (mut rings, mut values, mut mesh) = (Vec::new(), Vec::new(), Vec::new());
        for i in 0..CELLS {
            let cell = [corners[i][j], corners[i + 1][j], corners[i + 1][j + 1], corners[i][j + 1]];
            let held = within(&cell);
            if held.len() < 3 {
                continue;
            }
            rings.push(held.iter().map(|corner| place(corner.beta, corner.amplitude)).collect());
            let mean = held.iter().map(|corner| corner.amplitude).sum::<f64>() / held.len() as f64;
            // In steps that are not seen, so that neighbours share a path.
            values.push((mean / top * 60.0).round() / 60.0 * top);
            for (drawn, ends) in [(j % LINES == 0, [0, 1]), (i % LINES == 0, [0, 3])] {
                let edge = within(&ends.map(|k| cell[k]));
                if drawn && edge.len() > 1 {
                    mesh.extend(edge.iter().map(|corner| place(corner.beta, corner.amplitude)));
                    mesh.push([f64::NAN; 2]);
                }
            }
        }
        layers.push(plain(Colour::Scale, Mark::Regions { rings, values }));
        layers.push(plain(Colour::Faint, Mark::Line { points: mesh, dashed: false }));
    }
    let without = 1e6 * amplitude_without_balls(machine)?;
    let corners = [[0.0, 0.0], [TAU, 0.0], [TAU, TAU], [0.0, TAU], [0.0, 0.0]];
    layers.push(Layer {
        name: format!("amplitude without balls: {without:.1} µm"),
        colour: Colour::Series(1),
        mark: Mark::Line {
            points: corners.map(|beta| place(beta, without)).to_vec(),
            dashed: true,
        },
    });
    let hidden = |range| Axis {
        name: String::new(),
        unit: String::new(),
        range: Some(range),
        kind: AxisKind::Hidden,
    };
    let panel = Panel {
        title: String::new(),
        part: String::new(),
        x: hidden([-1.5, TAU * (1.0 + BACK[0]) + 0.9]),
        y: hidden([-1.4, TAU * BACK[1] + HEIGHT + 0.3]),
        scale: Some(ColourScale { name: "amplitude [µm]".to_owned(), range: [0.0, top] }),
        layers,
    };
    Some(Figure {
        id: "equilibrium-surface".to_owned(),
        title: "Amplitude over the equilibrium set".to_owned(),
        caption: "Amplitude of the table wherever dry friction holds both balls, over their angles; dashed: \
                  the plane of the amplitude without balls."
            .to_owned(),
        alternative: format!(
            "The amplitude goes from 0, where the balls balance, up to {highest:.1} µm with both balls at \
             the imbalance; without balls it is {without:.1} µm."
        ),
        panels: vec![panel],
        one_at_a_time: false,
    })
}

fn plain(colour: Colour, mark: Mark) -> Layer {
    Layer { name: String::new(), colour, mark }
}

/// The part of a cell or an edge that is in the set (I. E. Sutherland and G. W. Hodgman, Commun. ACM 17
/// (1974) 32).
fn within(corners: &[Corner]) -> Vec<Corner> {
    let mut kept = Vec::new();
    for (place, one) in corners.iter().enumerate() {
        let other = &corners[(place + 1) % corners.len()];
        if one.margin >= 0.0 {
            kept.push(*one);
        }
        let closing = corners.len() == 2 && place == 1;
        if (one.margin >= 0.0) != (other.margin >= 0.0) && !closing {
            let part = one.margin / (one.margin - other.margin);
            let between = |a: f64, b: f64| a + part * (b - a);
            kept.push(Corner {
                beta: [0, 1].map(|axis| between(one.beta[axis], other.beta[axis])),
                amplitude: between(one.amplitude, other.amplitude),
                margin: 0.0,
            });
        }
    }
    kept
}

/// Five or so steps of 1, 2 or 5 times a power of ten.
fn step_below(highest: f64) -> f64 {
    let power = 10.0_f64.powf((highest / 5.0).max(f64::MIN_POSITIVE).log10().floor());
    let factors = [10.0, 5.0, 2.0].into_iter();
    let mut fitting = factors.filter(|factor| highest / (factor * power) >= 4.0);
    fitting.next().unwrap_or(1.0) * power
}

/// The floor, the axis of amplitudes, and the words at them.
fn floor(place: &dyn Fn([f64; 2], f64) -> [f64; 2], step: f64, top: f64) -> Vec<Layer> {
    let gap = [f64::NAN; 2];
    let mut lines = [[0.0, 0.0], [TAU, 0.0], [TAU, TAU], [0.0, TAU], [0.0, 0.0]]
        .map(|beta| place(beta, 0.0))
        .to_vec();
    let (mut at, mut words) = (Vec::new(), Vec::new());
    let names = ["0", "π/2", "π", "3π/2", "2π"];
    for (quarter, name) in names.into_iter().enumerate() {
        let angle = quarter as f64 * PI / 2.0;
        let (front, side) = (place([angle, 0.0], 0.0), place([TAU, angle], 0.0));
        lines.extend([gap, front, [front[0], front[1] - 0.12]]);
        lines.extend([gap, side, [side[0] + 0.12, side[1]]]);
        at.push([front[0], front[1] - 0.4]);
        words.push(name.to_owned());
        if quarter > 0 {
            at.push([side[0] + 0.8, side[1]]);
            words.push(name.to_owned());
        }
    }
    let back = place([0.0, 0.0], 0.0);
    lines.extend([gap, back, place([0.0, 0.0], top)]);
    for k in 0..=(top / step).round() as usize {
        let [x, y] = place([0.0, 0.0], k as f64 * step);
        lines.extend([gap, [x, y], [x - 0.12, y]]);
        at.push([x - 0.5, y]);
        words.push(format!("{}", ((k as f64 * step) * 1e6).round() / 1e6));
    }
    let [x, y] = place([PI, 0.0], 0.0);
    at.push([x, y - 1.0]);
    words.push("ball 1 [rad]".to_owned());
    let [x, y] = place([TAU, PI / 4.0], 0.0);
    at.push([x + 1.6, y - 0.45]);
    words.push("ball 2 [rad]".to_owned());
    vec![
        plain(Colour::Ink, Mark::Line { points: lines, dashed: false }),
        plain(Colour::Ink, Mark::Words { at, words }),
    ]
}
