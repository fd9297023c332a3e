//! The thesis's counts, computed from the study files. Prints the table that it checks.

use std::sync::atomic::AtomicBool;

use crate::support::shipped_study;
use stickslip::analysis::PointDetail;
use stickslip::classification::{Label, simulate};
use stickslip::engine::{EngineOptions, Progress, Sink, run_study_with};
use stickslip::table::{PointRow, RunRecord};

/// A sink for the points only.
#[derive(Default)]
struct Points(Vec<PointRow>);

impl Sink for Points {
    type Error = std::convert::Infallible;

    fn run(&mut self, _: RunRecord) -> Result<(), Self::Error> {
        Ok(())
    }

    fn point(&mut self, point: PointRow, _: PointDetail) -> Result<(), Self::Error> {
        self.0.push(point);
        Ok(())
    }
}

fn points(study: &str) -> Vec<PointRow> {
    let study = shipped_study(study);
    let options = EngineOptions { threads: 2, chunk: 512, ..EngineOptions::default() };
    let progress = Progress::new(study.run_count(), true);
    let mut points = Points::default();
    run_study_with(
        &study,
        options,
        simulate,
        &AtomicBool::new(false),
        &progress,
        None,
        &mut points,
    )
    .expect("the study runs");
    for point in &points.0 {
        let counts = &point.summary.counts;
        println!(
            "{:?}: {} equilibria of {}",
            point.swept,
            counts.of(Label::Equilibrium),
            counts.total()
        );
    }
    points.0
}

fn equilibria(point: &PointRow) -> (u64, u64) {
    (point.summary.counts.of(Label::Equilibrium), point.summary.counts.total())
}

/// The counts of equilibria are near those of thesis figures 5.7-5.9: 768, 768, 768, 70 and 435 of
/// 768, 61 of 256. Ranges allow for the reconstructed box and for sampling.
#[test]
fn counts_of_preferred_equilibria() {
    let points = points("preferred-equilibria.yaml");
    let expected = [
        (768, 768..=768),
        (768, 768..=768),
        (768, 768..=768),
        (768, 65..=110),
        (768, 400..=470),
        (256, 55..=80),
    ];
    assert_eq!(points.len(), expected.len());
    for (point, (all, range)) in points.iter().zip(expected) {
        let (found, runs) = equilibria(point);
        assert_eq!(runs, all);
        assert!(range.contains(&found), "{:?}: {found}, expected {range:?}", point.swept);
    }
    // About half of the runs at -216.3772 rad/s are at rest by the time that the thesis states.
    let median = points[0].summary.time_to_rest_s[1].expect("reached");
    assert!((1.5..4.0).contains(&median), "{median} s");
}

/// The form of the normal force decides the count: 500 to 590 of 768 at -160.8103 rad/s with
/// Newton's, all with the thesis's.
#[test]
fn normal_force_decides_the_count() {
    let points = points("model-form.yaml");
    let found: Vec<(u64, u64)> = points.iter().map(equilibria).collect();
    assert_eq!(found[0], (768, 768));
    assert_eq!(found[1].1, 768);
    assert!((500..=590).contains(&found[1].0), "{found:?}");
}
