//! Sobol' indices by the pick-freeze design.
//!
//! Two independent samples `A` and `B`, and for each variable `A` with that variable taken from `B`:
//! first-order indices by Saltelli et al. (Comput. Phys. Commun. 181 (2010) 259, table 2 (b),
//! doi:10.1016/j.cpc.2009.09.018), total ones by Jansen (Comput. Phys. Commun. 117 (1999) 35,
//! doi:10.1016/S0010-4655(98)00154-4). Intervals are percentiles of a bootstrap over the base samples
//! (G. E. B. Archer, A. Saltelli, I. M. Sobol', J. Stat. Comput. Simul. 58 (1997) 99,
//! doi:10.1080/00949659708811825).

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde::{Deserialize, Serialize};

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
