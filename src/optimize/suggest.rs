//! Proposes the next designs from Gaussian processes of all objectives and limits.

use ndarray::{Array2, Axis};
use rayon::prelude::*;

use super::criterion::{Criterion, Prediction};
use super::evaluations::Evaluation;
use super::goal::{Goal, by_rank};
use super::process::{Hyperparameters, Interpolation, QuantityScale, ScaledQuantity, table};
use super::proposal::{DesignValues, by_criterion};
use super::space::Space;
use crate::analysis::Estimate;

/// Number of designs whose criterion is computed at a time.
const AT_A_TIME: usize = 64;
/// Number of the best designs so far near which the search for a proposal looks, too.
const NEAR: usize = 4;

/// One quantity of all designs of a search.
pub(super) struct TrainingValues {
    /// Values; unknown ones are replaced by the worst known value.
    pub values: Vec<f64>,
    /// Typical variance of a value.
    pub noise: f64,
}

/// Returns the values of a quantity, given by its index; `None` if no design has a value of it.
pub(super) fn training_values(
    goal: &Goal,
    quantity: usize,
    estimates: &[Vec<Estimate>],
) -> Option<TrainingValues> {
    let of = |design: &Vec<Estimate>| design.get(quantity).and_then(|estimate| estimate.value);
    let worst = if goal.large_is_bad(quantity) { f64::max } else { f64::min };
    let substitute = estimates.iter().filter_map(of).reduce(worst)?;
    let errors = estimates.iter().filter_map(|design| design.get(quantity)?.standard_error);
    Some(TrainingValues {
        values: estimates.iter().map(|design| of(design).unwrap_or(substitute)).collect(),
        noise: median(errors.filter(|error| error.is_finite()).collect()).powi(2),
    })
}

fn median(mut numbers: Vec<f64>) -> f64 {
    numbers.sort_by(f64::total_cmp);
    numbers.get(numbers.len() / 2).copied().unwrap_or(0.0)
}

/// The designs of a search and their quantities, as processes model them.
pub(super) struct TrainingData {
    /// One row per design.
    coordinates: Array2<f64>,
    quantities: Vec<ScaledQuantity>,
}

impl TrainingData {
    /// Returns the data of these designs; `None` if no design has a value of a quantity.
    pub fn new(space: &Space, goal: &Goal, evaluations: &[Evaluation]) -> Option<TrainingData> {
        let estimates: Vec<Vec<Estimate>> =
            evaluations.iter().map(|evaluation| goal.estimates(&evaluation.answers)).collect();
        let quantity = |index: usize| {
            let TrainingValues { values, .. } = training_values(goal, index, &estimates)?;
            let scale = QuantityScale::new(goal, index, &values);
            let errors = estimates.iter().filter_map(|design| {
                let Estimate { value, standard_error, .. } = design.get(index)?;
                Some(scale.scaled_error((*value)?, (*standard_error)?))
            });
            let error = median(errors.filter(|error| error.is_finite()).collect());
            let values = values.into_iter().map(|value| scale.scaled(value)).collect();
            Some(ScaledQuantity { scale, values, noise: error * error })
        };
        let quantities: Option<Vec<_>> = (0..goal.quantities.len()).map(quantity).collect();
        let rows: Vec<Vec<f64>> =
            evaluations.iter().map(|evaluation| space.coordinates(&evaluation.values)).collect();
        Some(TrainingData { coordinates: table(&rows).ok()?, quantities: quantities? })
    }

    /// Fits the hyperparameters of all quantities, starting from those of a fit to fewer designs; `None` if the library
    /// cannot fit them.
    pub fn fit(&self, before: Option<&[Hyperparameters]>) -> Option<Vec<Hyperparameters>> {
        let fit = |(index, ScaledQuantity { values, noise, .. }): (usize, &ScaledQuantity)| {
            let before = before.and_then(|all| all.get(index));
            Hyperparameters::fit(&self.coordinates, values, *noise, before)
        };
        self.quantities.par_iter().enumerate().map(fit).collect()
    }

    fn interpolations(&self, hyperparameters: &[Hyperparameters]) -> Option<Vec<Interpolation>> {
        let process = |(quantity, parameters): (&ScaledQuantity, &Hyperparameters)| {
            Interpolation::new(&self.coordinates, &quantity.values, parameters)
        };
        self.quantities.par_iter().zip(hyperparameters).map(process).collect()
    }
}

/// Processes of all quantities, without noise, to which predictions can be added as if they were evaluated.
pub(super) struct Proposer<'a> {
    space: &'a Space<'a>,
    goal: &'a Goal,
    hyperparameters: &'a [Hyperparameters],
    /// Proposals are not as near as this to other designs, as a fraction of the range of each number.
    least_distance: f64,
    designs: Vec<DesignValues>,
    /// The designs with values without noise.
    data: TrainingData,
    processes: Vec<Interpolation>,
}

impl<'a> Proposer<'a> {
    /// Returns the processes after these designs.
    ///
    /// Values are smoothed first: the processes interpolate the predictions of processes that model the noise
    /// (re-interpolation; A. I. J. Forrester, A. J. Keane, N. W. Bressloff, AIAA J. 44 (2006) 2331,
    /// doi:10.2514/1.20068).
    pub fn new(
        space: &'a Space<'a>,
        goal: &'a Goal,
        hyperparameters: &'a [Hyperparameters],
        mut data: TrainingData,
        designs: Vec<DesignValues>,
        least_distance: f64,
    ) -> Option<Proposer<'a>> {
        for (quantity, parameters) in data.quantities.iter_mut().zip(hyperparameters) {
            let smoothed = parameters.smooth(&data.coordinates, &quantity.values);
            quantity.values = smoothed.unwrap_or_else(|| quantity.values.clone());
        }
        let processes = data.interpolations(hyperparameters)?;
        Some(Proposer { space, goal, hyperparameters, least_distance, designs, data, processes })
    }

    /// Adds a design with its predictions as values, so that a proposal lies elsewhere (kriging believer; D. Ginsbourger,
    /// R. Le Riche, L. Carraro, 2010, doi:10.1007/978-3-642-10701-6_6).
    pub fn believe(&mut self, design: &DesignValues) -> Option<()> {
        let row = table(&[self.space.coordinates(design)]).ok()?;
        for (quantity, process) in self.data.quantities.iter_mut().zip(&self.processes) {
            let [(mean, _)] = process.predict(&row.view())?[..] else { return None };
            quantity.values.push(mean);
        }
        self.data.coordinates.append(Axis(0), row.view()).ok()?;
        self.designs.push(design.clone());
        self.processes = self.data.interpolations(self.hyperparameters)?;
        Some(())
    }

    /// Returns designs by decreasing criterion.
    pub fn propose(&self, seed: u32) -> Vec<DesignValues> {
        let quantities = &self.data.quantities;
        let criterion = Criterion::new(self.goal, quantities);
        let of_some = |designs: &[DesignValues]| self.values_of_criterion(&criterion, designs);
        let of_all = |designs: &[DesignValues]| -> Vec<f64> {
            designs.par_chunks(AT_A_TIME).flat_map_iter(of_some).collect()
        };
        // Designs interpolate their own values, so that their criterion tells which ones are best.
        let mut order: Vec<usize> = (0..self.designs.len()).collect();
        let rank = |index: &usize| {
            let raw = |quantity: &ScaledQuantity| Some(quantity.scale.raw(quantity.values[*index]));
            self.goal.rank(&quantities.iter().map(raw).collect::<Vec<_>>())
        };
        order.sort_by(|left, right| by_rank(rank(left), rank(right)));
        let near: Vec<DesignValues> =
            order.into_iter().take(NEAR).map(|index| self.designs[index].clone()).collect();
        by_criterion(self.space, &near, seed, of_all)
    }

    fn values_of_criterion(&self, criterion: &Criterion, designs: &[DesignValues]) -> Vec<f64> {
        let nothing = || vec![f64::NEG_INFINITY; designs.len()];
        let rows: Vec<Vec<f64>> =
            designs.iter().map(|design| self.space.coordinates(design)).collect();
        let Ok(coordinates) = table(&rows) else { return nothing() };
        let predict = |process: &Interpolation| process.predict(&coordinates.view());
        let predictions: Option<Vec<Vec<Prediction>>> =
            self.processes.iter().map(predict).collect();
        let Some(predictions) = predictions else { return nothing() };
        let distance = self.least_distance;
        let is_near = |design: &DesignValues| {
            self.designs.iter().any(|other| self.space.are_near(other, design, distance))
        };
        let of = |(index, design): (usize, &DesignValues)| {
            if is_near(design) {
                return f64::NEG_INFINITY;
            }
            let of_design = predictions.iter().filter_map(|all| all.get(index).copied());
            criterion.value(&of_design.collect::<Vec<Prediction>>())
        };
        designs.iter().enumerate().map(of).collect()
    }
}
