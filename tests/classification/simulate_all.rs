//! Outcomes of many cases, computed side by side in vector lanes: ten times as fast as one by one.

use rayon::prelude::*;
use stickslip::classification::{
    Outcome, Runs, simulate_by_recorded_equations_in_lockstep, simulate_in_lockstep,
};
use stickslip::model::Case;
use stickslip::motion::SimdLevel;

/// The number of cases that a thread computes together: enough to fill the lanes for most of the
/// time, and few enough to occupy all threads.
const TOGETHER: usize = 128;

/// Returns the outcome of each case, bit for bit that of `simulate`.
pub fn simulate_all(cases: &[Case]) -> Vec<Outcome> {
    let together = |cases: &[Case]| in_lockstep(SimdLevel::best(), cases, 0..cases.len());
    cases.par_chunks(TOGETHER).flat_map_iter(together).collect()
}

/// Returns the outcome of each case, computed by the general kernel.
pub fn simulate_all_by_recorded_equations(cases: &[Case]) -> Vec<Outcome> {
    let together = |cases: &[Case]| {
        let order = (0..cases.len()).rev().collect();
        let mut runs = Listed { cases, order, outcomes: vec![None; cases.len()] };
        simulate_by_recorded_equations_in_lockstep(SimdLevel::best(), &mut runs);
        runs.outcomes.into_iter().map(|outcome| outcome.expect("every run has ended"))
    };
    cases.par_chunks(TOGETHER).flat_map_iter(together).collect()
}

/// Returns the outcomes of cases that take lanes in this order.
pub fn in_lockstep(
    level: SimdLevel,
    cases: &[Case],
    order: impl IntoIterator<Item = usize>,
) -> Vec<Outcome> {
    let mut order: Vec<usize> = order.into_iter().collect();
    order.reverse();
    let mut runs = Listed { cases, order, outcomes: vec![None; cases.len()] };
    simulate_in_lockstep(level, &mut runs);
    runs.outcomes.into_iter().map(|outcome| outcome.expect("every run has ended")).collect()
}

/// Cases, the order in reverse, and the outcomes so far.
struct Listed<'a> {
    cases: &'a [Case],
    order: Vec<usize>,
    outcomes: Vec<Option<Outcome>>,
}

impl Runs for Listed<'_> {
    fn next(&mut self) -> Option<(u64, Case)> {
        let number = self.order.pop()?;
        Some((number as u64, self.cases[number].clone()))
    }

    fn ended(&mut self, number: u64, outcome: Outcome) {
        assert!(self.outcomes[number as usize].replace(outcome).is_none());
    }
}
