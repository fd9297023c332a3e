//! Computes the responses of all designs of a table, and flags abrupt changes of label fractions between them.

use std::borrow::Cow;
use std::path::Path;
use std::sync::atomic::AtomicBool;

use super::discontinuity::discontinuous;
use super::respond::{Answer, DesignToEvaluate, respond_in_order};
use crate::analysis::LabelCounts;
use crate::classification::Label;
use crate::engine::WorkerPool;
use crate::study::{DesignValue, Study};

/// Checks that a study has `design` and `responses`; `file` is its name in messages.
///
/// # Errors
/// Returns what the study lacks, or what it may not have.
pub fn check_answerable(study: &Study, file: &Path) -> Result<(), String> {
    let file = file.display();
    if study.responses().is_empty() {
        let allowed = "a response in the study, such as responses: {vibration: {amplitude_mean: {relative: true}}}";
        return Err(format!("{file}: `responses` is missing\n  allowed: {allowed}"));
    }
    if study.variables().is_empty() {
        let allowed =
            "a variable in the study, such as design: {speed_rad_s: {from: -260, to: -180}}";
        return Err(format!("{file}: `design` is missing\n  allowed: {allowed}"));
    }
    if study.precision().is_some() {
        let allowed = "a study without `precision`, so that all designs have the same runs";
        return Err(format!(
            "{file}: designs would have different numbers of runs\n  found:   `precision`\n  allowed: {allowed}"
        ));
    }
    Ok(())
}

/// Returns the number of runs of all these designs together.
///
/// # Errors
/// Returns the first design whose values are inconsistent.
pub fn run_count(study: &Study, designs: &[Vec<DesignValue>]) -> Result<u64, String> {
    designs.iter().map(|values| Ok(study.set(values)?.run_count())).sum()
}

/// Returns the answers for all designs, in order, compared with their neighbours; `None` if `stop` became true. Calls
/// `finished` for each run.
///
/// # Errors
/// Returns the first design whose values are inconsistent.
pub fn respond_to_all(
    workers: &WorkerPool,
    study: &Study,
    designs: &[Vec<DesignValue>],
    stop: &AtomicBool,
    finished: &(dyn Fn(Label) + Sync),
) -> Result<Option<Vec<Answer>>, String> {
    let mut answers: Vec<Answer> = Vec::new();
    let all = (0..).zip(designs).map(|(number, values)| {
        let plans = vec![Cow::Owned(study.set(values)?)];
        Ok::<_, String>(DesignToEvaluate { number, values, plans })
    });
    let complete = respond_in_order(workers, study.responses(), all, stop, finished, |_, more| {
        answers.extend(more);
        Ok(())
    })?;
    if !complete {
        return Ok(None);
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
