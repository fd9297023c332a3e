//! The fraction of each response's variance over all designs that each variable explains.

use super::evaluation::Evaluation;
use super::goal::Goal;
use super::search::Search;
use super::sobol_indices::{Indices, pick_freeze_sample, sobol_indices};
use super::space::Space;
use super::suggest::training_values;
use super::surrogate::Surrogate;
use crate::classification::Label;
use crate::responses::{Estimate, respond};
use crate::study::{DesignValue, SensitivityFrom};

/// The indices of a variable for a response; one row of `sensitivities.parquet`.
#[derive(Clone, Debug, PartialEq)]
pub struct Sensitivity {
    /// The response's name.
    pub response: String,
    /// The variable's name.
    pub variable: String,
    /// Source of the responses.
    pub from: SensitivityFrom,
    /// Base samples.
    pub samples: u64,
    /// The indices, if they exist.
    pub indices: Option<Indices>,
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
    evaluations: &[Evaluation],
    finished: &(dyn Fn(Label) + Sync),
) -> Option<Vec<Sensitivity>> {
    let Search { study, optimization, workers, .. } = *search;
    let (space, goal) = (Space::new(study), Goal::new(study, optimization));
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
            let surrogates = workers.install(|| surrogates(search, evaluations));
            let coordinates: Vec<Vec<f64>> =
                designs.iter().map(|design| space.coordinates(design)).collect();
            surrogates
                .into_iter()
                .map(|(_, fitted)| fitted.and_then(|surrogate| surrogate.predict(&coordinates)))
                .collect()
        }
        SensitivityFrom::Runs => from_runs(search, &goal, &designs, finished)?,
    };
    let (bootstrap_seed, no_interval) = match optimization.sensitivity_from {
        SensitivityFrom::Surrogates => (None, Some(SURROGATE.to_owned())),
        SensitivityFrom::Runs => (Some(seed), None),
    };
    let mut rows = Vec::new();
    for (quantity, values) in goal.quantities().iter().zip(by_quantity) {
        let indices =
            values.and_then(|values| sobol_indices(&values, variables.len(), bootstrap_seed));
        for (index, variable) in variables.iter().enumerate() {
            let own = indices.as_ref().map(|all| all.get(index).copied());
            rows.push(Sensitivity {
                response: study
                    .responses()
                    .get(quantity.response)
                    .map_or_else(String::new, |response| response.name.clone()),
                variable: variable.name().to_owned(),
                from: optimization.sensitivity_from,
                samples: optimization.sensitivity_samples,
                indices: own.ok().flatten(),
                reason: own.err().cloned().or_else(|| no_interval.clone()),
            });
        }
    }
    Some(rows)
}

/// Returns a surrogate for each response of the goal, with the index of the response; or the reason why there is
/// none.
pub fn surrogates(
    search: &Search,
    evaluations: &[Evaluation],
) -> Vec<(usize, Result<Surrogate, String>)> {
    let Search { study, optimization, .. } = *search;
    let (space, goal) = (Space::new(study), Goal::new(study, optimization));
    let estimates: Vec<Vec<Estimate>> =
        evaluations.iter().map(|one| goal.estimates(&one.answers)).collect();
    let coordinates: Vec<Vec<f64>> =
        evaluations.iter().map(|one| space.coordinates(&one.values)).collect();
    let seed = study.derived_seed("optimize surrogates", 0);
    let fit = |(index, quantity): (usize, &super::goal::Quantity)| {
        let fitted = training_values(&goal, index, &estimates)
            .ok_or_else(|| "no design has a value".to_owned())
            .and_then(|training_values| {
                Surrogate::fit(&coordinates, &training_values.values, training_values.noise, seed)
            });
        (quantity.response, fitted)
    };
    goal.quantities().iter().enumerate().map(fit).collect()
}

fn from_runs(
    search: &Search,
    goal: &Goal,
    designs: &[Vec<DesignValue>],
    finished: &(dyn Fn(Label) + Sync),
) -> Option<Vec<Result<Vec<f64>, String>>> {
    let Search { study, workers, stop, .. } = *search;
    let mut values: Vec<Vec<Option<f64>>> = vec![Vec::new(); goal.quantities().len()];
    for (number, design) in (0..).zip(designs) {
        let own = match study.set(design) {
            Ok(set) => {
                let numbered = (number, design.as_slice());
                let answers =
                    respond(workers, &[set], study.responses(), numbered, stop, finished)?;
                goal.estimates(&answers)
            }
            Err(_) => vec![Estimate::default(); values.len()],
        };
        values.iter_mut().zip(own).for_each(|(all, one)| all.push(one.value));
    }
    let complete = |all: Vec<Option<f64>>| {
        let missing = all.iter().filter(|value| value.is_none()).count();
        let known: Option<Vec<f64>> = all.iter().copied().collect();
        known.ok_or_else(|| format!("no value for {missing} of {} designs", all.len()))
    };
    Some(values.into_iter().map(complete).collect())
}
