//! The study files of the project.

use stickslip::study::{ParameterValue, Study};

use crate::support::{shipped_study, study_files};

/// Those of docs/open-questions.md cover both normal forces.
#[test]
fn every_shipped_study_loads_and_resolves_to_itself() {
    for (folder, least) in [("studies", 5), ("studies/open-questions", 11)] {
        let mut count = 0;
        for path in study_files(folder) {
            let study = Study::load(&path).unwrap_or_else(|error| panic!("{error}"));
            assert_eq!(path.file_stem().and_then(|name| name.to_str()), Some(study.name()));
            let again = super::study(&study.resolved_yaml());
            assert_eq!(again.hash(), study.hash());
            assert!(study.planned_run(study.run_count() - 1).case.is_ok());
            let is_swept = study.swept().iter().any(|column| column.name == "normal_force");
            assert!(is_swept || folder == "studies", "{}", path.display());
            count += 1;
        }
        assert!(count >= least, "{count} studies in {folder}");
    }
}

#[test]
fn the_thesis_study_has_4096_runs_at_six_points() {
    let study = shipped_study("preferred-equilibria.yaml");
    assert_eq!((study.point_count(), study.run_count(), study.seed()), (6, 4096, 2003));
    let runs: Vec<u64> = (0..6).map(|point| study.point(point).sampling.most).collect();
    assert_eq!(runs, [768, 768, 768, 768, 768, 256]);
    let number = ParameterValue::Number;
    assert_eq!(study.point(4).swept, [number(-216.3772), number(2.75e-3)]);
    assert_eq!(study.point(5).swept, [number(-216.3772), number(2.75e-4)]);
    assert_eq!(*study.model(), stickslip::model::Machine::default().into());
    assert_eq!(*study.simulation(), stickslip::model::Simulation::default());
    for (point, expectation) in study.expectations().iter().enumerate() {
        let selected: Vec<u64> = (0..6)
            .filter(|id| expectation.selects(study.swept(), &study.point(*id).swept))
            .collect();
        assert_eq!(selected, [point as u64]);
    }
    // The 256 runs with less friction start like the first replicate of the others.
    for run in 0..256 {
        assert_eq!(study.planned_run(3840 + run).start, study.planned_run(run).start);
    }
}
