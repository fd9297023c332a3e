//! The search: space-filling designs, then batches of designs that surrogates propose.

use std::borrow::Cow;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

use super::evaluations::Evaluation;
use super::goal::Goal;
use super::next_designs::{Fits, NextDesign, batch, start_designs};
use crate::classification::Label;
use crate::engine::{CommandError, WorkerPool};
use crate::responses::{DesignToEvaluate, respond_in_order};
use crate::study::{Optimization, Study};

/// A search: the study, its goal and the workers.
pub struct Search<'a> {
    /// The study.
    pub study: &'a Study,
    /// Its objectives, limits and effort.
    pub optimization: &'a Optimization,
    /// Objectives and limits as numbers.
    pub goal: Goal,
    /// The workers that compute the runs.
    pub workers: &'a WorkerPool,
    /// Stops the search when it becomes true.
    pub stop: &'a AtomicBool,
}

/// How a search ended.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum SearchEnd {
    /// All requested designs have been evaluated.
    Finished,
    /// There are no designs that have not been evaluated.
    NoMoreDesigns,
}

impl SearchEnd {
    /// Returns the end in words.
    pub fn in_words(self) -> &'static str {
        match self {
            SearchEnd::Finished => "all requested designs have been evaluated",
            SearchEnd::NoMoreDesigns => "all possible designs have been evaluated",
        }
    }
}

/// Continues a search up to a number of designs; `evaluations` holds the earlier evaluations. Calls `observe` after each
/// new evaluation with all of them, and `finished` for each run. Returns `None` if the search was stopped; complete
/// evaluations are then saved.
///
/// # Errors
/// Returns the errors of `observe`, and an error, with the name `file` of the study, if an objective has the same value, or
/// none, for all designs of the start.
pub fn search(
    search: &Search,
    file: &Path,
    evaluations: &mut Vec<Evaluation>,
    until: u64,
    finished: &(dyn Fn(Label) + Sync),
    mut observe: impl FnMut(&[Evaluation]) -> Result<(), CommandError>,
) -> Result<Option<SearchEnd>, CommandError> {
    let Search { study, optimization, workers, stop, .. } = *search;
    let mut fits = Fits::default();
    while (evaluations.len() as u64) < until {
        if evaluations.len() as u64 == optimization.start_designs
            && let Some(problem) = constant(study, &search.goal, evaluations)
        {
            let file = file.display();
            let allowed =
                "an objective that has a value for these designs and depends on the design";
            return Err(CommandError::Usage(format!(
                "{file}: `optimize`: {problem}\n  allowed: {allowed}"
            )));
        }
        if stop.load(Ordering::Relaxed) {
            return Ok(None);
        }
        let Some(next) = next_designs(search, evaluations, until, &mut fits) else {
            return Ok(None);
        };
        if next.is_empty() {
            return Ok(Some(SearchEnd::NoMoreDesigns));
        }
        let first = evaluations.len() as u64;
        let designs = (first..).zip(&next).map(|(number, next)| {
            Ok(DesignToEvaluate {
                number,
                values: &next.values,
                plans: vec![Cow::Borrowed(&next.plan)],
            })
        });
        let mut origins = next.iter().map(|design| design.origin);
        let add = |design: &DesignToEvaluate, answers| {
            let Some(origin) = origins.next() else { return Ok(()) };
            evaluations.push(Evaluation { origin, values: design.values.to_vec(), answers });
            observe(evaluations)
        };
        let complete = respond_in_order(workers, study.responses(), designs, stop, finished, add)?;
        if !complete {
            return Ok(None);
        }
    }
    Ok(Some(SearchEnd::Finished))
}

/// Returns the designs to evaluate next, at most up to number `until`, and none if there are no others. Returns `None`
/// if the search was stopped.
fn next_designs(
    search: &Search,
    evaluations: &[Evaluation],
    until: u64,
    fits: &mut Fits,
) -> Option<Vec<NextDesign>> {
    let Search { study, optimization, workers, stop, .. } = *search;
    let start = optimization.start_designs.min(until);
    if (evaluations.len() as u64) < start {
        return Some(start_designs(study, optimization, evaluations, start));
    }
    // A fit cannot be interrupted: the work has data of its own, and a stop abandons it.
    let (study, optimization) = (study.clone(), optimization.clone());
    let (evaluations, mut own_fits) = (evaluations.to_vec(), fits.clone());
    let work = move || {
        let next = batch(&study, &optimization, &evaluations, until, &mut own_fits);
        (next, own_fits)
    };
    let (next, fitted) = workers.unless_stopped(stop, work)?;
    *fits = fitted;
    Some(next)
}

/// Returns an error message if an objective does not depend on the design.
fn constant(study: &Study, goal: &Goal, evaluations: &[Evaluation]) -> Option<String> {
    let all = goal.values_of_designs(evaluations);
    goal.objectives.iter().find_map(|(quantity, objective)| {
        let name = &study.responses()[objective.response].name;
        let known: Vec<f64> = all.iter().filter_map(|values| values[*quantity]).collect();
        let count = all.len();
        match known.first() {
            None => {
                let first = evaluations.first().map(|design| goal.estimates(&design.answers));
                let reason = first.and_then(|estimates| estimates.get(*quantity)?.reason.clone());
                let failed = evaluations.iter().flat_map(|design| &design.answers);
                let failed: u64 = failed.map(|answer| answer.counts.of(Label::Failed)).sum();
                let reason = reason.unwrap_or_default();
                Some(format!(
                    "no value of `{name}` for any of the {count} designs so far ({reason}; {failed} runs \
                     failed)"
                ))
            }
            Some(first)
                if count > 1 && known.len() == count && known.iter().all(|value| value == first) =>
            {
                Some(format!("`{name}` is {first} for all of the {count} designs so far"))
            }
            _ => None,
        }
    })
}
