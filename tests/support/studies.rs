//! Studies that a test writes down, and the cases of their runs.

use stickslip::model::Case;
use stickslip::study::Study;

use super::shipped;

/// Parses a study as if it stood beside those of the project, whose systems it may name.
#[track_caller]
pub fn parse(text: impl Into<String>) -> Study {
    let text = text.into();
    let study = Study::parse(&shipped("a.yaml"), text.clone());
    study.unwrap_or_else(|error| panic!("{error}\n{text}"))
}

/// Returns the case of each run of a study.
pub fn cases_of(study: &Study) -> Vec<Case> {
    (0..study.run_count()).map(|run| study.planned_run(run).case.expect("a valid case")).collect()
}
