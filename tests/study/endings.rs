//! `simulation.endings`: the endings that are detected.

use stickslip::model::Endings;

use super::{parse, study, text_with_design};

fn with_endings(written: &str, rest: &str) -> String {
    let text = text_with_design("{sobol: {samples: 4}}");
    format!("{text}simulation: {{{written}}}\n{rest}")
}

#[test]
fn all_endings_are_detected_by_default() {
    let default = study(&with_endings("end_time_s: 2.0", ""));
    let all = study(&with_endings("end_time_s: 2.0, endings: all", ""));
    let rest = study(&with_endings("end_time_s: 2.0, endings: rest", ""));
    assert_eq!(default.simulation().endings, Endings::All);
    assert_eq!(rest.simulation().endings, Endings::Rest);
    assert_eq!(default.hash(), all.hash());
    assert_ne!(default.hash(), rest.hash());
    assert_eq!(study(&rest.resolved_yaml()).simulation().endings, Endings::Rest);
    let error = parse(&with_endings("endings: none", "")).unwrap_err();
    assert_eq!((error.line(), error.key()), (Some(7), "simulation.endings"), "{error}");
}

#[test]
fn endings_that_are_not_detected_cannot_be_expected() {
    for label in ["limit_cycle", "periodic", "creep", "quasi_periodic", "irregular"] {
        let expect = format!("expect: [{{{label}_fraction: [0, 0.1]}}]\n");
        let error = parse(&with_endings("endings: rest", &expect)).unwrap_err();
        let key = format!("expect[0].{label}_fraction");
        assert_eq!((error.line(), error.key()), (Some(8), key.as_str()), "{error}");
        assert!(error.allowed().unwrap().contains("endings: all"), "{error}");
        study(&with_endings("endings: all", &expect));
    }
    study(&with_endings("endings: rest", "expect: [{equilibrium_fraction: [0, 1]}]\n"));
}
