//! Figures over swept parameters: cells of maps, and the points in detail.

use stickslip::report::chart::{AxisKind, Mark};
use stickslip::report::{Budget, ReportData, of_results};
use stickslip::study::ParameterValue;

use super::{figure_of, reported};
use crate::cli::support::{AT_ONCE, Scratch, study_text};

/// Computes one short run at each point of a grid, and passes the data of the report to `check`.
fn with_data(grid: &str, budget: Budget, check: impl FnOnce(&ReportData<'_>)) {
    let sweep = format!("sweep: [{{grid: {{{grid}}}}}]\n");
    let scratch = Scratch::with(study_text("a", "{monte_carlo: {samples: 1}}", AT_ONCE, &sweep));
    reported(&scratch, "a.yaml", budget, check);
}

/// Cells touch midway between the values on the scale of the axis.
#[test]
fn cells_of_a_map_touch() {
    let grid = "speed_rad_s: [-1.0, -2.0, -4.0], friction_coefficient: [1.0e-4, 1.0e-3, 1.0e-2]";
    with_data(grid, Budget::SCREEN, |data| {
        let figures = of_results(data);
        let map = figure_of(&figures, "map");
        assert_eq!(map.title, "Map over speed and friction coefficient");
        let panel = &map.panels[0];
        assert_eq!((&panel.x.kind, &panel.y.kind), (&AxisKind::Linear, &AxisKind::Logarithmic));
        let Mark::Cells { edges, .. } = &panel.layers[0].mark else { panic!() };
        assert_eq!(edges.len(), 9);
        let middle = 10.0_f64.sqrt();
        for (point, found) in data.points.iter().zip(edges) {
            let [speed, friction] = [0, 1].map(|place| match point.swept[place] {
                ParameterValue::Number(number) => number,
                ParameterValue::Text(text) => panic!("{text}"),
            });
            let [left, right] = match speed {
                -4.0 => [-5.0, -3.0],
                -2.0 => [-3.0, -1.5],
                _ => [-1.5, -0.5],
            };
            assert_eq!(found[..2], [left, right], "{speed}");
            for (found, expected) in found[2..].iter().zip([friction / middle, friction * middle]) {
                assert!((found / expected - 1.0).abs() < 1e-12, "{found} {expected}");
            }
        }
    });
}

/// Points in detail lie at even distances and include the first and the last point.
#[test]
fn points_in_detail_are_evenly_spaced() {
    let speeds: Vec<String> = (0..100).map(|number| format!("-{}.0", 100 + number)).collect();
    let grid = format!("speed_rad_s: [{}]", speeds.join(", "));
    with_data(&grid, Budget { details: 24, ..Budget::SCREEN }, |data| {
        let detailed = &data.detailed;
        assert_eq!((detailed.len(), detailed[0], detailed[23]), (24, 0, 99));
        assert!(detailed.windows(2).all(|pair| (4..=5).contains(&(pair[1] - pair[0]))));
    });
    // Up to 200 points are all in detail, also if the page shows fewer runs.
    let speeds: Vec<String> = (0..200).map(|number| format!("-{}.0", 100 + number)).collect();
    let grid = format!("speed_rad_s: [{}]", speeds.join(", "));
    let all: Vec<usize> = (0..200).collect();
    with_data(&grid, Budget::SCREEN.halved().halved(), |data| assert_eq!(data.detailed, all));
    with_data("speed_rad_s: [-1.0, -2.0, -3.0]", Budget::SCREEN, |data| {
        assert_eq!(data.detailed, [0, 1, 2]);
    });
}
