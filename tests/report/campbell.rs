//! The Campbell diagram of a system with a part that turns.

use stickslip::report::chart::Mark;
use stickslip::report::{Budget, of_results};

use super::{figure_of, reported};
use crate::cli::support::Scratch;

/// A disc on a shaft without damping has the critical speed `sqrt(k / m)`. The study has three speeds, one of them negative; the
/// diagram is that of the fastest one, in the unit of the study.
#[test]
fn a_shaft_has_its_critical_speed_in_the_diagram() {
    let scratch = Scratch::with(
        "
schema: 1
name: a
seed: 1
units: {speed: rpm}
model:
  system:
    system: shaft
    parameters: {m: 2 kg, k: 20000 N/m, e: 0.1 mm, speed: 500 rpm}
    turning: {theta: speed}
    coordinates: {x: {unit: m, start: 1 mm}}
    mass: {x: {x: m}}
    force: {x: \"-k * x + m * e * theta'^2 * cos(theta)\"}
sweep: [{grid: {speed: [300 rpm, -2000 rpm, 600 rpm]}}]
initial_conditions: {design: {monte_carlo: {samples: 1}}}
simulation: {end_time_s: 0.2}
",
    );
    let (_, figures) = reported(&scratch, "a.yaml", Budget::SCREEN, of_results);
    let figure = figure_of(&figures, "campbell");
    assert!(figure.caption.ends_with("This is the diagram of speed −2000 rpm."), "{figure:?}");
    let [panel] = &figure.panels[..] else { panic!("one panel") };
    let critical_rpm = 100.0 * 30.0 / std::f64::consts::PI;
    for layer in &panel.layers {
        match (layer.name.as_str(), &layer.mark) {
            ("natural frequency 1", Mark::Line { points, .. }) => {
                let [last, frequency] = points[points.len() - 1];
                assert!((last - 2500.0).abs() < 1e-6, "{last}");
                assert!((frequency / critical_rpm - 1.0).abs() < 1e-8, "{frequency}");
            }
            ("speed", Mark::Line { dashed: true, .. }) => {}
            ("critical speed", Mark::Dots { x, y, .. }) => {
                assert_eq!((x.len(), x), (1, y));
                assert!((x[0] / critical_rpm - 1.0).abs() < 1e-8, "{x:?}");
            }
            other => panic!("{other:?}"),
        }
    }
    assert_eq!(panel.layers.len(), 3);
}
