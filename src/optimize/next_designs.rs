//! The next designs of a search: a function of the study and of the designs before, for any number of threads and after
//! any interruption.
//!
//! After the space-filling designs, surrogates propose designs in batches. All designs of a batch depend on the designs
//! before the batch alone. Hyperparameters are fitted at the beginning of some batches, less often the more designs
//! there are.

use super::evaluations::{DesignOrigin, Evaluation};
use super::goal::Goal;
use super::process::Hyperparameters;
use super::proposal::DesignValues;
use super::space::Space;
use super::suggest::{Proposer, TrainingData};
use crate::study::{Optimization, Plan, Study};

/// Number of designs in a batch.
const BATCH: u64 = 4;
/// Least distance of a proposal to other designs if responses have noise, and if they do not, as a fraction of the range
/// of each number. Noise hides differences between nearer designs.
const LEAST_DISTANCES: [f64; 2] = [0.02, 1e-4];
/// Number of repeated designs after which the search assumes that there are no others.
const MAX_SKIPPED: u32 = 10_000;

/// A design to evaluate, and the study with its values.
pub(super) struct NextDesign {
    pub origin: DesignOrigin,
    pub values: DesignValues,
    pub plan: Plan,
}

/// Returns the designs that are not in a list and whose values are consistent.
struct ChosenDesigns<'a> {
    study: &'a Study,
    taken: Vec<DesignValues>,
    next: Vec<NextDesign>,
}

impl<'a> ChosenDesigns<'a> {
    fn new(study: &'a Study, evaluations: &[Evaluation]) -> ChosenDesigns<'a> {
        let taken = evaluations.iter().map(|evaluation| evaluation.values.clone()).collect();
        ChosenDesigns { study, taken, next: Vec::new() }
    }

    /// Adds a design and returns true, unless it is repeated or inconsistent.
    fn add(&mut self, origin: DesignOrigin, values: &DesignValues) -> bool {
        if self.taken.contains(values) {
            return false;
        }
        let Ok(plan) = self.study.set(values) else { return false };
        self.taken.push(values.clone());
        self.next.push(NextDesign { origin, values: values.clone(), plan });
        true
    }

    /// Adds the next design of the space-filling sequence; returns false if there is no other.
    fn add_space_filling(&mut self, origin: DesignOrigin, space: &Space) -> bool {
        // A scramble that is independent of that of start states.
        let seed = self.study.derived_seed("optimize spread", 0) as u32;
        (0..MAX_SKIPPED).any(|index| self.add(origin, &space.space_filling(index, seed)))
    }
}

/// Returns the remaining designs of the start.
pub(super) fn start_designs(
    study: &Study,
    optimization: &Optimization,
    evaluations: &[Evaluation],
    until: u64,
) -> Vec<NextDesign> {
    let space = Space::new(study);
    let mut chosen = ChosenDesigns::new(study, evaluations);
    for number in evaluations.len() as u64..until {
        let found = match (number, &optimization.compare_with) {
            (0, Some(values)) => chosen.add(DesignOrigin::CompareWith, values),
            _ => chosen.add_space_filling(DesignOrigin::SpaceFilling, &space),
        };
        if !found {
            break;
        }
    }
    chosen.next
}

/// Hyperparameters of each fit so far, with the number of designs that it used.
#[derive(Clone, Debug, Default)]
pub(super) struct Fits(Vec<(u64, Option<Vec<Hyperparameters>>)>);

impl Fits {
    /// Returns the hyperparameters for the batch after `count` designs. Repeats all fits up to there that are missing;
    /// `fit` gets a number of designs and the hyperparameters of the fit before.
    fn at(
        &mut self,
        start: u64,
        count: u64,
        fit: impl Fn(u64, Option<&[Hyperparameters]>) -> Option<Vec<Hyperparameters>>,
    ) -> Option<&[Hyperparameters]> {
        let mut due = start;
        let mut used = 0;
        let mut batch = start;
        while batch <= count {
            if batch >= due {
                if used == self.0.len() {
                    let before = self.0.iter().rev().find_map(|(_, fitted)| fitted.as_deref());
                    let fitted = fit(batch, before);
                    self.0.push((batch, fitted));
                }
                used += 1;
                due = batch + (batch / 6).max(1);
            }
            batch += BATCH;
        }
        let fitted = self.0.iter().take(used).rev();
        fitted.map(|(_, fitted)| fitted.as_deref()).find(Option::is_some).flatten()
    }
}

/// Returns the remaining designs of the batch in progress, up to design number `until`.
pub(super) fn batch(
    study: &Study,
    optimization: &Optimization,
    evaluations: &[Evaluation],
    until: u64,
    fits: &mut Fits,
) -> Vec<NextDesign> {
    let (space, goal) = (Space::new(study), Goal::new(study, optimization));
    let (start, number) = (optimization.start_designs, evaluations.len() as u64);
    let first = start + (number - start) / BATCH * BATCH;
    let (before, begun) = evaluations.split_at(first as usize);
    let data = |count: u64| TrainingData::new(&space, &goal, before.get(..count as usize)?);
    let hyperparameters = fits.at(start, first, |count, earlier| data(count)?.fit(earlier));
    let least_distance = LEAST_DISTANCES[usize::from(!study.is_random())];
    let proposer = || {
        let designs = before.iter().map(|evaluation| evaluation.values.clone()).collect();
        let mut proposer =
            Proposer::new(&space, &goal, hyperparameters?, data(first)?, designs, least_distance)?;
        for design in begun {
            proposer.believe(&design.values)?;
        }
        Some(proposer)
    };
    let mut proposer = proposer();
    let mut chosen = ChosenDesigns::new(study, evaluations);
    for number in number..until.min(first + BATCH) {
        let seed = study.derived_seed("optimize suggest", number) as u32;
        let proposals = proposer.as_ref().map_or_else(Vec::new, |proposer| proposer.propose(seed));
        let found = proposals.iter().any(|design| chosen.add(DesignOrigin::Surrogates, design));
        if !found && !chosen.add_space_filling(DesignOrigin::SpaceFillingInstead, &space) {
            break;
        }
        let believed = proposer.as_mut().zip(chosen.next.last());
        if believed.is_some_and(|(proposer, next)| proposer.believe(&next.values).is_none()) {
            proposer = None;
        }
    }
    chosen.next
}

#[cfg(test)]
mod tests {
    use super::{BATCH, Fits};

    /// Fits after an interruption are those of a search without one, and become rarer.
    #[test]
    fn fits_do_not_depend_on_interruptions() {
        let counts = |asked: &[u64]| {
            let mut fits = Fits::default();
            for count in asked {
                fits.at(60, *count, |_, _| Some(Vec::new()));
            }
            fits.0.iter().map(|(count, _)| *count).collect::<Vec<_>>()
        };
        let each: Vec<u64> = (60..=148).step_by(BATCH as usize).collect();
        assert_eq!(counts(&each), counts(&[148]));
        assert_eq!(counts(&[148]), [60, 72, 84, 100, 116, 136]);
        // The fit before the asked one is used, not a later one.
        let mut fits = Fits::default();
        fits.at(60, 100, |_, _| Some(Vec::new()));
        let tried = fits.at(60, 68, |_, _| None);
        assert!(tried.is_some() && fits.0.len() == 4);
    }
}
