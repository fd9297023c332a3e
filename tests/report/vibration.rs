//! The first figure: residual vibration over the sweep, and without balls.

use stickslip::analysis::{Z_95, wilson};
use stickslip::report::chart::{Figure, Layer, Mark, Panel};
use stickslip::report::{Budget, of_results};

use super::{figure_of, reported};
use crate::cli::support::{Scratch, counts, numbers, study_text};

/// Returns the ordinates of the dots of the layers with this name.
fn ordinates(panel: &Panel, name: &str) -> Vec<f64> {
    let dots = |layer: &Layer| match &layer.mark {
        Mark::Dots { y, .. } if layer.name == name => y.clone(),
        _ => Vec::new(),
    };
    panel.layers.iter().flat_map(dots).collect()
}

fn close(found: &[f64], expected: &[f64]) {
    assert_eq!(found.len(), expected.len());
    for (found, expected) in found.iter().zip(expected) {
        assert!((found / expected - 1.0).abs() < 1e-12, "{found} {expected}");
    }
}

/// Each run is compared with its own machine without balls, by the figures and the table as by `check`, if the imbalance is
/// drawn far from its default.
#[test]
fn figures_compare_each_run_with_its_own_machine() {
    let drawn = "uncertain: {imbalance_mass: {uniform: {min: 0.5 g, max: 0.6 g}}}\n";
    let scratch = Scratch::with(study_text("a", "{monte_carlo: {samples: 40}}", 2.0, drawn));
    let (_, figures) = reported(&scratch, "a.yaml", Budget::SCREEN, of_results);
    let [points, runs] = ["points", "runs"].map(|name| scratch.table("out", name));
    let number = |name: &str| numbers(&points, name)[0].unwrap();

    let checked = scratch.json("check a.yaml --json");
    let checked = &checked["closed_form"]["points"][0]["amplitude_without_balls_m"];
    let without = number("amplitude_without_balls_m");
    assert!((without / checked.as_f64().unwrap() - 1.0).abs() < 0.05, "{without} and {checked}");

    let distribution = figure_of(&figures, "exceedance");
    let Mark::Steps { points: steps } = &distribution.panels[1].layers[1].mark else { panic!() };
    let mut relative: Vec<f64> =
        numbers(&runs, "relative_amplitude").into_iter().map(Option::unwrap).collect();
    relative.sort_by(f64::total_cmp);
    assert!(relative.iter().all(|part| (0.1..10.0).contains(part)), "{relative:?}");
    let abscissae: Vec<f64> = steps.iter().map(|[x, _]| *x).collect();
    assert_eq!(abscissae, relative);
    let worse = number("worse_than_without_balls_fraction");
    let words = format!("{:.1} % of the runs vibrate more than without balls", 100.0 * worse);
    let said = &distribution.alternative;
    assert!(said.contains(&words), "no {words} in {said}");
    let above = relative.iter().filter(|part| **part > 1.0).count();
    assert_eq!(above as f64 / relative.len() as f64, worse);
    assert!(distribution.caption.contains("the run's own machine without balls"));

    // A single point has no curves of one dot, but the probability of each amplitude with its band.
    assert!(figures.iter().all(|figure| !["vibration", "fractions"].contains(&figure.id.as_str())));
    let exceedance = &distribution.panels[0];
    let Mark::Band { x, low, high, .. } = &exceedance.layers[0].mark else { panic!() };
    let Mark::Steps { points: steps } = &exceedance.layers[1].mark else { panic!() };
    let amplitudes: Vec<f64> =
        numbers(&runs, "amplitude_m").into_iter().map(Option::unwrap).collect();
    assert_eq!(steps.len(), 40);
    for (step, [at, fraction]) in steps.iter().enumerate() {
        let above = amplitudes.iter().filter(|metres| 1e6 * **metres > *at).count() as u64;
        assert_eq!((*fraction, x[step]), (above as f64 / 40.0, *at));
        assert_eq!((low[step], high[step]), wilson(above, 40, Z_95));
    }
}

#[test]
fn the_first_figure_compares_with_no_balls() {
    // Ascending, as the figure orders them.
    let sweep = "sweep: [{grid: {speed_rad_s: [-247.0, -216.0, -160.0]}}]\n";
    let scratch = Scratch::with(study_text("a", "{monte_carlo: {samples: 12}}", 0.5, sweep));
    let (_, figures) = reported(&scratch, "a.yaml", Budget::SCREEN, of_results);
    let Figure { id, panels, alternative, .. } = &figures[0];
    assert_eq!(id, "vibration");
    let points = scratch.table("out", "points");
    let micro = |name: &str| -> Vec<f64> {
        numbers(&points, name).into_iter().map(|metres| 1e6 * metres.unwrap()).collect()
    };
    let without = micro("amplitude_without_balls_m");
    close(&ordinates(&panels[0], "median"), &micro("amplitude_p50_m"));
    close(&ordinates(&panels[0], "95 % quantile"), &micro("amplitude_p95_m"));
    close(&ordinates(&panels[0], "without balls"), &without);

    // Counted in the table of runs.
    let runs = scratch.table("out", "runs");
    let (of_point, amplitude) = (counts(&runs, "point_id"), numbers(&runs, "amplitude_m"));
    let worse: Vec<f64> = (0..3_u64)
        .map(|point| {
            let known = of_point.iter().zip(&amplitude).filter(|(of, _)| **of == point);
            let known: Vec<f64> = known.filter_map(|(_, amplitude)| *amplitude).collect();
            let limit = without[point as usize] * 1e-6;
            known.iter().filter(|metres| **metres > limit).count() as f64 / known.len() as f64
        })
        .collect();
    let found = ordinates(&panels[1], "runs that vibrate more than without balls");
    assert_eq!(found.len(), 3);
    for (found, worse) in found.iter().zip(&worse) {
        assert!((found - worse).abs() < 1e-12, "{found} {worse}");
        let words = format!("{:.1} % of the runs vibrate more than without balls", 100.0 * worse);
        assert!(alternative.contains(&words), "no {words} in {alternative}");
    }
}
