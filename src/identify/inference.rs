//! The inference: space-filling parameter sets, further ones where the posterior is, and the posterior.

use std::sync::atomic::{AtomicBool, Ordering};

use rayon::prelude::*;

use super::bandwidth::Bandwidths;
use super::density::{MOST_BALLS, Rests};
use super::end::{End, SimulatedEnd};
use super::fit_test::{SiteFit, fit_tests};
use super::likelihood::{LogLikelihood, log_likelihood};
use super::next_sets::next_places;
use super::parameter_set::ParameterSet;
use super::posterior::{Posterior, posterior};
use super::sampler::generator;
use super::site::Site;
use crate::classification::Label;
use crate::engine::WorkerPool;
use crate::optimize::Space;
use crate::study::{DesignValue, Identification, Study};

/// The number of parameter sets that are chosen at a time.
const BATCH: u64 = 8;
/// The number of parameter sets, the most likely ones, that choose the bandwidths.
const FOR_BANDWIDTHS: usize = 6;

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

/// Where the runs of parameter sets are kept.
pub trait Sets<E> {
    /// Returns the runs of a parameter set, if they have been computed before.
    ///
    /// # Errors
    /// Returns an error if the runs cannot be read.
    fn find(&mut self, values: &[DesignValue]) -> Result<Option<ParameterSet>, E>;

    /// Keeps the runs of a parameter set.
    ///
    /// # Errors
    /// Returns an error if the runs cannot be written.
    fn keep(&mut self, set: &ParameterSet) -> Result<(), E>;
}

/// How an inference ended.
pub enum InferenceEnd {
    /// The posterior.
    Finished(Box<Inferred>),
    /// The inference was stopped; the runs of complete parameter sets are kept.
    Stopped,
    /// There is no posterior, for this reason.
    Impossible(String),
}

/// What was inferred.
#[derive(Clone, Debug)]
pub struct Inferred {
    /// All parameter sets: their values, and their log-likelihoods.
    pub sets: Vec<(Vec<DesignValue>, LogLikelihood)>,
    /// The number of runs of all parameter sets, and how many of them failed.
    pub runs: [u64; 2],
    /// The bandwidths at each site.
    pub bandwidths: Vec<Bandwidths>,
    /// The posterior.
    pub posterior: Posterior,
    /// The tests at each site.
    pub fits: Vec<SiteFit>,
}

/// The parameter sets so far.
#[derive(Default)]
struct Evaluated {
    values: Vec<Vec<DesignValue>>,
    coordinates: Vec<Vec<f64>>,
    /// The simulated ends at each site.
    rests: Vec<Vec<Rests>>,
    likelihoods: Vec<LogLikelihood>,
    runs: [u64; 2],
}

/// Infers the parameters. Calls `finished` for each run that is computed, and `evaluated` after each parameter set.
///
/// # Errors
/// Returns the errors of `sets`.
pub fn infer<E>(
    inference: &Inference,
    sets: &mut impl Sets<E>,
    finished: &(dyn Fn(Label) + Sync),
    mut evaluated: impl FnMut(u64),
) -> Result<InferenceEnd, E> {
    let Inference { study, identification, sites, workers, .. } = *inference;
    if study.model().balls() > MOST_BALLS {
        let problem =
            format!("{} balls; at most {MOST_BALLS} are supported", study.model().balls());
        return Ok(InferenceEnd::Impossible(problem));
    }
    let space = Space::new(study);
    let seed = study.derived_seed("identify sets", 0) as u32;
    let mut all = Evaluated::default();
    let mut bandwidths = vec![Bandwidths::default(); sites.len()];
    while (all.values.len() as u64) < identification.designs {
        let number = all.values.len() as u64;
        let next: Vec<Vec<DesignValue>> = if number < identification.start_designs {
            let index = u32::try_from(number).unwrap_or(u32::MAX);
            vec![space.space_filling(index, seed)]
        } else {
            if number == identification.start_designs {
                bandwidths = chosen_bandwidths(inference, &mut all);
            }
            let count = BATCH.min(identification.designs - number) as usize;
            match next_places(study, &all.coordinates, &all.likelihoods, count) {
                Ok(places) => places.iter().map(|place| space.design_at(place)).collect(),
                Err(problem) => return Ok(InferenceEnd::Impossible(problem)),
            }
        };
        for values in next {
            let Some(set) = simulated(inference, sets, values, finished)? else {
                return Ok(InferenceEnd::Stopped);
            };
            all.add(inference, set, &bandwidths);
            evaluated(all.values.len() as u64);
        }
    }
    if identification.start_designs == identification.designs {
        bandwidths = chosen_bandwidths(inference, &mut all);
    }
    let infer = || posterior(study, identification, &all.coordinates, &all.likelihoods);
    let posterior = match workers.install(infer) {
        Ok(posterior) => posterior,
        Err(problem) => return Ok(InferenceEnd::Impossible(problem)),
    };
    let nearest: Vec<&[Rests]> =
        posterior.samples.iter().map(|sample| all.nearest(&posterior, sample)).collect();
    let fits = fit_tests(study, sites, &nearest);
    let sets = all.values.into_iter().zip(all.likelihoods).collect();
    Ok(InferenceEnd::Finished(Box::new(Inferred {
        sets,
        runs: all.runs,
        bandwidths,
        posterior,
        fits,
    })))
}

/// Returns a parameter set with its runs, computed unless they are kept; `None` if the inference was stopped.
fn simulated<E>(
    inference: &Inference,
    sets: &mut impl Sets<E>,
    values: Vec<DesignValue>,
    finished: &(dyn Fn(Label) + Sync),
) -> Result<Option<ParameterSet>, E> {
    let Inference { study, workers, stop, .. } = *inference;
    if stop.load(Ordering::Relaxed) {
        return Ok(None);
    }
    if let Some(set) = sets.find(&values)? {
        return Ok(Some(set));
    }
    // Values that are impossible together give a set without known ends.
    let ends = match study.set(&values) {
        Err(_) => Vec::new(),
        Ok(own) => {
            let points: Vec<(&Study, u64)> =
                (0..own.point_count()).map(|point_id| (&own, point_id)).collect();
            let Some(runs) = workers.sample(&points, stop, finished) else { return Ok(None) };
            runs.iter().flatten().flat_map(SimulatedEnd::of).collect()
        }
    };
    let set = ParameterSet { values, ends };
    sets.keep(&set)?;
    Ok(Some(set))
}

/// Chooses the bandwidths at each site, and computes all log-likelihoods with them.
fn chosen_bandwidths(inference: &Inference, all: &mut Evaluated) -> Vec<Bandwidths> {
    let Inference { study, sites, workers, .. } = *inference;
    let mut order: Vec<usize> = (0..all.values.len()).collect();
    order.sort_by(|one, other| {
        let [one, other] = [one, other].map(|index| all.likelihoods[*index].value);
        other.total_cmp(&one)
    });
    order.truncate(FOR_BANDWIDTHS);
    let chosen = |(index, site): (usize, &Site)| {
        let mut random = generator(study, "identify bandwidths", index as u64);
        let rests: Vec<&Rests> = order.iter().map(|set| &all.rests[*set][index]).collect();
        Bandwidths::chosen(site, &rests, &mut random)
    };
    let bandwidths: Vec<Bandwidths> =
        workers.install(|| sites.par_iter().enumerate().map(chosen).collect());
    let likelihood = |rests: &Vec<Rests>| log_likelihood(sites, rests, &bandwidths);
    all.likelihoods = workers.install(|| all.rests.par_iter().map(likelihood).collect());
    bandwidths
}

impl Evaluated {
    fn add(&mut self, inference: &Inference, set: ParameterSet, bandwidths: &[Bandwidths]) {
        let Inference { study, sites, .. } = *inference;
        let balls = study.model().balls();
        let at = |site: &Site| {
            let here =
                |end: &&SimulatedEnd| (end.point_id, end.stage) == (site.point_id, site.stage);
            Rests::new(balls, set.ends.iter().filter(here).map(|end| &end.end))
        };
        let rests: Vec<Rests> = sites.iter().map(at).collect();
        // The last end of each run is unknown only if the run failed.
        let last_ends = set.ends.chunk_by(|one, other| one.run_id == other.run_id);
        let ended = last_ends.filter(|ends| ends.last().is_some_and(|one| one.end != End::Unknown));
        self.runs[0] += study.run_count();
        self.runs[1] += study.run_count().saturating_sub(ended.count() as u64);
        self.likelihoods.push(log_likelihood(sites, &rests, bandwidths));
        self.coordinates.push(study.scaled(&set.values));
        self.values.push(set.values);
        self.rests.push(rests);
    }

    /// Returns the ends of the parameter set next to a sample of the posterior.
    fn nearest(&self, posterior: &Posterior, sample: &[f64]) -> &[Rests] {
        let place = |set: &Vec<DesignValue>| -> f64 {
            let parts = set.iter().zip(sample).zip(&posterior.marginals);
            parts
                .map(|((value, sample), marginal)| match value {
                    DesignValue::Number(number) => {
                        ((number - sample) / marginal.std_dev.max(f64::MIN_POSITIVE)).powi(2)
                    }
                    DesignValue::Choice(_) => 0.0,
                })
                .sum()
        };
        let distances = self.values.iter().map(place).enumerate();
        let nearest = distances.min_by(|one, other| one.1.total_cmp(&other.1));
        nearest.map_or(&[], |(index, _)| &self.rests[index])
    }
}
