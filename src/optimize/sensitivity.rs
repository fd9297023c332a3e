//! The fraction of each response's variance over all designs that each variable explains.

use std::borrow::Cow;
use std::convert::Infallible;

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::evaluations::Evaluation;
use super::search::Search;
use super::sobol_indices::{SobolIndex, pick_freeze_sample, sobol_indices};
use super::space::Space;
use super::suggest::{TrainingValues, training_values};
use super::surrogate::Surrogate;
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
