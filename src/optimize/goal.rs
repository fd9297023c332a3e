//! The goal of a search in numbers: costs over all points of a sweep, excesses over limits, and the Pareto front of costs.

use std::cmp::Ordering;

use super::evaluations::Evaluation;
use crate::analysis::Estimate;
use crate::responses::Answer;
use crate::study::{Limit, Objective, Optimization, OverPoints, Study};

/// The rank of a design: designs with a smaller first part are better, and among those the ones with a smaller number.
pub(super) type Rank = (u8, f64);

/// A response over all points of the sweep.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct ResponseOverPoints {
    /// Index among the study's responses.
    pub response: usize,
    /// Whether the worst of several points has the largest value; otherwise the smallest.
    pub larger_is_worse: bool,
}

/// Objectives and limits.
#[derive(Clone, Debug, PartialEq)]
pub struct Goal {
    /// The quantities, those of objectives first.
    pub quantities: Vec<ResponseOverPoints>,
    over_points: OverPoints,
    /// The objectives, each with the index of its quantity.
    pub objectives: Vec<(usize, Objective)>,
    /// The limits, each with the index of its quantity.
    pub limits: Vec<(usize, Limit)>,
}

impl Goal {
    /// Returns the goal of a study.
    pub fn new(study: &Study, optimization: &Optimization) -> Goal {
        // With one point, or with the mean over points, each response is one quantity.
        let single = study.point_count() == 1 || optimization.over_points == OverPoints::Mean;
        let mut quantities: Vec<ResponseOverPoints> = Vec::new();
        let mut quantity_index = |response, larger_is_worse| {
            let larger_is_worse = larger_is_worse || single;
            let quantity = ResponseOverPoints { response, larger_is_worse };
            quantities.iter().position(|other| *other == quantity).unwrap_or_else(|| {
                quantities.push(quantity);
                quantities.len() - 1
            })
        };
        let objectives = optimization.objectives.iter();
        let objectives = objectives
            .map(|objective| (quantity_index(objective.response, !objective.maximize), *objective))
            .collect();
        let limits = optimization.limits.iter();
        let limits =
            limits.map(|limit| (quantity_index(limit.response, !limit.least), *limit)).collect();
        Goal { quantities, over_points: optimization.over_points, objectives, limits }
    }

    /// Returns whether large values of a quantity, given by its index, are bad. Its first use decides.
    pub(super) fn large_is_bad(&self, quantity: usize) -> bool {
        let objective = self.objectives.iter().find(|(index, _)| *index == quantity);
        let limit = self.limits.iter().find(|(index, _)| *index == quantity);
        match (objective, limit) {
            (Some((_, objective)), _) => !objective.maximize,
            (None, Some((_, limit))) => !limit.least,
            (None, None) => true,
        }
    }

    /// Returns one estimate per quantity of a design with these answers.
    pub fn estimates(&self, answers: &[Answer]) -> Vec<Estimate> {
        let of = |quantity: &ResponseOverPoints| {
            let estimates =
                answers.iter().filter_map(|answer| answer.estimates.get(quantity.response));
            let estimates: Vec<&Estimate> = estimates.collect();
            over_points(&estimates, self.over_points, quantity.larger_is_worse)
        };
        self.quantities.iter().map(of).collect()
    }

    /// Returns one cost per objective, to be minimized; `None` if it is unknown.
    pub fn costs(&self, values: &[Option<f64>]) -> Vec<Option<f64>> {
        let cost = |(quantity, objective): &(usize, Objective)| {
            let value = (*values.get(*quantity)?)?;
            Some(if objective.maximize { -value } else { value })
        };
        self.objectives.iter().map(cost).collect()
    }

    /// Returns one excess per limit, positive if the limit is exceeded; `None` if it is unknown.
    pub fn excesses(&self, values: &[Option<f64>]) -> Vec<Option<f64>> {
        let excess = |(quantity, limit): &(usize, Limit)| {
            let value = (*values.get(*quantity)?)?;
            Some(if limit.least { limit.value - value } else { value - limit.value })
        };
        self.limits.iter().map(excess).collect()
    }

    /// Returns whether all limits are met; false if a value is unknown.
    pub fn is_met(&self, values: &[Option<f64>]) -> bool {
        self.excesses(values).iter().all(|excess| excess.is_some_and(|excess| excess <= 0.0))
    }

    /// Returns the costs of a design that meets all limits; `None` if it does not, or if a value is unknown.
    pub(super) fn feasible_costs(&self, values: &[Option<f64>]) -> Option<Vec<f64>> {
        if self.is_met(values) { self.costs(values).into_iter().collect() } else { None }
    }

    /// Returns the value of each quantity, by design.
    pub(super) fn values_of_designs(&self, evaluations: &[Evaluation]) -> Vec<Vec<Option<f64>>> {
        evaluations.iter().map(|evaluation| values(&self.estimates(&evaluation.answers))).collect()
    }

    /// Returns the rank of a design with one objective: first designs that meet all limits, by their cost; then the
    /// others, by their largest excess relative to the limit; then those with unknown values.
    pub fn rank(&self, values: &[Option<f64>]) -> Rank {
        let cost = self.costs(values).first().copied().flatten();
        let sizes = self.limits.iter().map(|(_, limit)| match limit.value.abs() {
            0.0 => 1.0,
            size => size,
        });
        let excesses: Option<Vec<f64>> = self.excesses(values).into_iter().collect();
        let Some((cost, excesses)) = cost.zip(excesses) else { return (2, 0.0) };
        let largest = excesses.iter().zip(sizes).map(|(excess, size)| excess / size);
        let largest = largest.fold(f64::NEG_INFINITY, f64::max);
        if largest <= 0.0 { (0, cost) } else { (1, largest) }
    }
}

/// Returns the index of the best rank, the first one among equals.
pub(super) fn best(ranks: impl Iterator<Item = Rank>) -> Option<usize> {
    ranks.enumerate().min_by(|left, right| by_rank(left.1, right.1)).map(|(index, _)| index)
}

pub(super) fn by_rank(left: Rank, right: Rank) -> Ordering {
    left.0.cmp(&right.0).then(left.1.total_cmp(&right.1))
}

/// Returns the values of estimates.
pub(super) fn values(estimates: &[Estimate]) -> Vec<Option<f64>> {
    estimates.iter().map(|estimate| estimate.value).collect()
}

/// Returns the indices of the designs on the Pareto front, in ascending order: the designs with known costs that no
/// other such design dominates. A design dominates another one if it is not worse in any objective, and better in at
/// least one. The first of several equal designs dominates the others.
pub fn pareto_front(costs: &[Option<Vec<f64>>]) -> Vec<usize> {
    let dominates = |(index, costs): (usize, &[f64]), (other, others): (usize, &[f64])| {
        let pairs = || costs.iter().zip(others);
        let better = pairs().any(|(cost, other)| cost < other);
        pairs().all(|(cost, other)| cost <= other) && (better || index < other)
    };
    let known: Vec<(usize, &[f64])> = costs
        .iter()
        .enumerate()
        .filter_map(|(design, costs)| Some((design, costs.as_deref()?)))
        .collect();
    let on_front = known.iter().filter(|(design, costs)| {
        !known.iter().any(|other| other.0 != *design && dominates(*other, (*design, costs)))
    });
    on_front.map(|(design, _)| *design).collect()
}

/// Returns the worst estimate or the mean; unknown if one of the estimates is.
///
/// The interval of the worst estimate is conservative. If large values are worse, its ends are the largest lower and
/// the largest upper end of all points. The true worst value exceeds the upper end only if it exceeds the upper end of
/// its own point, and lies below the lower end with a probability of at most the sum of the points' 2.5 %. Points share
/// start states and draws, so that their errors are correlated; the standard error of their mean is at most the mean
/// of their standard errors.
fn over_points(estimates: &[&Estimate], how: OverPoints, larger_is_worse: bool) -> Estimate {
    let known: Option<Vec<f64>> = estimates.iter().map(|estimate| estimate.value).collect();
    let first_reason = estimates.iter().find_map(|estimate| estimate.reason.clone());
    let Some(values) = known.filter(|values| !values.is_empty()) else {
        let unknown = estimates.iter().find(|estimate| estimate.value.is_none());
        let reason = unknown.and_then(|estimate| estimate.reason.clone()).or(first_reason);
        return Estimate { reason, ..Estimate::default() };
    };
    if let [only] = estimates {
        return (*only).clone();
    }
    let lows = || estimates.iter().map(|estimate| estimate.low);
    let highs = || estimates.iter().map(|estimate| estimate.high);
    let mean = |numbers: Vec<f64>| numbers.iter().sum::<f64>() / numbers.len() as f64;
    let all_known = |ends: Vec<Option<f64>>| ends.into_iter().collect::<Option<Vec<f64>>>();
    let (value, standard_error, low, high) = match how {
        OverPoints::Mean => (
            mean(values),
            all_known(estimates.iter().map(|estimate| estimate.standard_error).collect()).map(mean),
            all_known(lows().collect()).map(mean),
            all_known(highs().collect()).map(mean),
        ),
        OverPoints::Worst => {
            let worse =
                |left: f64, right: f64| if larger_is_worse { left > right } else { left < right };
            let worse_of = |a: usize, b: usize| if worse(values[b], values[a]) { b } else { a };
            let worst = (0..values.len()).fold(0, worse_of);
            let extreme = |ends: Vec<f64>| {
                ends.into_iter().reduce(if larger_is_worse { f64::max } else { f64::min })
            };
            // A missing end is infinite on its own side.
            let (low, high) = if larger_is_worse {
                (
                    extreme(lows().flatten().collect()),
                    all_known(highs().collect()).and_then(extreme),
                )
            } else {
                (
                    all_known(lows().collect()).and_then(extreme),
                    extreme(highs().flatten().collect()),
                )
            };
            (values[worst], estimates[worst].standard_error, low, high)
        }
    };
    Estimate { value: Some(value), standard_error, low, high, reason: first_reason }
}
