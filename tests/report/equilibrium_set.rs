//! The equilibrium set behind the dots of the preferred equilibria.

use std::f64::consts::TAU;

use stickslip::analysis::{RestForm, set_fraction};
use stickslip::report::chart::{Layer, Mark, Panel, Symbol};
use stickslip::report::{Budget, of_results};
use stickslip::study::Study;

use super::reported;
use crate::cli::support::{AT_ONCE, Scratch, study_text};

/// Cells of the raster per axis.
const CELLS: usize = 192;

/// Computes a study of short runs; returns it with the panels of its preferred equilibria, one per point.
fn panels(rest: &str) -> (Study, Vec<Panel>) {
    let scratch = Scratch::with(study_text("a", "{monte_carlo: {samples: 1}}", AT_ONCE, rest));
    let (study, figures) = reported(&scratch, "a.yaml", Budget::SCREEN, of_results);
    let figure = figures.into_iter().find(|figure| figure.id == "preferred-equilibria");
    let panels = figure.map_or(Vec::new(), |figure| figure.panels);
    (study, panels)
}

fn sweep(values: &str) -> (Study, Vec<Panel>) {
    panels(&format!("sweep: [{{zip: {{{values}}}}}]\n"))
}

/// Returns the amplitudes of the raster, µm; NaN where the balls cannot rest.
fn raster(panel: &Panel) -> &[f64] {
    let Mark::Raster { size, values } = &panel.layers[0].mark else { panic!() };
    assert_eq!((*size, values.len()), ([CELLS; 2], CELLS * CELLS));
    values
}

fn fraction(panel: &Panel) -> f64 {
    let known = raster(panel).iter().filter(|value| value.is_finite()).count();
    known as f64 / (CELLS * CELLS) as f64
}

/// The fraction of coloured cells is the fraction of positions in the set.
#[test]
fn cells_outside_the_set_are_open() {
    let (study, panels) = sweep(
        "speed_rad_s: [-216.3772, -216.3772, -179.2671, -160.8103, -216.3772], \
         friction_coefficient: [2.75e-3, 2.75e-4, 2.75e-3, 2.75e-3, 3.5e-3]",
    );
    assert_eq!(panels.len(), 5);
    for (number, panel) in panels.iter().enumerate() {
        let point = study.point(number as u64);
        let expected = set_fraction(point.model().ball_balancer().unwrap()).unwrap();
        assert!((fraction(panel) - expected).abs() < 2e-3, "{number} {}", fraction(panel));
    }
    assert_eq!(fraction(&panels[4]), 1.0);
}

/// A cell has the amplitude with the first ball at its abscissa and the second one at its ordinate.
#[test]
fn the_first_ball_goes_to_the_right() {
    let (study, panels) =
        sweep("speed_rad_s: [-216.3772], friction_coefficient: [1.0], ball_mass_2_kg: [2.8e-4]");
    let point = study.point(0);
    let form = RestForm::new(point.model().ball_balancer().unwrap()).unwrap();
    for (column, row) in [(0, 0), (10, 100), (150, 20)] {
        let beta = [column, row].map(|k| TAU * (k as f64 + 0.5) / CELLS as f64);
        let amplitude = 1e6 * form.at_rest(&beta).amplitude_m;
        let found = raster(&panels[0])[row * CELLS + column];
        assert!((found / amplitude - 1.0).abs() < 1e-9, "{found} {amplitude}");
    }
}

/// Thesis section 5.2: amplitudes from 0 to 55.1 µm; B1 is stable, twice; A1+, A1- and A2 are not.
#[test]
fn the_thesis_figure() {
    let (_, panels) = sweep("speed_rad_s: [-216.3772], friction_coefficient: [2.75e-3]");
    let panel = &panels[0];
    assert_eq!(panel.scale.as_ref().unwrap().range, [0.0, 60.0]);
    let most = raster(panel).iter().copied().filter(|value| value.is_finite()).fold(0.0, f64::max);
    assert!((most - 55.1).abs() < 0.2, "{most}");
    let of = |wanted: Symbol| -> Vec<[f64; 2]> {
        let places = |layer: &Layer| match &layer.mark {
            Mark::Dots { symbol, x, y, .. } if *symbol == wanted => {
                x.iter().zip(y).map(|(x, y)| [*x, *y]).collect()
            }
            _ => Vec::new(),
        };
        panel.layers.iter().flat_map(places).collect()
    };
    let stable = of(Symbol::Star);
    assert_eq!(stable.len(), 2);
    for (place, [first, second]) in stable.iter().zip([[2.270, 4.013], [4.013, 2.270]]) {
        assert!((place[0] - first).abs() < 1e-3 && (place[1] - second).abs() < 1e-3);
    }
    assert_eq!(of(Symbol::Circle).len(), 4);
}

#[test]
fn only_two_balls_on_a_turning_disc_have_a_set() {
    let (_, panels) = sweep(
        "speed_rad_s: [0.0, -216.3772, -216.3772], friction_coefficient: [1.0e-3, 0.0, 1.0e-3], \
         damping_n_s_m: [1.28, 1.28, 0.0]",
    );
    assert!(panels[0].scale.is_none());
    // Without friction the set has no area, and the scale is that of all positions.
    assert!(fraction(&panels[1]) < 1e-3 && panels[1].scale.as_ref().unwrap().range[1] > 50.0);
    // Without damping the machine has a set as long as its speed is not the resonance.
    assert!(panels[2].scale.is_some());
    for balls in [1, 3] {
        let model = format!("model: {{kind: ball_balancer, parameters: {{balls: {balls}}}}}\n");
        assert!(self::panels(&model).1.iter().all(|panel| panel.scale.is_none()));
    }
}
