//! The equilibrium set of two balls as the background of a panel: amplitude by colour where the balls can rest, and
//! the equilibria without friction (thesis section 5.2, figures 5.3 to 5.5).

use std::f64::consts::TAU;

use crate::analysis::{
    FrictionlessEquilibrium, GridRow, HIGH_DRAG, RestForm, SetGrid, Stability,
    frictionless_equilibria, groups_of_identical,
};
use crate::model::Machine;
use crate::report::chart::{
    Axis, AxisKind, Colour, ColourScale, Layer, Mark, Symbol, TooltipColumn, TooltipValues,
    Tooltips,
};

/// Cells of the raster per axis: about half of a screen's pixels, in 100 kB of the page.
const CELLS: usize = 192;
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
    Axis {
        name: format!("angle of ball {ball}"),
        unit: "rad".to_owned(),
        range: Some([0.0, TAU]),
        kind: AxisKind::Angle,
    }
}

/// Returns the layers of a machine's equilibrium set; `None` unless the machine has two balls, turns, and has a
/// position of rest (a suspension without damping has none at its resonance).
pub fn set_layers(machine: &Machine) -> Option<SetLayers> {
    let form = RestForm::new(machine)?;
    if form.mass.len() != 2 || form.speed == 0.0 || !form.transfer.is_finite() {
        return None;
    }
    // Every second point of a grid with half the spacing is the centre of a cell.
    let grid = SetGrid::new(&form, 2 * CELLS)?;
    let mut values = vec![f64::NAN; CELLS * CELLS];
    let mut row = GridRow::default();
    let (mut in_set, mut everywhere) = ([f64::INFINITY, 0.0], [f64::INFINITY, 0.0]);
    // The first angle runs along the rows of the raster, the second one upwards.
    for first in 0..CELLS {
        grid.fill(2 * first + 1, &mut row);
        for second in 0..CELLS {
            let rest = grid.at(&row, 2 * second + 1);
            let amplitude = 1e6 * rest.amplitude_m;
            extend(&mut everywhere, amplitude);
            if rest.in_set() {
                extend(&mut in_set, amplitude);
                values[second * CELLS + first] = amplitude;
            }
        }
    }
    let range = rounded(if in_set[0] <= in_set[1] { in_set } else { everywhere })?;
    let scale = ColourScale { name: "amplitude [µm]".to_owned(), range };
    let set = Layer::new("", Colour::Scale, Mark::Raster { size: [CELLS; 2], values });
    Some(SetLayers { scale, set, frictionless: frictionless(machine)? })
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
fn frictionless(machine: &Machine) -> Option<Vec<Layer>> {
    let found = frictionless_equilibria(machine, HIGH_DRAG)?;
    let identical = groups_of_identical(&machine.balls).len() == 1;
    let layer = |name: &str, symbol, stable: bool| {
        let of_kind = found.iter().filter(|one| (one.stability == Stability::Stable) == stable);
        let places: Vec<(&FrictionlessEquilibrium, [f64; 2])> = of_kind
            .flat_map(|one| {
                let beta = one.beta_rad.as_deref().unwrap_or_default();
                let here = <[f64; 2]>::try_from(beta).ok();
                let there =
                    here.map(|[a, b]| [b, a]).filter(|there| identical && here != Some(*there));
                [here, there].into_iter().flatten().map(move |place| (one, place))
            })
            .collect();
        let words = places.iter().map(|(one, _)| one.kind.name().to_owned()).collect();
        let amplitudes = places.iter().map(|(one, _)| 1e6 * one.amplitude_m()).collect();
        let column = |name: &str, values| TooltipColumn { name: name.to_owned(), values };
        let columns = vec![
            column("kind", TooltipValues::Words(words)),
            column("amplitude [µm]", TooltipValues::Numbers(amplitudes)),
        ];
        let mark = Mark::Dots {
            symbol,
            x: places.iter().map(|(_, place)| place[0]).collect(),
            y: places.iter().map(|(_, place)| place[1]).collect(),
            tooltips: Tooltips { run_ids: Vec::new(), columns },
        };
        Layer::new(name, Colour::Series(1), mark)
    };
    Some(vec![
        layer("stable without friction", Symbol::Star, true),
        layer("unstable without friction", Symbol::Circle, false),
    ])
}

#[cfg(test)]
mod tests {
    use super::{CELLS, SetLayers, set_layers};
    use crate::analysis::set_fraction;
    use crate::model::{Ball, Machine};
    use crate::report::chart::{Layer, Mark};

    fn machine(speed_rad_s: f64, friction_coefficient: f64) -> Machine {
        let ball = Ball { friction_coefficient, ..Ball::default() };
        Machine { speed_rad_s, balls: vec![ball; 2], ..Machine::default() }
    }

    fn amplitudes(layers: &SetLayers) -> Vec<f64> {
        let Mark::Raster { size, values } = &layers.set.mark else { panic!() };
        assert_eq!((*size, values.len()), ([CELLS; 2], CELLS * CELLS));
        values.iter().copied().filter(|value| value.is_finite()).collect()
    }

    fn fraction(layers: &SetLayers) -> f64 {
        amplitudes(layers).len() as f64 / (CELLS * CELLS) as f64
    }

    fn places(layer: &Layer) -> Vec<[f64; 2]> {
        let Mark::Dots { x, y, .. } = &layer.mark else { panic!() };
        x.iter().zip(y).map(|(x, y)| [*x, *y]).collect()
    }

    /// The fraction of coloured cells is the fraction of positions in the set.
    #[test]
    fn cells_outside_the_set_are_open() {
        for (speed, friction) in
            [(-216.3772, 2.75e-3), (-216.3772, 2.75e-4), (-179.2671, 2.75e-3), (-160.8103, 2.75e-3)]
        {
            let machine = machine(speed, friction);
            let found = fraction(&set_layers(&machine).unwrap());
            assert!((found - set_fraction(&machine).unwrap()).abs() < 2e-3, "{speed} {found}");
        }
        assert_eq!(fraction(&set_layers(&machine(-216.3772, 3.5e-3)).unwrap()), 1.0);
    }

    /// A cell has the amplitude with the first ball at its abscissa and the second one at its ordinate.
    #[test]
    fn the_first_ball_goes_to_the_right() {
        let balls = [1.0, 2.0].map(|factor| {
            let ball = Ball::default();
            Ball { mass_kg: factor * ball.mass_kg, friction_coefficient: 1.0, ..ball }
        });
        let machine = Machine { balls: balls.to_vec(), ..machine(-216.3772, 1.0) };
        let layers = set_layers(&machine).unwrap();
        let Mark::Raster { values, .. } = &layers.set.mark else { panic!() };
        let form = crate::analysis::RestForm::new(&machine).unwrap();
        for (column, row) in [(0, 0), (10, 100), (150, 20)] {
            let beta =
                [column, row].map(|k| std::f64::consts::TAU * (k as f64 + 0.5) / CELLS as f64);
            let amplitude = 1e6 * form.at_rest(&beta).amplitude_m;
            let found = values[row * CELLS + column];
            assert!((found / amplitude - 1.0).abs() < 1e-9, "{found} {amplitude}");
        }
    }

    /// Thesis section 5.2: amplitudes from 0 to 55.1 µm; B1 is stable, twice; A1+, A1- and A2 are not.
    #[test]
    fn the_thesis_figure() {
        let layers = set_layers(&machine(-216.3772, 2.75e-3)).unwrap();
        assert_eq!(layers.scale.range, [0.0, 60.0]);
        let most = amplitudes(&layers).into_iter().fold(0.0, f64::max);
        assert!((most - 55.1).abs() < 0.2, "{most}");
        let stable = places(&layers.frictionless[0]);
        assert_eq!(stable.len(), 2);
        for (place, [first, second]) in stable.iter().zip([[2.270, 4.013], [4.013, 2.270]]) {
            assert!((place[0] - first).abs() < 1e-3 && (place[1] - second).abs() < 1e-3);
        }
        assert_eq!(places(&layers.frictionless[1]).len(), 4);
    }

    #[test]
    fn only_two_balls_on_a_turning_disc_have_a_picture() {
        assert!(set_layers(&machine(0.0, 1e-3)).is_none());
        for balls in [1, 3] {
            let balls = vec![Ball::default(); balls];
            assert!(set_layers(&Machine { balls, ..Machine::default() }).is_none());
        }
        // Without friction the set has no area, and the scale is that of all positions.
        let none = set_layers(&machine(-216.3772, 0.0)).unwrap();
        assert!(fraction(&none) < 1e-3 && none.scale.range[1] > 50.0);
        let undamped = Machine { damping_n_s_m: 0.0, ..machine(-216.3772, 1e-3) };
        assert!(set_layers(&undamped).is_some());
    }
}
