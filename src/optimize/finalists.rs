//! The finalists of a search: its best designs are evaluated again with other and more runs.
//!
//! The best estimate among many similar designs is partly due to chance. Therefore a few of the best
//! designs are evaluated with new runs, the best of these is chosen, and its reported responses come from further
//! runs that had no part in the choice. The reference design is computed with other runs than the best design,
//! so that both estimates are independent.

use std::borrow::Cow;

use super::evaluations::Evaluation;
use super::goal::{best, by_rank, pareto_front, values};
use super::search::Search;
use crate::analysis::{Estimate, Measure};
use crate::classification::Label;
use crate::named::named;
use crate::responses::{Answer, DesignToEvaluate, respond};
use crate::study::{AmplitudeKind, DesignValue, Response};

/// The role of a design in the finalists.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum FinalistRole {
    /// One of the best designs of the search, from which the best one is chosen.
    Finalist,
    /// The best design.
    Best,
    /// A design on the Pareto front of the search.
    Pareto,
    /// The design that the best one is compared with.
    CompareWith,
}

named!(FinalistRole {
    Finalist: "finalist",
    Best: "best",
    Pareto: "pareto",
    CompareWith: "compare_with",
});

/// A design with the responses of its final runs.
#[derive(Clone, Debug, PartialEq)]
pub struct Finalist {
    /// The role of the design.
    pub role: FinalistRole,
    /// Number of the design in the search; `None` if the search did not evaluate it.
    pub design: Option<u64>,
    /// One value per variable.
    pub values: Vec<DesignValue>,
    /// One answer per point of the sweep.
    pub answers: Vec<Answer>,
    /// One estimate per quantity of the goal.
    pub estimates: Vec<Estimate>,
    /// Mean of the amplitudes, each divided by that of the run's own machine without balls; one estimate per point of the sweep.
    pub relative_amplitudes: Vec<Estimate>,
    /// Whether the values of these runs meet all limits.
    pub met: bool,
    /// With two objectives: whether the design is on the front of the final runs, too.
    pub on_front: Option<bool>,
}

impl Finalist {
    /// Returns the number of runs at all points.
    pub fn runs(&self) -> u64 {
        self.answers.iter().map(|answer| answer.counts.total()).sum()
    }

    /// Returns the number of failed runs at all points.
    pub fn failed_runs(&self) -> u64 {
        self.answers.iter().map(|answer| answer.counts.of(Label::Failed)).sum()
    }
}

/// Returns the first design with this role.
pub fn of_role(finalists: &[Finalist], role: FinalistRole) -> Option<&Finalist> {
    finalists.iter().find(|finalist| finalist.role == role)
}

/// Evaluates the best designs again and calls `finished` for each run; returns them in the order of their evaluation, or
/// `None` if the search was stopped.
pub fn finalists(
    search: &Search,
    evaluations: &[Evaluation],
    finished: &(dyn Fn(Label) + Sync),
) -> Option<Vec<Finalist>> {
    let goal = &search.goal;
    let evaluate = |role, design, values: &[DesignValue]| {
        let mut answers = respond_with_own_runs(search, role, design, values, finished)?;
        let relative_amplitudes =
            answers.iter_mut().filter_map(|answer| answer.estimates.pop()).collect();
        let estimates = goal.estimates(&answers);
        let met = goal.is_met(&self::values(&estimates));
        let values = values.to_vec();
        Some(Finalist {
            role,
            design,
            values,
            answers,
            estimates,
            relative_amplitudes,
            met,
            on_front: None,
        })
    };
    let single = goal.objectives.len() == 1;
    let role = if single { FinalistRole::Finalist } else { FinalistRole::Pareto };
    let mut all: Vec<Finalist> = candidates(search, evaluations)
        .into_iter()
        .map(|index| evaluate(role, Some(index as u64), &evaluations.get(index)?.values))
        .collect::<Option<_>>()?;
    if single {
        let best = best(all.iter().map(|finalist| goal.rank(&values(&finalist.estimates))));
        if let Some(Finalist { design, values, .. }) = best.and_then(|index| all.get(index)) {
            let best = evaluate(FinalistRole::Best, *design, values)?;
            all.push(best);
        }
    } else {
        let costs = |finalist: &Finalist| goal.feasible_costs(&values(&finalist.estimates));
        let front = pareto_front(&all.iter().map(costs).collect::<Vec<_>>());
        for (index, finalist) in all.iter_mut().enumerate() {
            finalist.on_front = Some(front.contains(&index));
        }
    }
    if let Some(values) = &search.optimization.compare_with {
        let design = evaluations.iter().position(|evaluation| evaluation.values == *values);
        all.push(evaluate(FinalistRole::CompareWith, design.map(|index| index as u64), values)?);
    }
    Some(all)
}

/// Returns an upper bound of the number of runs of the finalists.
pub fn final_runs(search: &Search) -> u64 {
    let Search { study, optimization, .. } = *search;
    let designs = optimization.finalists + 2;
    let most = study.most_runs_of_a_design();
    designs.saturating_mul(samples(search)).saturating_mul(most)
}

/// Returns the number of samples of the study's size per design; one if another seed gives the same runs.
fn samples(search: &Search) -> u64 {
    if search.study.is_random() { search.optimization.final_samples } else { 1 }
}

/// Computes the responses of a design in runs that belong to its role alone, and as a last one the mean amplitude
/// divided by that without balls.
fn respond_with_own_runs(
    search: &Search,
    role: FinalistRole,
    design: Option<u64>,
    values: &[DesignValue],
    finished: &(dyn Fn(Label) + Sync),
) -> Option<Vec<Answer>> {
    let Search { study, workers, stop, .. } = *search;
    let purpose = match role {
        FinalistRole::Finalist | FinalistRole::Pareto => "optimize finalists",
        FinalistRole::Best => "optimize best",
        FinalistRole::CompareWith => "optimize compare_with",
    };
    let with = |number| {
        // The study has been read and the design set before, so both are valid with another seed, too.
        let other = study.with_seed(study.derived_seed(purpose, number)).ok()?;
        Some(Cow::Owned(other.set(values).ok()?))
    };
    let plans = (0..samples(search)).map(with).collect::<Option<_>>()?;
    let design = DesignToEvaluate { number: design.unwrap_or(0), values, plans };
    let name = String::new();
    let mut responses = study.responses().to_vec();
    let amplitude = AmplitudeKind::RelativeResidual;
    responses.push(Response { name, measure: Measure::Mean, amplitude, output: None });
    respond(workers, &responses, design, stop, finished)
}

/// Returns the designs of the finalists: the best by rank, or the Pareto front of those that meet the limits, thinned
/// out evenly along its first objective.
fn candidates(search: &Search, evaluations: &[Evaluation]) -> Vec<usize> {
    let goal = &search.goal;
    let all = goal.values_of_designs(evaluations);
    let most = search.optimization.finalists as usize;
    if goal.objectives.len() == 1 {
        let mut order: Vec<usize> = (0..all.len()).collect();
        let rank = |index: &usize| goal.rank(&all[*index]);
        order.sort_by(|left, right| by_rank(rank(left), rank(right)));
        order.truncate(most);
        return order;
    }
    let costs: Vec<Option<Vec<f64>>> =
        all.iter().map(|values| goal.feasible_costs(values)).collect();
    let mut front = pareto_front(&costs);
    let first = |index: &usize| costs[*index].as_ref().map_or(0.0, |costs| costs[0]);
    front.sort_by(|left, right| first(left).total_cmp(&first(right)));
    if front.len() <= most || most < 2 {
        front.truncate(most);
        return front;
    }
    (0..most).map(|place| front[place * (front.len() - 1) / (most - 1)]).collect()
}
