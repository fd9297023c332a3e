//! Simulation of a case: the function from a case to its outcome.

use super::in_lockstep::{Runs, simulate_in_lockstep};
use super::one_by_one::one_by_one;
use super::outcome::Outcome;
use super::recorder::Recorder;
use crate::model::Case;
use crate::motion::SimdLevel;

/// Simulates a case until its ending is known. This is a pure function: equal cases give equal
/// outcomes, also in [`super::simulate_in_lockstep`].
pub fn simulate(case: &Case) -> Outcome {
    single(case, None)
}

/// Simulates a case like [`simulate`], with bit for bit the same outcome, and records its motion.
pub fn simulate_recorded(case: &Case, recorder: &mut Recorder) -> Outcome {
    recorder.restart();
    single(case, Some(recorder))
}

fn single(case: &Case, recorder: Option<&mut Recorder>) -> Outcome {
    let mut runs = Single { case: Some(case.clone()), outcome: None, recorder };
    simulate_in_lockstep(SimdLevel::best(), &mut runs);
    let Single { outcome, recorder, .. } = runs;
    outcome.unwrap_or_else(|| one_by_one(case, recorder))
}

struct Single<'a> {
    case: Option<Case>,
    outcome: Option<Outcome>,
    recorder: Option<&'a mut Recorder>,
}

impl Runs for Single<'_> {
    fn next(&mut self) -> Option<(u64, Case)> {
        self.case.take().map(|case| (0, case))
    }

    fn ended(&mut self, _: u64, outcome: Outcome) {
        self.outcome = Some(outcome);
    }

    fn recorder(&mut self) -> Option<&mut Recorder> {
        self.recorder.as_deref_mut()
    }
}
