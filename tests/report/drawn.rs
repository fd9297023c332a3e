//! Figures over the drawn values of uncertain parameters.

use stickslip::report::chart::{AxisKind, Figure, Mark};
use stickslip::report::{Budget, of_results};

use super::{figure_of, reported};
use crate::cli::support::{AT_ONCE, Scratch, counts, numbers, study_text};

/// Computes a study with these uncertain parameters at two points, and passes its figures to `check`.
fn with_figures(uncertain: &str, model: &str, check: impl FnOnce(&Scratch, &[Figure])) {
    let rest = format!(
        "{model}sweep: [{{grid: {{speed_rad_s: [-216.0, -160.0]}}}}]\nuncertain: {{{uncertain}}}\n"
    );
    let scratch = Scratch::with(study_text("a", "{monte_carlo: {samples: 40}}", AT_ONCE, &rest));
    reported(&scratch, "a.yaml", Budget::SCREEN, |data| check(&scratch, &of_results(data)));
}

/// Spearman's coefficient of distinct values, from the squared differences of their ranks.
fn spearman(x: &[f64], y: &[f64]) -> f64 {
    let rank = |values: &[f64], of: f64| values.iter().filter(|value| **value < of).count();
    let squares = x.iter().zip(y).map(|(a, b)| {
        let difference = rank(x, *a) as f64 - rank(y, *b) as f64;
        difference * difference
    });
    let count = x.len() as f64;
    1.0 - 6.0 * squares.sum::<f64>() / (count * (count * count - 1.0))
}

#[test]
fn bars_are_rank_correlations_of_the_runs() {
    let uncertain = "stiffness_n_m: {times: {uniform: {min: 0.9, max: 1.1}}}, \
                     imbalance_mass_kg: {uniform: {min: 5.0e-5, max: 6.0e-5}}";
    with_figures(uncertain, "", |scratch, figures| {
        let runs = scratch.table("out", "runs");
        let column = |name: &str, point: u64| -> Vec<f64> {
            let values = numbers(&runs, name);
            let of_point = counts(&runs, "point_id").into_iter().zip(values);
            of_point.filter(|(of, _)| *of == point).map(|(_, value)| value.unwrap()).collect()
        };
        let bars = figure_of(figures, "rank-correlations");
        let dots = figure_of(figures, "drawn-parameters");
        assert_eq!((bars.panels.len(), dots.panels.len()), (2, 4));
        for (point, panel) in (0..).zip(&bars.panels) {
            assert_eq!(
                panel.x.kind,
                AxisKind::Names(vec!["stiffness".to_owned(), "imbalance mass".to_owned()])
            );
            let Mark::Bars { y, .. } = &panel.layers[0].mark else { panic!() };
            let Mark::Intervals { low, high, .. } = &panel.layers[1].mark else { panic!() };
            let amplitude = column("amplitude_m", point);
            for (place, name) in ["stiffness_n_m", "imbalance_mass_kg"].into_iter().enumerate() {
                let expected = spearman(&column(name, point), &amplitude);
                assert!((y[place] - expected).abs() < 1e-4, "{name}: {} {expected}", y[place]);
                assert!(low[place] < y[place] && y[place] < high[place]);
            }
        }
        // Every run is a dot of each parameter, at its amplitude in micrometres.
        for (place, panel) in dots.panels.iter().enumerate() {
            let name = ["stiffness_n_m", "imbalance_mass_kg"][place % 2];
            let point = place as u64 / 2;
            let marks = panel.layers.iter().flat_map(|layer| match &layer.mark {
                Mark::Dots { x, y, .. } => x.iter().copied().zip(y.iter().copied()).collect(),
                _ => Vec::new(),
            });
            let mut found: Vec<(f64, f64)> = marks.collect();
            let amplitude = column("amplitude_m", point).into_iter().map(|metres| 1e6 * metres);
            let mut expected: Vec<(f64, f64)> =
                column(name, point).into_iter().zip(amplitude).collect();
            for pairs in [&mut found, &mut expected] {
                pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
            }
            assert_eq!(found, expected, "{name} at point {point}");
        }
    });
}

/// Of more than twelve parameters, the twelve with the strongest correlation are shown.
#[test]
fn figures_have_twelve_parameters_at_most() {
    let masses = (1..=7).map(|ball| format!("ball_mass_{ball}_kg: {{times: {FACTOR}}}"));
    let others = ["table_mass_kg", "stiffness_n_m", "damping_n_s_m", "ring_radius_m"];
    let others = others.into_iter().chain(["imbalance_mass_kg", "imbalance_radius_m"]);
    let others = others.map(|name| format!("{name}: {{times: {FACTOR}}}"));
    let uncertain: Vec<String> = masses.chain(others).collect();
    let model = "model: {kind: ball_balancer, parameters: {balls: 7}}\n";
    with_figures(&uncertain.join(", "), model, |scratch, figures| {
        let bars = figure_of(figures, "rank-correlations");
        let AxisKind::Names(names) = &bars.panels[0].x.kind else { panic!() };
        assert_eq!(names.len(), 12);
        assert!(bars.caption.contains("Of 13 parameters, the 12 with the strongest"));
        scratch.well("report out");
        assert!(scratch.text("out-report.html").contains("Other uncertain parameters"));
    });
}

const FACTOR: &str = "{uniform: {min: 0.9, max: 1.1}}";
