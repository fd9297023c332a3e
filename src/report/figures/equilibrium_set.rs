//! The equilibrium set of two balls as the background of a panel: amplitude by colour where the balls can rest, and
//! the equilibria without friction (thesis section 5.2, figures 5.3 to 5.5).

use std::f64::consts::TAU;

use super::overlap::contact_angle_rad;
use crate::analysis::{
    FrictionlessEquilibrium, GridRow, HIGH_DRAG, RestForm, SetGrid, Stability,
    frictionless_equilibria, groups_of_identical,
};
use crate::model::{Machine, wrap_to_pi};
use crate::report::chart::{
    Axis, AxisKind, Colour, ColourScale, Layer, Mark, Symbol, TooltipColumn, TooltipValues,
    Tooltips, axis,
};
use crate::study::Unit;

/// The largest number of cells of the raster per axis: about half of a screen's pixels, in 50 kB of the page.
const MOST_CELLS: usize = 192;
/// The smallest number of cells per axis.
const FEWEST_CELLS: usize = 24;
/// About the largest number of round steps of the scale of amplitudes.
const STEPS: f64 = 12.0;

/// The layers of an equilibrium set over the angle of ball 1, to the right, and of ball 2, upwards.
#[derive(Clone, Debug, PartialEq)]
pub struct SetLayers {
    /// Meaning of the colours.
    pub scale: ColourScale,
    /// The amplitude at positions where the balls can rest.
    pub set: Layer,
    /// The equilibria without friction, to be drawn on top.
    pub frictionless: Vec<Layer>,
}

/// Returns the axis of a ball's angle.
pub fn angle_axis(ball: usize) -> Axis {
    let axis = axis(&format!("angle of ball {ball}"), "rad");
    Axis { range: Some([0.0, TAU]), kind: AxisKind::Angle, ..axis }
}

/// Returns the layers of a machine's equilibrium set; `None` unless the machine has two balls, turns, and has a
/// position of rest (a suspension without damping has none at its resonance).
/// Amplitudes are in this unit. The rasters of `panels` such sets together have at most `most` cells.
pub fn set_layers(machine: &Machine, unit: &Unit, panels: usize, most: usize) -> Option<SetLayers> {
    let each = (most as f64 / panels.max(1) as f64).sqrt() as usize;
    let cells = each.clamp(FEWEST_CELLS, MOST_CELLS);
    let form = RestForm::new(machine)?;
    if form.mass.len() != 2 || form.speed == 0.0 || !form.transfer.is_finite() {
        return None;
    }
    // Every second point of a grid with half the spacing is the centre of a cell.
    let grid = SetGrid::new(&form, 2 * cells)?;
    let contact = contact_angle_rad(machine).unwrap_or(0.0);
    let mut values = vec![f64::NAN; cells * cells];
    let mut row = GridRow::default();
    let (mut in_set, mut everywhere) = ([f64::INFINITY, 0.0], [f64::INFINITY, 0.0]);
    // The first angle runs along the rows of the raster, the second one upwards.
    for first in 0..cells {
        grid.fill(2 * first + 1, &mut row);
        for second in 0..cells {
            let rest = grid.at(&row, 2 * second + 1);
            let amplitude = unit.of(rest.amplitude_m);
            extend(&mut everywhere, amplitude);
            let apart = wrap_to_pi(TAU * (second as f64 - first as f64) / cells as f64).abs();
            if rest.in_set() && apart >= contact {
                extend(&mut in_set, amplitude);
                values[second * cells + first] = amplitude;
            }
        }
    }
    let range = rounded(if in_set[0] <= in_set[1] { in_set } else { everywhere })?;
    let scale = ColourScale { name: format!("amplitude [{}]", unit.symbol), range };
    let set = Layer::new("", Colour::Scale, Mark::Raster { size: [cells; 2], values });
    Some(SetLayers { scale, set, frictionless: frictionless(machine, unit)? })
}

fn extend(range: &mut [f64; 2], value: f64) {
    *range = [range[0].min(value), range[1].max(value)];
}

/// Returns the range, extended to multiples of 1, 2 or 5 times a power of ten.
fn rounded([least, most]: [f64; 2]) -> Option<[f64; 2]> {
    let step = nice(((most - least) / STEPS).max(1e-9 * most));
    let ends = [(least / step).floor(), (most / step).floor() + 1.0];
    let count = ends[1] - ends[0];
    (count.is_finite() && (1.0..100.0).contains(&count))
        .then(|| ends.map(|end| (end * step * 1e9).round() / 1e9))
}

/// Returns the least of 1, 2 and 5 times a power of ten that is not below `step`, up to rounding.
fn nice(step: f64) -> f64 {
    let power = 10.0_f64.powf(step.log10().floor());
    let factor = [1.0, 2.0, 5.0].into_iter().find(|factor| factor * power >= 0.95 * step);
    factor.unwrap_or(10.0) * power
}

/// Returns the equilibria without friction; for identical balls also with the balls exchanged.
fn frictionless(machine: &Machine, unit: &Unit) -> Option<Vec<Layer>> {
    let found = frictionless_equilibria(machine, HIGH_DRAG)?;
    let identical = groups_of_identical(&machine.balls).len() == 1;
    let layer = |name: &str, symbol, stable: bool| {
        let of_kind = found.iter().filter(|state| (state.stability == Stability::Stable) == stable);
        let found = of_kind.flat_map(|state| {
            let beta = state.beta_rad.as_deref().unwrap_or_default();
            let here = <[f64; 2]>::try_from(beta).ok();
            let there = here.map(|[a, b]| [b, a]).filter(|there| identical && here != Some(*there));
            [here, there].into_iter().flatten().map(move |place| (state, place))
        });
        let (states, places): (Vec<&FrictionlessEquilibrium>, Vec<[f64; 2]>) = found.unzip();
        let words = states.iter().map(|state| state.kind.name().to_owned()).collect();
        let amplitudes = states.iter().map(|state| unit.of(state.amplitude_m())).collect();
        let column = |name: &str, values| TooltipColumn { name: name.to_owned(), values };
        let columns = vec![
            column("kind", TooltipValues::Words(words)),
            column(&format!("amplitude [{}]", unit.symbol), TooltipValues::Numbers(amplitudes)),
        ];
        let tooltips = Tooltips { run_ids: Vec::new(), columns };
        Layer::new(name, Colour::Series(1), Mark::dots(symbol, &places, tooltips))
    };
    Some(vec![
        layer("stable without friction", Symbol::Star, true),
        layer("unstable without friction", Symbol::Circle, false),
    ])
}
