//! Warnings of an inference: a posterior that leans on an end of its prior, and too few simulated runs.

use super::inference::{Inference, Inferred};
use super::posterior::Marginal;
use crate::numbers::four_digits;
use crate::study::DesignValue;

/// Errors from the number of simulated runs above this give a warning, over the standard deviation of the posterior.
const INACCURATE: f64 = 0.5;
/// The fewest parameter sets from which this error is estimated, for each coefficient of the local quadratic regression.
const SETS_PER_COEFFICIENT: usize = 10;
/// A wider prior is proposed: wider by the first of these parts of its width that gives a possible machine.
const WIDER: [f64; 3] = [0.5, 0.2, 0.1];

/// Returns the warnings, each with the key, what was found, and a remedy.
pub fn warnings(inference: &Inference, inferred: &Inferred) -> Vec<String> {
    let Inference { study, identification, .. } = *inference;
    let marginals = &inferred.posterior.marginals;
    let medians: Vec<f64> = marginals.iter().map(|marginal| marginal.median).collect();
    let leaning = |(index, marginal): (usize, &Marginal)| {
        let (key, name) = (marginal.leans_on?, &marginal.name);
        let (end, side) =
            if key == "from" { (marginal.prior[0], -1.0) } else { (marginal.prior[1], 1.0) };
        // Beyond an end that is a limit of the physics, such as a friction of 0, nothing can be true.
        let wider = WIDER.iter().find_map(|part| {
            let mut place = identification.place_of(&medians);
            place[index] = 0.5 + side * (0.5 + part);
            let values = identification.values_at(&place);
            let numbers: Vec<DesignValue> =
                values.iter().map(|value| DesignValue::Number(*value)).collect();
            study.set(&numbers).is_ok().then(|| four_digits(values[index]))
        })?;
        let [end, low, high] = [end, marginal.interval[0], marginal.interval[1]].map(four_digits);
        Some(format!(
            "identify.parameters.{name}.{key}: the posterior leans on this end of the prior, and the true value may be \
             beyond it\n  found:  {end}, and a 95 % interval from {low} to {high}\n  remedy: a wider prior, such as {key}: \
             {wider}"
        ))
    };
    let inaccurate = |marginal: &Marginal| {
        let (sets, runs) = (inferred.sets.len(), study.run_count());
        let few = match fewest_sets(inferred) {
            fewest if sets < fewest => format!(" (an estimate that needs at least {fewest} sets)"),
            _ => String::new(),
        };
        format!(
            "identify.designs: too few simulated runs for an accurate posterior of {}\n  found:  {sets} parameter sets with \
             {runs} runs each, which give an error of about {:.1} standard deviations{few}; the interval may be too narrow or \
             misplaced by that much or more, and all inferences from these runs share the error\n  remedy: more parameter sets \
             (start_designs and designs), or more runs in each, before the interval is used",
            marginal.name, marginal.simulation_error
        )
    };
    let leaning = marginals.iter().enumerate().filter_map(leaning);
    leaning
        .chain(marginals.iter().filter(|marginal| !is_accurate(inferred, marginal)).map(inaccurate))
        .collect()
}

/// Returns whether enough runs are simulated for the posterior of a parameter.
pub(super) fn is_accurate(inferred: &Inferred, marginal: &Marginal) -> bool {
    marginal.simulation_error <= INACCURATE && inferred.sets.len() >= fewest_sets(inferred)
}

fn fewest_sets(inferred: &Inferred) -> usize {
    let parameters = inferred.posterior.marginals.len();
    SETS_PER_COEFFICIENT * (parameters + 1) * (parameters + 2) / 2
}
