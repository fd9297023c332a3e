//! The inference: space-filling parameter sets, further ones where the posterior is, and the posterior.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, Ordering};

use rayon::prelude::*;

use super::density::{MOST_BALLS, Rests};
use super::fit_test::{SiteFit, fit_tests};
use super::likelihood::{Likelihood, References, set_weights, with_references};
use super::parameter_set::{ParameterSet, SetFiles, set_seed};
use super::posterior::{Marginal, Posterior, next_places, posterior};
use super::regression_width::{FIRST_WIDTH, best_widths, leave_out};
use super::set_densities::SetDensities;
use super::site::{BallsEnd, SimulatedEnd, Site};
use super::smoother::Smoother;
use crate::classification::Label;
use crate::engine::{CommandError, WorkerPool};
use crate::optimize::Space;
use crate::study::{DesignValue, Identification, Plan, Study};

/// The number of parameter sets that are chosen and simulated at a time. Their runs are in one queue, so that vector lanes are
/// idle only at its end.
const SETS_AT_A_TIME: u64 = 8;

/// The test of the fit draws runs from this many parameter sets next to a sample of the posterior.
const NEAR: usize = 4;

/// An inference: what is inferred from what, and the workers.
pub struct Inference<'a> {
    /// The study, whose variables are the parameters.
    pub study: &'a Study,
    /// The parameters and the effort.
    pub identification: &'a Identification,
    /// The measured runs.
    pub sites: &'a [Site],
    /// The workers that compute the runs.
    pub workers: &'a WorkerPool,
    /// Stops the inference when it becomes true.
    pub stop: &'a AtomicBool,
}

/// What was inferred.
#[derive(Clone, Debug)]
pub struct Inferred {
    /// All parameter sets: their values, and the log-likelihood there with its standard error.
    pub sets: Vec<(Vec<DesignValue>, [f64; 2])>,
    /// The number of runs of all parameter sets, and how many of them failed.
    pub runs: [u64; 2],
    /// The posterior.
    pub posterior: Posterior,
    /// The tests at each site.
    pub fits: Vec<SiteFit>,
}

/// Infers the parameters. Calls `finished` for each run that is computed, and `evaluated` after each parameter set. Returns
/// `None` if the inference was stopped; the runs of complete parameter sets are then kept.
///
/// # Errors
/// Returns the errors of `sets`, and that of `impossible` with the reason if there is no posterior.
pub(super) fn infer(
    inference: &Inference,
    sets: &mut SetFiles,
    finished: &(dyn Fn(Label) + Sync),
    mut evaluated: impl FnMut(u64),
    impossible: impl Fn(String) -> CommandError,
) -> Result<Option<Inferred>, CommandError> {
    let Inference { study, identification, workers, .. } = *inference;
    let balls = study.model().angle_contacts().len();
    if balls > MOST_BALLS {
        return Err(impossible(format!("{balls} balls; at most {MOST_BALLS} are supported")));
    }
    let mut all = EvaluatedSets::new(inference);
    while all.count() < identification.designs {
        let is_start = all.count() < identification.start_designs;
        let until = if is_start { identification.start_designs } else { identification.designs };
        let count = SETS_AT_A_TIME.min(until - all.count());
        let places: Vec<Vec<f64>> = if is_start {
            (all.count()..all.count() + count).map(|index| start_place(inference, index)).collect()
        } else {
            workers.install(|| next_places(study, &all.likelihood, count as usize))
        };
        let Some(simulated) = simulated(inference, sets, &places, finished)? else {
            return Ok(None);
        };
        for set in simulated {
            all.add(set);
            evaluated(all.count());
        }
        if all.count() == identification.start_designs {
            if all.rests.iter().flatten().all(|rests| rests.runs() == 0) {
                return Err(impossible("all runs of all parameter sets failed".to_owned()));
            }
            workers.install(|| all.choose_smoothing());
        }
    }
    Ok(Some(workers.install(|| all.inferred())))
}

/// Returns the place of an initial parameter set in the unit cube: a scrambled Sobol' point.
fn start_place(inference: &Inference, index: u64) -> Vec<f64> {
    let seed = inference.study.derived_seed("identify sets", 0) as u32;
    // The study file bounds the number.
    let index = u32::try_from(index).unwrap_or(u32::MAX);
    let dimensions = 0..inference.identification.parameters.len() as u32;
    dimensions.map(|dimension| f64::from(sobol_burley::sample(index, dimension, seed))).collect()
}

/// Returns the values of the parameters at a place in the unit cube, with six significant digits.
fn values_at(inference: &Inference, place: &[f64]) -> Vec<DesignValue> {
    let Inference { study, identification, .. } = *inference;
    let values = identification.values_at(place);
    let fraction = |(parameter, value): (&crate::study::Variable, f64)| {
        let [from, to] = parameter.range().unwrap_or([0.0, 1.0]);
        (value - from) / (to - from)
    };
    let fractions: Vec<f64> = identification.parameters.iter().zip(values).map(fraction).collect();
    Space::new(study).design_at(&fractions)
}

/// Returns the parameter sets at these places with their runs, computed unless they are kept; `None` if the inference was
/// stopped.
fn simulated(
    inference: &Inference,
    sets: &mut SetFiles,
    places: &[Vec<f64>],
    finished: &(dyn Fn(Label) + Sync),
) -> Result<Option<Vec<ParameterSet>>, CommandError> {
    let Inference { study, workers, stop, .. } = *inference;
    let all: Vec<Vec<DesignValue>> =
        places.iter().map(|place| values_at(inference, place)).collect();
    let known = all.iter().map(|values| sets.find(values)).collect::<Result<Vec<_>, _>>()?;
    let missing = known.iter().zip(&all).filter(|(known, _)| known.is_none());
    // Values that are impossible together give a set without known ends.
    let plans: Vec<Option<Plan>> = missing.map(|(_, values)| plan_of_set(study, values)).collect();
    let points_of = |plan: &Plan| 0..plan.point_count();
    let points: Vec<(&Plan, u64)> = plans
        .iter()
        .flatten()
        .flat_map(|plan| points_of(plan).map(move |point_id| (plan, point_id)))
        .collect();
    if stop.load(Ordering::Relaxed) {
        return Ok(None);
    }
    let Some(runs) = workers.sample(&points, stop, finished) else { return Ok(None) };
    let mut runs = runs.into_iter();
    let mut plans = plans.iter();
    let mut simulated = Vec::with_capacity(all.len());
    for (known, values) in known.into_iter().zip(all) {
        if let Some(set) = known {
            simulated.push(set);
            continue;
        }
        let points = plans.next().and_then(Option::as_ref).map_or(0..0, points_of);
        let of_set = runs.by_ref().take(points.count());
        let set = ParameterSet {
            values,
            ends: of_set.flatten().flat_map(|run| SimulatedEnd::of(&run)).collect(),
        };
        sets.keep(&set)?;
        simulated.push(set);
    }
    Ok(Some(simulated))
}

/// Returns the plan of a parameter set. Its start states and draws are its own: the errors of the densities of different
/// sets are then independent, and a regression over the sets makes them smaller. Returns `None` if the values are impossible.
fn plan_of_set(study: &Study, values: &[DesignValue]) -> Option<Plan> {
    let seeded = study.with_seed(set_seed(study, values)).ok()?;
    seeded.for_identification()?.0.set(values).ok()
}

/// The parameter sets so far.
struct EvaluatedSets<'a> {
    inference: &'a Inference<'a>,
    values: Vec<Vec<DesignValue>>,
    /// The simulated ends of each set at each site.
    rests: Vec<Vec<Rests>>,
    likelihood: Likelihood,
    runs: [u64; 2],
}

impl<'a> EvaluatedSets<'a> {
    fn new(inference: &'a Inference<'a>) -> Self {
        let Inference { study, sites, identification, .. } = *inference;
        let references = sites.iter().map(|site| References::known(site.rests.len(), None));
        let widths = vec![FIRST_WIDTH; identification.parameters.len()];
        let likelihood = Likelihood {
            references: references.collect(),
            sites: sites.to_vec(),
            densities: Vec::new(),
            smoother: Smoother::new(Vec::new(), widths),
            set_weights: Vec::new(),
            uniform: Rests::new(study.model().angle_contacts().len(), []).uniform(),
        };
        EvaluatedSets { inference, values: Vec::new(), rests: Vec::new(), likelihood, runs: [0; 2] }
    }

    fn count(&self) -> u64 {
        self.values.len() as u64
    }

    fn add(&mut self, set: ParameterSet) {
        let Inference { study, sites, identification, .. } = *self.inference;
        let balls = study.model().angle_contacts().len();
        let mut ends: BTreeMap<(u64, u64), Vec<&BallsEnd>> = BTreeMap::new();
        for end in &set.ends {
            ends.entry((end.point_id, end.stage)).or_default().push(&end.end);
        }
        let at = |site: &Site| ends.remove(&(site.point_id, site.stage)).unwrap_or_default();
        let rests: Vec<Rests> =
            sites.iter().map(at).map(|found| Rests::new(balls, found)).collect();
        // The last end of each run is unknown only if the run failed.
        let last_ends = set.ends.chunk_by(|left, right| left.run_id == right.run_id);
        let ended =
            last_ends.filter(|ends| ends.last().is_some_and(|last| last.end != BallsEnd::Unknown));
        self.runs[0] += study.run_count();
        self.runs[1] += study.run_count().saturating_sub(ended.count() as u64);
        let numbers: Vec<f64> = set.values.iter().map(number_of).collect();
        self.likelihood.smoother.places.push(identification.place_of(&numbers));
        self.likelihood.densities.push(densities(&self.likelihood.sites, &rests));
        self.likelihood.set_weights.push(set_weights(study, self.values.len()));
        self.rests.push(rests);
        self.values.push(set.values);
    }

    /// Adds reference positions, and chooses the widths of the regression.
    fn choose_smoothing(&mut self) {
        let Inference { study, sites, .. } = *self.inference;
        let EvaluatedSets { rests, likelihood, .. } = self;
        let places = &likelihood.smoother.places;
        let likelihoods: Vec<f64> =
            places.par_iter().map(|place| likelihood.at(place, 0)).collect();
        let left_out = leave_out(study, sites, rests, &likelihoods);
        let with_references = |(index, site): (usize, &Site)| {
            let here: Vec<&Rests> = rests.iter().map(|set| &set[index]).collect();
            with_references(study, index, site, &here)
        };
        likelihood.sites = sites.iter().enumerate().map(with_references).collect();
        let of_set = |rests: &Vec<Rests>| densities(&likelihood.sites, rests);
        likelihood.densities = rests.par_iter().map(of_set).collect();
        let references = |(index, site): (usize, &Site)| {
            let each: Vec<&SetDensities> =
                likelihood.densities.iter().map(|set| &set[index]).collect();
            References::new(site.rests.len(), &each)
        };
        likelihood.references = sites.iter().enumerate().map(references).collect();
        likelihood.smoother.widths = best_widths(likelihood, rests, &left_out);
    }

    fn inferred(self) -> Inferred {
        let Inference { study, sites, identification, .. } = *self.inference;
        let likelihood = &self.likelihood;
        let posterior = posterior(study, identification, likelihood);
        let numbered = posterior.samples.iter().enumerate();
        let drawn: Vec<&[Rests]> =
            numbered.map(|(number, sample)| self.near(&posterior, number, sample)).collect();
        let fits = fit_tests(study, sites, &drawn);
        let at = |place: &Vec<f64>| likelihood.with_error(place);
        let likelihoods: Vec<[f64; 2]> = likelihood.smoother.places.par_iter().map(at).collect();
        let sets = self.values.iter().cloned().zip(likelihoods).collect();
        Inferred { sets, runs: self.runs, posterior, fits }
    }

    /// Returns the ends of one of the parameter sets next to a sample of the posterior: the first of several samples has those of
    /// the nearest set, the second one those of the second nearest set, and so on.
    fn near(&self, posterior: &Posterior, number: usize, sample: &[f64]) -> &[Rests] {
        let distance = |set: &Vec<DesignValue>| -> f64 {
            let parts = set.iter().zip(sample).zip(&posterior.marginals);
            let square = |((value, sample), marginal): ((&DesignValue, &f64), &Marginal)| {
                ((number_of(value) - sample) / marginal.std_dev.max(f64::MIN_POSITIVE)).powi(2)
            };
            parts.map(square).sum()
        };
        let mut near: Vec<(usize, f64)> = self.values.iter().map(distance).enumerate().collect();
        let place = number % NEAR.min(near.len());
        let (_, (index, _), _) = near.select_nth_unstable_by(place, |left, right| {
            left.1.total_cmp(&right.1).then(left.0.cmp(&right.0))
        });
        &self.rests[*index]
    }
}

/// Returns the densities of one parameter set at each site.
fn densities(sites: &[Site], rests: &[Rests]) -> Vec<SetDensities> {
    sites.iter().zip(rests).map(|(site, rests)| SetDensities::at_site(site, rests)).collect()
}

/// Returns the number of a value; only numbers are identified.
fn number_of(value: &DesignValue) -> f64 {
    match value {
        DesignValue::Number(number) => *number,
        DesignValue::Choice(_) => f64::NAN,
    }
}
