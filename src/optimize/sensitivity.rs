//! The fraction of each response's variance over all designs that each variable explains: Sobol' indices by the pick-freeze
//! design.
//!
//! The design has two independent samples `A` and `B`, and for each variable `A` with that variable taken from `B`:
//! first-order indices by Saltelli et al. (Comput. Phys. Commun. 181 (2010) 259, table 2 (b),
//! doi:10.1016/j.cpc.2009.09.018), total ones by Jansen (Comput. Phys. Commun. 117 (1999) 35,
//! doi:10.1016/S0010-4655(98)00154-4). Intervals are percentiles of a bootstrap over the base samples
//! (G. E. B. Archer, A. Saltelli, I. M. Sobol', J. Stat. Comput. Simul. 58 (1997) 99,
//! doi:10.1080/00949659708811825).

use std::borrow::Cow;
use std::convert::Infallible;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::evaluations::Evaluation;
use super::process::Surrogate;
use super::search::Search;
use super::space::Space;
use super::suggest::{TrainingValues, training_values};
use crate::analysis::Estimate;
use crate::classification::Label;
use crate::responses::{Answer, DesignToEvaluate, respond_in_order};
use crate::study::{DesignValue, SensitivityFrom};

/// The indices of a variable for a response; one row of `sensitivities.parquet`.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct Sensitivity {
    /// The response's name.
    pub response: String,
    /// The variable's name.
    pub variable: String,
    /// Source of the responses.
    pub source: SensitivityFrom,
    /// Base samples.
    #[serde(skip)]
    pub samples: u64,
    /// The fraction of the variance that the variable alone explains, if it is known.
    pub first_order: Option<SobolIndex>,
    /// The fraction of the variance that remains if all other variables are known, if it is known.
    pub total: Option<SobolIndex>,
    /// Why indices or intervals are missing.
    pub reason: Option<String>,
}

/// Why a surrogate's indices have no intervals.
const SURROGATE: &str =
    "no interval: the surrogate's own error is not known; sensitivity: {from: runs} gives one";

/// Returns the indices of all variables for all responses of the goal, over all ranges and choices with equal
/// weights. Calls `finished` for each run, if runs are needed; returns `None` if the search was stopped.
pub fn sensitivities(
    search: &Search,
    surrogates: &[QuantitySurrogate],
    finished: &(dyn Fn(Label) + Sync),
) -> Option<Vec<Sensitivity>> {
    let Search { study, optimization, ref goal, workers, .. } = *search;
    let space = Space::new(study);
    let variables = study.variables();
    // The study file bounds both numbers.
    let count = |number: u64| u32::try_from(number).unwrap_or(u32::MAX);
    let seed = study.derived_seed("optimize sensitivities", 0);
    let samples = count(optimization.sensitivity_samples);
    let dimensions = count(variables.len() as u64);
    let designs: Vec<Vec<DesignValue>> = pick_freeze_sample(samples, dimensions, seed as u32)
        .iter()
        .map(|unit_coordinates| space.design_at(unit_coordinates))
        .collect();
    let by_quantity: Vec<Result<Vec<f64>, String>> = match optimization.sensitivity_from {
        SensitivityFrom::Surrogates => {
            let coordinates: Vec<Vec<f64>> =
                designs.iter().map(|design| space.coordinates(design)).collect();
            let predict = |(_, fitted): &QuantitySurrogate| {
                fitted.as_ref().map_err(String::clone)?.predict(&coordinates)
            };
            workers.install(|| surrogates.par_iter().map(predict).collect())
        }
        SensitivityFrom::Runs => from_runs(search, &designs, finished)?,
    };
    let (bootstrap_seed, no_interval) = match optimization.sensitivity_from {
        SensitivityFrom::Surrogates => (None, Some(SURROGATE.to_owned())),
        SensitivityFrom::Runs => (Some(seed), None),
    };
    let mut rows = Vec::new();
    for (quantity, values) in goal.quantities.iter().zip(by_quantity) {
        let indices =
            values.and_then(|values| sobol_indices(&values, variables.len(), bootstrap_seed));
        for (index, variable) in variables.iter().enumerate() {
            let of_variable = indices.as_ref().ok().and_then(|all| all.get(index));
            rows.push(Sensitivity {
                response: study.responses()[quantity.response].name.clone(),
                variable: variable.name().to_owned(),
                source: optimization.sensitivity_from,
                samples: optimization.sensitivity_samples,
                first_order: of_variable.map(|indices| indices.first_order),
                total: of_variable.map(|indices| indices.total),
                reason: indices.as_ref().err().cloned().or_else(|| no_interval.clone()),
            });
        }
    }
    Some(rows)
}

/// Index of the response of a quantity, and the surrogate of the quantity or the reason why there is none.
pub type QuantitySurrogate = (usize, Result<Surrogate, String>);

/// Returns a surrogate for each quantity of the goal; `None` if the search was stopped.
pub fn surrogates(search: &Search, evaluations: &[Evaluation]) -> Option<Vec<QuantitySurrogate>> {
    let Search { study, workers, stop, .. } = *search;
    let (space, goal) = (Space::new(study), search.goal.clone());
    let estimates: Vec<Vec<Estimate>> =
        evaluations.iter().map(|evaluation| goal.estimates(&evaluation.answers)).collect();
    let coordinates: Vec<Vec<f64>> =
        evaluations.iter().map(|evaluation| space.coordinates(&evaluation.values)).collect();
    let seed = study.derived_seed("optimize surrogates", 0);
    // A fit cannot be interrupted: the work has data of its own, and a stop abandons it.
    workers.unless_stopped(stop, move || {
        let fit = |(index, quantity): (usize, &super::goal::ResponseOverPoints)| {
            let fitted = training_values(&goal, index, &estimates)
                .ok_or_else(|| "no design has a value".to_owned())
                .and_then(|TrainingValues { values, noise }| {
                    Surrogate::fit(&coordinates, &values, noise, seed)
                });
            (quantity.response, fitted)
        };
        goal.quantities.par_iter().enumerate().map(fit).collect()
    })
}

fn from_runs(
    search: &Search,
    designs: &[Vec<DesignValue>],
    finished: &(dyn Fn(Label) + Sync),
) -> Option<Vec<Result<Vec<f64>, String>>> {
    let Search { study, ref goal, workers, stop, .. } = *search;
    // A design that is inconsistent has no values.
    let consistent = (0..).zip(designs).filter_map(|(number, values)| {
        let plans = vec![Cow::Owned(study.set(values).ok()?)];
        Some(Ok(DesignToEvaluate { number, values, plans }))
    });
    let mut values = vec![vec![None; designs.len()]; goal.quantities.len()];
    let add = |design: &DesignToEvaluate, answers: Vec<Answer>| {
        for (all, estimate) in values.iter_mut().zip(goal.estimates(&answers)) {
            all[design.number as usize] = estimate.value;
        }
        Ok::<(), Infallible>(())
    };
    let evaluated = respond_in_order(workers, study.responses(), consistent, stop, finished, add);
    if !evaluated.unwrap_or_else(|never| match never {}) {
        return None;
    }
    let complete = |all: Vec<Option<f64>>| {
        let missing = all.iter().filter(|value| value.is_none()).count();
        let known: Option<Vec<f64>> = all.iter().copied().collect();
        known.ok_or_else(|| format!("no value for {missing} of {} designs", all.len()))
    };
    Some(values.into_iter().map(complete).collect())
}

/// Bootstrap samples.
const RESAMPLES: usize = 1000;

/// An index of a variable, with its 95 % interval if the values come from runs.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Serialize)]
pub struct SobolIndex {
    /// The index.
    pub value: f64,
    /// Lower end of its interval.
    pub low: Option<f64>,
    /// Upper end of its interval.
    pub high: Option<f64>,
}

/// Indices of a variable.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Indices {
    /// The fraction of the variance that the variable alone explains.
    pub first_order: SobolIndex,
    /// The fraction of the variance that remains if all other variables are known.
    pub total: SobolIndex,
}

/// Returns the points of the pick-freeze design in the unit cube: `A`, `B`, then `A` with each variable from `B` in
/// turn, `samples` of each (at most 65,536, for at most 128 variables).
pub fn pick_freeze_sample(samples: u32, variables: u32, seed: u32) -> Vec<Vec<f64>> {
    let sample = |first: u32| {
        move |index: u32| -> Vec<f64> {
            let at = |dimension| f64::from(sobol_burley::sample(index, dimension, seed));
            (first..first + variables).map(at).collect()
        }
    };
    let a: Vec<Vec<f64>> = (0..samples).map(sample(0)).collect();
    let b: Vec<Vec<f64>> = (0..samples).map(sample(variables)).collect();
    let mut all = a.clone();
    all.extend(b.iter().cloned());
    for variable in 0..variables as usize {
        all.extend(a.iter().zip(&b).map(|(a, b)| {
            let mut mixed = a.clone();
            mixed[variable] = b[variable];
            mixed
        }));
    }
    all
}

/// Returns the indices of each variable from the values at the points of [`pick_freeze_sample`], in order; with
/// intervals if there is a seed for the bootstrap. For values of a surrogate the bootstrap would give the error of the
/// pick-freeze design alone, not the larger error of the surrogate.
///
/// # Errors
/// Returns an error if the number of values is wrong, or if all values are equal.
pub fn sobol_indices(
    values: &[f64],
    variables: usize,
    bootstrap_seed: Option<u64>,
) -> Result<Vec<Indices>, String> {
    let samples = values.len() / (variables + 2);
    if samples < 2 || values.len() != samples * (variables + 2) {
        return Err("the number of values is not that of the sample".to_owned());
    }
    let parts: Vec<&[f64]> = values.chunks_exact(samples).collect();
    let all: Vec<usize> = (0..samples).collect();
    let of = |variable: usize, chosen: &[usize]| indices(&parts, variable, chosen);
    if of(0, &all).is_none() {
        return Err("the same value for all designs".to_owned());
    }
    let resamples = bootstrap_seed.map(|seed| resamples(samples, seed));
    let estimate = |variable: usize| {
        let values = of(variable, &all).unwrap_or_default();
        let of_resamples: Option<Vec<[f64; 2]>> = resamples
            .as_ref()
            .map(|all| all.iter().filter_map(|chosen| of(variable, chosen)).collect());
        let interval = |which: usize| {
            let mut ascending: Vec<f64> =
                of_resamples.as_ref()?.iter().map(|both| both[which]).collect();
            ascending.sort_by(f64::total_cmp);
            let at = |fraction: f64| {
                let rank = (fraction * ascending.len().saturating_sub(1) as f64).round() as usize;
                ascending.get(rank).copied()
            };
            Some((at(0.025)?, at(0.975)?))
        };
        let [first_order, total] = [0, 1].map(|which| {
            let (low, high) = interval(which).unzip();
            SobolIndex { value: values[which], low, high }
        });
        Indices { first_order, total }
    };
    Ok((0..variables).map(estimate).collect())
}

/// Returns bootstrap resamples of the base samples.
fn resamples(samples: usize, seed: u64) -> Vec<Vec<usize>> {
    let mut generator = ChaCha8Rng::seed_from_u64(seed);
    let mut draw = |_| generator.random_range(0..samples);
    (0..RESAMPLES).map(|_| (0..samples).map(&mut draw).collect()).collect()
}

/// Returns first-order and total index of a variable from chosen base samples; `None` if the values do not vary.
fn indices(parts: &[&[f64]], variable: usize, chosen: &[usize]) -> Option<[f64; 2]> {
    let (a, b, mixed) = (parts.first()?, parts.get(1)?, parts.get(2 + variable)?);
    let count = chosen.len() as f64;
    let both = || chosen.iter().flat_map(|&index| [a[index], b[index]]);
    let mean = both().sum::<f64>() / (2.0 * count);
    let variance = both().map(|value| (value - mean).powi(2)).sum::<f64>() / (2.0 * count - 1.0);
    let first: f64 =
        chosen.iter().map(|&index| (b[index] - mean) * (mixed[index] - a[index])).sum();
    let total: f64 = chosen.iter().map(|&index| (a[index] - mixed[index]).powi(2)).sum();
    let varies = variance > 1e-24 * mean * mean && variance > 0.0;
    varies.then(|| [first / count / variance, total / (2.0 * count) / variance])
}
