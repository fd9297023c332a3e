//! The search: one design after another.

use std::sync::atomic::{AtomicBool, Ordering};

use super::evaluation::{Evaluation, Origin};
use super::goal::Goal;
use super::space::Space;
use super::suggest::{all_values, suggest};
use crate::classification::Label;
use crate::engine::WorkerPool;
use crate::responses::respond;
use crate::study::{DesignValue, Optimization, Study};

/// How many designs are passed over, as they have been looked at, before there are taken to be no more.
const MOST_PASSED_OVER: u32 = 10_000;

/// A search: what is looked for, and with what.
pub struct Search<'a> {
    /// The study.
    pub study: &'a Study,
    /// What it looks for.
    pub optimization: &'a Optimization,
    /// Who computes the runs.
    pub workers: &'a WorkerPool,
    /// Becomes true where it is to stop.
    pub stop: &'a AtomicBool,
}

/// How a search ended.
#[derive(Clone, Debug, Eq, PartialEq)]
pub enum SearchEnd {
    /// All designs that were asked for have been looked at.
    Finished,
    /// There are no more designs than those that have been looked at.
    NoMoreDesigns,
    /// It was stopped; what is complete is kept.
    Stopped,
    /// An objective is the same for all designs of the start, or unknown for all: what is wrong.
    Constant(String),
}

/// Goes on with a search until it ends; `evaluations` are those before. Each new one is told to `observe`,
/// as the last of all; `finished` is told of each run.
///
/// # Errors
/// Those of `observe`.
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
        let Some(Next { origin, values, set }) = next else { return Ok(SearchEnd::NoMoreDesigns) };
        let asked = (evaluations.len() as u64, values.as_slice());
        let answers = respond(workers, &[set], study.responses(), asked, stop, finished);
        let Some(answers) = answers else { return Ok(SearchEnd::Stopped) };
        evaluations.push(Evaluation { origin, values, answers });
        observe(evaluations)?;
    }
    Ok(SearchEnd::Finished)
}

/// The design that comes next, and the study with it set.
struct Next {
    origin: Origin,
    values: Vec<DesignValue>,
    set: Study,
}

/// The design that comes after these, a function of study and designs; none where there is no other.
/// Values that make no sense together are no design.
fn next_design(
    study: &Study,
    optimization: &Optimization,
    goal: &Goal,
    evaluations: &[Evaluation],
) -> Option<Next> {
    let space = Space::new(study);
    let number = evaluations.len() as u64;
    let new = |origin, values: Vec<DesignValue>| {
        if evaluations.iter().any(|one| one.values == values) {
            return None;
        }
        let set = study.set(&values).ok()?;
        Some(Next { origin, values, set })
    };
    if let (0, Some(values)) = (number, &optimization.compare_with) {
        return new(Origin::CompareWith, values.clone());
    }
    let mut origin = Origin::OrderStatistics;
    if number >= optimization.start_designs {
        let seed = study.derived_seed("optimize suggest", number);
        let suggested = suggest(space, goal, evaluations, seed);
        if let Some(next) = suggested.and_then(|values| new(Origin::Surrogates, values)) {
            return Some(next);
        }
        origin = Origin::Instead;
    }
    // A scramble of its own, apart from that of start states.
    let seed = study.derived_seed("optimize spread", 0) as u32;
    (0..MOST_PASSED_OVER).find_map(|index| new(origin, space.spread(index, seed)))
}

/// What is wrong where an objective does not depend on the design.
fn constant(study: &Study, goal: &Goal, evaluations: &[Evaluation]) -> Option<String> {
    let all = all_values(goal, evaluations);
    goal.objectives().iter().find_map(|(place, objective)| {
        let name = &study.responses().get(objective.response)?.name;
        let values: Vec<Option<f64>> =
            all.iter().map(|own| own.get(*place).copied().flatten()).collect();
        let known: Vec<f64> = values.iter().copied().flatten().collect();
        let count = all.len();
        match known.first() {
            None => {
                let first = evaluations.first().map(|one| goal.estimates(&one.answers));
                let reason = first.and_then(|own| own.get(*place)?.reason.clone());
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
