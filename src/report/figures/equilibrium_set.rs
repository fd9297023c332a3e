//! The equilibrium set of two balls as the background of a panel: amplitude by colour where the balls can
//! rest, and the equilibria without friction (thesis section 5.2, figures 5.3 to 5.5).

use std::f64::consts::TAU;

use crate::analysis::{
    FrictionlessEquilibrium, GridRow, HIGH_DRAG, RestForm, SetGrid, Stability,
    frictionless_equilibria, groups_of_alike,
};
use crate::model::Machine;
use crate::report::chart::{
    Axis, AxisKind, Colour, ColourScale, Layer, Mark, Symbol, TipColumn, TipValues, Tips,
};
use crate::report::contour::{Grid, lines, regions};

/// Cells of the grid per axis.
const CELLS: usize = 384;
/// At most about so many bands of amplitude.
const BANDS: f64 = 12.0;

/// What shows an equilibrium set over the angle of ball 1, to the right, and of ball 2, upwards.
#[derive(Clone, Debug, PartialEq)]
pub struct SetLayers {
    /// What the colours mean.
    pub scale: ColourScale,
    /// The set: bands of amplitude, contour lines, what is not in the set covered, its edge.
    pub set: Vec<Layer>,
    /// The equilibria without friction, for above all else.
    pub frictionless: Vec<Layer>,
}

/// The axis of a ball's angle.
pub fn angle_axis(ball: usize) -> Axis {
    Axis {
        name: format!("angle of ball {ball}"),
        unit: "rad".to_owned(),
        range: Some([0.0, TAU]),
        kind: AxisKind::Angle,
    }
}

/// The layers that show the equilibrium set of a machine; none unless it has two balls, turns, and has a
/// place to rest (a suspension without damping has none at its resonance).
pub fn set_layers(machine: &Machine) -> Option<SetLayers> {
    let form = RestForm::new(machine)?;
    let grid = SetGrid::new(&form, CELLS)?;
    if form.mass.len() != 2 || form.speed == 0.0 || !form.transfer.is_finite() {
        return None;
    }
    let [amplitude, margin] = values(&grid);
    let levels = levels(&amplitude, &margin)?;
    let over = |values: &[f64]| {
        // Rows of the table of values have ball 1 where it is, and ball 2 goes along them.
        let at = |column: usize, row: usize| values[(column % CELLS) * CELLS + row % CELLS];
        Grid::of([[0.0, TAU]; 2], [CELLS + 1; 2], at)
    };
    let [amplitude, margin] = [over(&amplitude), over(&margin)];
    let (rings, values) = regions(&amplitude, &levels);
    let bands = Mark::Regions { rings, values };
    let contours = levels.iter().flat_map(|level| lines(&amplitude, *level)).collect();
    let (outside, _) = regions(&margin, &[f64::NEG_INFINITY, 0.0]);
    let cover = Mark::Regions { values: vec![0.0; outside.len()], rings: outside };
    let edge = lines(&margin, 0.0);
    let layer = |name: &str, colour, mark| Layer { name: name.to_owned(), colour, mark };
    let line = |lines: Vec<Vec<[f64; 2]>>| Mark::Line { points: broken(lines), dashed: false };
    let scale = ColourScale {
        name: "amplitude [µm]".to_owned(),
        range: [levels[0], levels[levels.len() - 1]],
    };
    let set = vec![
        layer("", Colour::Scale, bands),
        layer("", Colour::Faint, line(contours)),
        layer("", Colour::Ground, cover),
        layer("edge of the equilibrium set", Colour::Ink, line(edge)),
    ];
    Some(SetLayers { scale, set, frictionless: frictionless(machine)? })
}

/// Amplitude in µm and friction margin at all points of the grid.
fn values(grid: &SetGrid) -> [Vec<f64>; 2] {
    let mut row = GridRow::default();
    let mut values = [Vec::new(), Vec::new()];
    for first in 0..CELLS {
        grid.fill(first, &mut row);
        for second in 0..CELLS {
            let rest = grid.at(&row, second);
            values[0].push(1e6 * rest.amplitude_m);
            values[1].push(rest.friction_margin());
        }
    }
    values
}

/// Levels at multiples of 1, 2 or 5 times a power of ten round the amplitudes in the set, or all where
/// it is empty.
fn levels(amplitude: &[f64], margin: &[f64]) -> Option<Vec<f64>> {
    let range = |inside: &dyn Fn(f64) -> bool| {
        let within = amplitude.iter().zip(margin).filter(|(_, margin)| inside(**margin));
        within.fold([f64::INFINITY, f64::NEG_INFINITY], |[least, most], (value, _)| {
            [least.min(*value), most.max(*value)]
        })
    };
    let of_set = range(&|margin| margin >= 0.0);
    let [least, most] = if of_set[0] <= of_set[1] { of_set } else { range(&|_| true) };
    let step = nice(((most - least) / BANDS).max(1e-9 * most));
    let [first, last] = [(least / step).floor(), (most / step).floor() + 1.0];
    let count = last - first;
    let levels = (0..=count as usize).map(|k| ((first + k as f64) * step * 1e9).round() / 1e9);
    (count.is_finite() && (1.0..100.0).contains(&count)).then(|| levels.collect())
}

/// The least number of 1, 2 and 5 times a power of ten that is not below, or hardly.
fn nice(step: f64) -> f64 {
    let power = 10.0_f64.powf(step.log10().floor());
    let factor = [1.0, 2.0, 5.0].into_iter().find(|factor| factor * power >= 0.95 * step);
    factor.unwrap_or(10.0) * power
}

/// Several lines as one, broken by points that are not numbers.
pub fn broken(lines: Vec<Vec<[f64; 2]>>) -> Vec<[f64; 2]> {
    lines.join(&[[f64::NAN; 2]][..])
}

/// The equilibria without friction; where balls are alike, with the balls exchanged as well.
fn frictionless(machine: &Machine) -> Option<Vec<Layer>> {
    let found = frictionless_equilibria(machine, HIGH_DRAG)?;
    let alike = groups_of_alike(&machine.balls).len() == 1;
    let layer = |name: &str, symbol, stable: bool| {
        let of_kind = found.iter().filter(|one| (one.stability == Stability::Stable) == stable);
        let places: Vec<(&FrictionlessEquilibrium, [f64; 2])> = of_kind
            .flat_map(|one| {
                let beta = one.beta_rad.as_deref().unwrap_or_default();
                let here = <[f64; 2]>::try_from(beta).ok();
                let there = here.map(|[a, b]| [b, a]).filter(|there| alike && here != Some(*there));
                [here, there].into_iter().flatten().map(move |place| (one, place))
            })
            .collect();
        let words = places.iter().map(|(one, _)| one.kind.name().to_owned()).collect();
        let amplitudes = places.iter().map(|(one, _)| 1e6 * one.amplitude_m()).collect();
        let column = |name: &str, values| TipColumn { name: name.to_owned(), values };
        let columns = vec![
            column("kind", TipValues::Words(words)),
            column("amplitude [µm]", TipValues::Numbers(amplitudes)),
        ];
        let mark = Mark::Dots {
            symbol,
            x: places.iter().map(|(_, place)| place[0]).collect(),
            y: places.iter().map(|(_, place)| place[1]).collect(),
            tips: Tips { run_ids: Vec::new(), columns },
        };
        Layer { name: name.to_owned(), colour: Colour::Series(1), mark }
    };
    Some(vec![
        layer("stable without friction", Symbol::Star, true),
        layer("unstable without friction", Symbol::Circle, false),
    ])
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::{SetLayers, set_layers};
    use crate::analysis::set_fraction;
    use crate::model::{Ball, Machine};
    use crate::report::chart::{Layer, Mark};
    use crate::report::contour::area;

    fn machine(speed_rad_s: f64, friction_coefficient: f64) -> Machine {
        let ball = Ball { friction_coefficient, ..Ball::default() };
        Machine { speed_rad_s, balls: vec![ball; 2], ..Machine::default() }
    }

    fn covered(layers: &SetLayers) -> f64 {
        let Mark::Regions { rings, .. } = &layers.set[2].mark else { panic!() };
        rings.iter().map(|ring| area(ring)).sum::<f64>() / (TAU * TAU)
    }

    fn places(layer: &Layer) -> Vec<[f64; 2]> {
        let Mark::Dots { x, y, .. } = &layer.mark else { panic!() };
        x.iter().zip(y).map(|(x, y)| [*x, *y]).collect()
    }

    /// The share that is not covered is the share of positions in the set.
    #[test]
    fn what_is_not_in_the_set_is_covered() {
        for (speed, friction) in
            [(-216.3772, 2.75e-3), (-216.3772, 2.75e-4), (-179.2671, 2.75e-3), (-160.8103, 2.75e-3)]
        {
            let machine = machine(speed, friction);
            let layers = set_layers(&machine).unwrap();
            let share = 1.0 - covered(&layers);
            assert!((share - set_fraction(&machine).unwrap()).abs() < 2e-3, "{speed} {share}");
        }
        assert_eq!(covered(&set_layers(&machine(-216.3772, 3.5e-3)).unwrap()), 0.0);
    }

    /// Thesis section 5.2: amplitudes from 0 to 55.1 µm; B1 is stable, twice; A1+, A1- and A2 are not.
    #[test]
    fn the_thesis_figure() {
        let layers = set_layers(&machine(-216.3772, 2.75e-3)).unwrap();
        assert_eq!(layers.scale.range, [0.0, 60.0]);
        let stable = places(&layers.frictionless[0]);
        assert_eq!(stable.len(), 2);
        for (place, [first, second]) in stable.iter().zip([[2.270, 4.013], [4.013, 2.270]]) {
            assert!((place[0] - first).abs() < 1e-3 && (place[1] - second).abs() < 1e-3);
        }
        assert_eq!(places(&layers.frictionless[1]).len(), 4);
        let Mark::Regions { rings, values } = &layers.set[0].mark else { panic!() };
        let whole: f64 = rings.iter().map(|ring| area(ring)).sum();
        assert!((whole / (TAU * TAU) - 1.0).abs() < 1e-3);
        assert!(values.iter().all(|value| (0.0..60.0).contains(value)));
    }

    #[test]
    fn only_two_balls_that_are_turned_have_a_picture() {
        assert!(set_layers(&machine(0.0, 1e-3)).is_none());
        for balls in [1, 3] {
            let balls = vec![Ball::default(); balls];
            assert!(set_layers(&Machine { balls, ..Machine::default() }).is_none());
        }
        // Without friction the set has no area: all is covered, and the amplitudes are all.
        let none = set_layers(&machine(-216.3772, 0.0)).unwrap();
        assert!(covered(&none) > 0.999);
        let undamped = Machine { damping_n_s_m: 0.0, ..machine(-216.3772, 1e-3) };
        assert!(set_layers(&undamped).is_some());
    }
}
