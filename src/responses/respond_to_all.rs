//! All designs of a table: their responses, and where labels change abruptly between them.

use std::path::Path;
use std::sync::atomic::AtomicBool;

use super::discontinuity::discontinuous;
use super::respond::{Answer, respond};
use crate::analysis::LabelCounts;
use crate::classification::Label;
use crate::engine::WorkerPool;
use crate::study::{DesignValue, Study};

/// Checks that a study has designs and asks for responses; `file` is what messages call it.
///
/// # Errors
/// What the study lacks, or has too much, with the remedy.
pub fn check_answerable(study: &Study, file: &Path) -> Result<(), String> {
    let file = file.display();
    if study.responses().is_empty() {
        let allowed =
            "`responses` in the study, such as vibration: {amplitude_mean: {relative: true}}";
        return Err(format!("{file}: nothing is asked for\n  allowed: {allowed}"));
    }
    if study.variables().is_empty() {
        let allowed = "`design` in the study, such as speed_rad_s: {from: -260, to: -180}";
        return Err(format!("{file}: nothing is varied\n  allowed: {allowed}"));
    }
    if study.precision().is_some() {
        let allowed = "a study without `precision`: designs share their runs, all of them";
        return Err(format!(
            "{file}: designs of different numbers of runs\n  found:   `precision`\n  allowed: {allowed}"
        ));
    }
    Ok(())
}

/// The runs of all these designs together.
///
/// # Errors
/// A design whose values make no physical sense together.
pub fn run_count(study: &Study, designs: &[Vec<DesignValue>]) -> Result<u64, String> {
    designs.iter().map(|values| Ok(study.set(values)?.run_count())).sum()
}

/// The answers for all designs, in order, compared with their neighbours; none where `stop` became true.
/// `finished` is told of each run.
///
/// # Errors
/// A design whose values make no physical sense together.
pub fn respond_to_all(
    workers: &WorkerPool,
    study: &Study,
    designs: &[Vec<DesignValue>],
    stop: &AtomicBool,
    finished: &(dyn Fn(Label) + Sync),
) -> Result<Option<Vec<Answer>>, String> {
    let mut answers: Vec<Answer> = Vec::new();
    for (number, values) in (0..).zip(designs) {
        let (set, design) = ([study.set(values)?], (number, values.as_slice()));
        let Some(own) = respond(workers, &set, study.responses(), design, stop, finished) else {
            return Ok(None);
        };
        answers.extend(own);
    }
    flag(study, designs, &mut answers);
    Ok(Some(answers))
}

/// Compares designs with their neighbours, point by point.
fn flag(study: &Study, designs: &[Vec<DesignValue>], answers: &mut [Answer]) {
    let scaled: Vec<Vec<f64>> = designs.iter().map(|values| study.scaled(values)).collect();
    for point_id in 0..study.point_count() {
        let at_point = |answer: &&mut Answer| answer.point_id == point_id;
        let counts: Vec<LabelCounts> =
            answers.iter_mut().filter(at_point).map(|answer| answer.counts).collect();
        let flags = discontinuous(&scaled, &counts);
        for (answer, flag) in answers.iter_mut().filter(at_point).zip(flags) {
            answer.discontinuous = flag;
        }
    }
}
