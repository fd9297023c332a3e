//! The search, one design after another.

use std::sync::atomic::{AtomicBool, Ordering};

use super::evaluation::{Evaluation, Origin};
use super::goal::Goal;
use super::space::Space;
use super::suggest::suggest;
use crate::classification::Label;
use crate::engine::WorkerPool;
use crate::responses::respond;
use crate::study::{DesignValue, Optimization, Study};

/// The number of repeated designs after which the search assumes that there are no others.
const MAX_SKIPPED: u32 = 10_000;

/// A search: the study, its goal and the workers.
pub struct Search<'a> {
    /// The study.
    pub study: &'a Study,
    /// The goal of the search.
    pub optimization: &'a Optimization,
    /// The workers that compute the runs.
    pub workers: &'a WorkerPool,
    /// Stops the search when it becomes true.
    pub stop: &'a AtomicBool,
}

/// How a search ended.
#[derive(Clone, Debug, Eq, PartialEq)]
pub enum SearchEnd {
    /// All requested designs have been evaluated.
    Finished,
    /// There are no designs that have not been evaluated.
    NoMoreDesigns,
    /// The search was stopped; complete evaluations are saved.
    Stopped,
    /// An objective has the same value, or none, for all designs of the start; holds the error message.
    Constant(String),
}

/// Continues a search until it ends; `evaluations` holds the earlier evaluations. Calls `observe` after each new
/// evaluation with all of them, and `finished` for each run.
///
/// # Errors
/// Returns the errors of `observe`.
pub fn search<E>(
    search: &Search,
    evaluations: &mut Vec<Evaluation>,
    finished: &(dyn Fn(Label) + Sync),
    mut observe: impl FnMut(&[Evaluation]) -> Result<(), E>,
) -> Result<SearchEnd, E> {
    let Search { study, optimization, workers, stop } = *search;
    let goal = Goal::new(study, optimization);
    while (evaluations.len() as u64) < optimization.designs {
        if evaluations.len() as u64 == optimization.start_designs
            && let Some(problem) = constant(study, &goal, evaluations)
        {
            return Ok(SearchEnd::Constant(problem));
        }
        if stop.load(Ordering::Relaxed) {
            return Ok(SearchEnd::Stopped);
        }
        let next = workers.install(|| next_design(study, optimization, &goal, evaluations));
        let Some(NextDesign { origin, values, study: set }) = next else {
            return Ok(SearchEnd::NoMoreDesigns);
        };
        let numbered = (evaluations.len() as u64, values.as_slice());
        let answers = respond(workers, &[set], study.responses(), numbered, stop, finished);
        let Some(answers) = answers else { return Ok(SearchEnd::Stopped) };
        evaluations.push(Evaluation { origin, values, answers });
        observe(evaluations)?;
    }
    Ok(SearchEnd::Finished)
}

/// The next design, and the study with its values.
struct NextDesign {
    origin: Origin,
    values: Vec<DesignValue>,
    study: Study,
}

/// Returns the design after these, a function of study and designs; `None` if there is no other. Skips designs with
/// inconsistent values.
fn next_design(
    study: &Study,
    optimization: &Optimization,
    goal: &Goal,
    evaluations: &[Evaluation],
) -> Option<NextDesign> {
    let space = Space::new(study);
    let number = evaluations.len() as u64;
    let if_new = |origin, values: Vec<DesignValue>| {
        if evaluations.iter().any(|one| one.values == values) {
            return None;
        }
        let study = study.set(&values).ok()?;
        Some(NextDesign { origin, values, study })
    };
    if let (0, Some(values)) = (number, &optimization.compare_with) {
        return if_new(Origin::CompareWith, values.clone());
    }
    let mut origin = Origin::SpaceFilling;
    if number >= optimization.start_designs {
        let seed = study.derived_seed("optimize suggest", number);
        let suggested = suggest(space, goal, evaluations, seed);
        if let Some(next) = suggested.and_then(|values| if_new(Origin::Surrogates, values)) {
            return Some(next);
        }
        origin = Origin::SpaceFillingInstead;
    }
    // A scramble that is independent of that of start states.
    let seed = study.derived_seed("optimize spread", 0) as u32;
    (0..MAX_SKIPPED).find_map(|index| if_new(origin, space.space_filling(index, seed)))
}

/// Returns an error message if an objective does not depend on the design.
fn constant(study: &Study, goal: &Goal, evaluations: &[Evaluation]) -> Option<String> {
    let all = goal.values_of_designs(evaluations);
    goal.objectives().iter().find_map(|(quantity, objective)| {
        let name = &study.responses().get(objective.response)?.name;
        let values: Vec<Option<f64>> =
            all.iter().map(|values| values.get(*quantity).copied().flatten()).collect();
        let known: Vec<f64> = values.iter().copied().flatten().collect();
        let count = all.len();
        match known.first() {
            None => {
                let first = evaluations.first().map(|one| goal.estimates(&one.answers));
                let reason = first.and_then(|estimates| estimates.get(*quantity)?.reason.clone());
                let failed = evaluations.iter().flat_map(|one| &one.answers);
                let failed: u64 = failed.map(|answer| answer.counts.of(Label::Failed)).sum();
                let reason = reason.unwrap_or_default();
                Some(format!(
                    "no value of `{name}` for any of the {count} designs so far ({reason}; {failed} runs \
                     failed)"
                ))
            }
            Some(first)
                if count > 1 && known.len() == count && known.iter().all(|one| one == first) =>
            {
                Some(format!("`{name}` is {first} for all of the {count} designs so far"))
            }
            _ => None,
        }
    })
}
