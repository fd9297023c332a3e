//! Balls with contact in the report: the band in which they would overlap, equilibria on its edges, and rests that touch.

use std::f64::consts::TAU;

use arrow::array::AsArray;
use stickslip::analysis::{residual_imbalance, touching_set_fraction};
use stickslip::model::wrap_to_pi;
use stickslip::report::chart::{Figure, Mark, Panel};
use stickslip::report::{Budget, of_results};
use stickslip::study::Study;

use super::reported;
use crate::cli::support::{
    AT_ONCE, Scratch, assert_has, column, counts, numbers, study_text, words,
};

const CONTACT: &str =
    "model: {kind: ball_balancer, contact: {}, parameters: {speed_rad_s: -173.1803}}\n";

/// Computes a study of a few runs into `out`, and returns it with the figure of its preferred equilibria.
fn figure(scratch: &Scratch, runs: u32, end_time_s: f64, rest: &str) -> (Study, Figure) {
    let design = format!("{{monte_carlo: {{samples: {runs}}}}}");
    scratch.write("a.yaml", study_text("a", &design, end_time_s, rest));
    let (study, figures) = reported(scratch, "a.yaml", Budget::SCREEN, of_results);
    let figure = figures.into_iter().find(|figure| figure.id == "preferred-equilibria").unwrap();
    (study, figure)
}

fn marks<'a>(panel: &'a Panel, name: &str) -> Vec<&'a Mark> {
    let layers = panel.layers.iter().filter(|layer| layer.name == name);
    layers.map(|layer| &layer.mark).collect()
}

/// Returns whether a position lies between the lines of a band.
fn is_in(mark: &Mark, [across, up]: [f64; 2]) -> bool {
    let Mark::Band { x, low, high, .. } = mark else { panic!("{mark:?}") };
    (1..x.len()).any(|end| {
        let begin = end - 1;
        let part = (across - x[begin]) / (x[end] - x[begin]);
        let at = |line: &[f64]| line[begin] + part * (line[end] - line[begin]);
        (0.0..=1.0).contains(&part) && (at(low)..at(high)).contains(&up)
    })
}

/// Each point has the band of its own diameters, with the equilibria of touching balls on its edges; cells of the set in
/// the band are open.
#[test]
fn the_band_of_each_point_is_where_its_balls_overlap() {
    let scratch = Scratch::new();
    let sweep = "sweep: [{grid: {ball_diameter_m: [3.0e-3, 1.2e-2]}}]\n";
    let (study, figure) = figure(&scratch, 1, AT_ONCE, &format!("{CONTACT}{sweep}"));
    assert_eq!(figure.panels.len(), 2);
    assert_has(&figure.caption, &["Shaded band", "Δ = 15.0° to 62.9° lies"]);
    for (number, panel) in figure.panels.iter().enumerate() {
        let point = study.point(number as u64);
        let machine = point.model().ball_balancer().unwrap();
        let contact = machine.contact_angle_rad(&machine.balls[0], &machine.balls[1]);
        let bands = marks(panel, "balls would overlap");
        assert_eq!(bands.len(), 3);
        let cells = 60;
        let centre = |cell: usize| (cell as f64 + 0.5) / cells as f64 * TAU;
        let Mark::Raster { size: [columns, _], values } = &panel.layers[0].mark else { panic!() };
        let mut overlapping = 0;
        for place in 0..cells * cells {
            let beta = [centre(place % cells), centre(place / cells)];
            let overlaps = wrap_to_pi(beta[1] - beta[0]).abs() < contact;
            let found = bands.iter().any(|band| is_in(band, beta));
            assert_eq!(found, overlaps, "{beta:?}, {contact} rad");
            overlapping += u32::from(overlaps);
            let [column, row] = beta.map(|angle| (angle / TAU * *columns as f64) as usize);
            let shown = values[row * columns + column].is_finite();
            // A cell on the edge of the band has its centre on either side.
            let deep = wrap_to_pi(beta[1] - beta[0]).abs() < contact - TAU / *columns as f64;
            assert!(!(deep && shown), "{beta:?}");
        }
        let share = f64::from(overlapping) / (cells * cells) as f64;
        assert!((share - contact / std::f64::consts::PI).abs() < 0.02, "{share} {contact}");

        let held = marks(panel, "equilibria of balls that touch");
        let [Mark::Line { points, .. }] = held[..] else { panic!("{held:?}") };
        let mut length = 0.0;
        for ends in points.chunks(3) {
            assert!(ends[2][0].is_nan());
            for beta in &ends[..2] {
                let apart = wrap_to_pi(beta[1] - beta[0]).abs();
                assert!((apart - contact).abs() < 1e-12, "{beta:?}");
            }
            length += ends[1][0] - ends[0][0];
        }
        let fraction = touching_set_fraction(machine).unwrap();
        assert!(fraction > 0.1 && fraction < 0.9, "{fraction}");
        // Each part may lose up to two positions of 720.
        let most = 2.0 * points.len() as f64 / 3.0 / 720.0;
        let found = length / (2.0 * TAU);
        assert!((found - fraction).abs() < most + 0.002, "{found} {fraction} {most}");
    }
}

/// Rests that touch are counted from all runs, in the table of points, in the title and in the text of the figure.
#[test]
fn rests_that_touch_are_counted() {
    let scratch = Scratch::new();
    let (_, figure) = figure(&scratch, 6, 4.0, CONTACT);
    let runs = scratch.table("out", "runs");
    let labels = words(&runs, "label");
    let touching = column(&runs, "touching_at_end").as_boolean();
    let rests: Vec<bool> = (0..labels.len())
        .filter(|run| labels[*run].as_deref() == Some("equilibrium"))
        .map(|run| touching.value(run))
        .collect();
    let touch = rests.iter().filter(|touches| **touches).count();
    assert!(touch > 0, "{rests:?}");
    assert!(counts(&runs, "impacts").iter().any(|impacts| *impacts > 0));
    let title = format!("{} of 6 at rest, {touch} touching", rests.len());
    assert_has(&figure.panels[0].title, &[title]);
    assert_has(&figure.alternative, &[format!(", {touch} of them with balls that touch")]);
    scratch.well("report out");
    let page = scratch.text("out-report.html");
    assert_has(&page, &["rests that touch", &format!(">{touch} of {}<", rests.len())]);
}

/// Three balls have no plane of angles: the panel shows the imbalance that remains.
#[test]
fn three_balls_show_what_remains_of_the_imbalance() {
    let model = "model: {kind: ball_balancer, parameters: {balls: 3, friction_coefficient: 1.0}}\n";
    let scratch = Scratch::new();
    let (study, figure) = figure(&scratch, 2, 2.0, model);
    assert_eq!(figure.panels.len(), 1);
    let panel = &figure.panels[0];
    assert_eq!((panel.x.unit.as_str(), panel.y.unit.as_str()), ("g mm", "g mm"));
    let [Mark::Dots { x, y, tooltips, .. }] = marks(panel, "equilibrium")[..] else {
        panic!("dots")
    };
    let runs = scratch.table("out", "runs");
    let angles = ["beta_1_rad", "beta_2_rad", "beta_3_rad"].map(|name| numbers(&runs, name));
    let case = study.planned_run(0).case.unwrap();
    let machine = case.model.ball_balancer().unwrap();
    for ((x, y), run) in x.iter().zip(y).zip(&tooltips.run_ids) {
        let beta = angles.each_ref().map(|angles| angles[*run as usize].unwrap());
        let expected = 1e6 * residual_imbalance(machine, &beta);
        assert!((x.hypot(*y) / expected - 1.0).abs() < 1e-9, "{x} {y} {expected}");
    }
    let [Mark::Line { points, .. }] = marks(panel, "as large as without balls")[..] else {
        panic!("a circle")
    };
    let without = 1e6 * machine.imbalance_mass_kg * machine.imbalance_radius_m;
    assert!(points.iter().all(|[x, y]| (x.hypot(*y) / without - 1.0).abs() < 1e-12));
}

/// A plain study has no figures of draws or of a run-up, and says nothing of touching.
#[test]
fn a_plain_study_has_nothing_of_contact_draws_or_stages() {
    let scratch = Scratch::new();
    let (_, figure) = figure(&scratch, 2, 0.1, "");
    let names = figure.panels[0].layers.iter().map(|layer| layer.name.as_str());
    let expected = ["", "equilibrium", "stable without friction", "unstable without friction"];
    assert_eq!(names.collect::<Vec<_>>(), expected);
    scratch.well("report out");
    let page = scratch.text("out-report.html");
    for word in [
        "rests that touch",
        "Shaded band",
        "of balls that touch",
        "\"rank-correlations\"",
        "\"drawn-parameters\"",
        "\"run-up\"",
    ] {
        assert!(!page.contains(word), "{word}");
    }
}
