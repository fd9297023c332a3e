//! The thesis's figure 5.7: the rest positions of the balls of 768 runs.

use std::f64::consts::{PI, TAU};

use stickslip::report::chart::{Figure, Mark, Symbol};
use stickslip::report::{Budget, of_results};

use super::{figure_of, reported};
use crate::cli::support::Scratch;
use crate::support::angular_distance;

/// Returns the dots of the panel whose title begins with `title`.
fn dots(figure: &Figure, title: &str) -> Vec<[f64; 2]> {
    let panel = figure.panels.iter().find(|panel| panel.title.starts_with(title)).unwrap();
    let of_runs = panel.layers.iter().find_map(|layer| match &layer.mark {
        Mark::Dots { symbol: Symbol::Dot, x, y, tooltips } if !tooltips.run_ids.is_empty() => {
            Some((x, y))
        }
        _ => None,
    });
    let (x, y) = of_runs.unwrap();
    x.iter().zip(y).map(|(x, y)| [*x, *y]).collect()
}

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    angular_distance(a[0], b[0]).hypot(angular_distance(a[1], b[1]))
}

/// Dots are densest near the balancing positions (2.27, 4.01) and (4.01, 2.27), thesis section 5.3:
/// with both orders of the identical balls, the disc of radius 0.8 with the most dots contains one
/// of them. A second cluster, near (3.2, 5.7), is nearly as dense.
#[test]
fn dots_are_densest_at_the_balancing_positions() {
    let scratch = Scratch::new();
    let study = format!("{}/studies/preferred-equilibria.yaml", env!("CARGO_MANIFEST_DIR"));
    let (_, figures) = reported(&scratch, &study, Budget::SCREEN, of_results);
    let figure = figure_of(&figures, "preferred-equilibria");
    assert_eq!(figure.panels.len(), 6);
    let dots = dots(figure, "speed \u{2212}216.3772 rad/s, friction coefficient 0.00275:");
    assert!((400..470).contains(&dots.len()), "{}", dots.len());

    let both: Vec<[f64; 2]> = dots.iter().flat_map(|[a, b]| [[*a, *b], [*b, *a]]).collect();
    let near = |centre: [f64; 2]| both.iter().filter(|dot| distance(**dot, centre) < 0.8).count();
    let grid = (0..63 * 63).map(|k| [f64::from(k % 63) * 0.1, f64::from(k / 63) * 0.1]);
    let (fullest, most) = grid.map(|c| (c, near(c))).max_by_key(|(_, count)| *count).unwrap();
    let balanced = [[2.27, 4.01], [4.01, 2.27]];
    assert!(balanced.iter().any(|position| distance(*position, fullest) < 0.6), "{fullest:?}");
    // The expected number of dots in a disc for a uniform distribution over the 77 % of the square.
    let even = both.len() as f64 * PI * 0.64 / (0.77 * TAU * TAU);
    assert!(most as f64 > 2.0 * even, "{most} {even}");
    assert!(balanced.iter().all(|position| near(*position) as f64 > 2.0 * even));
}
