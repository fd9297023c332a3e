//! The one arrow of this room: a case goes in, an outcome comes out.

use super::in_lockstep::{Runs, simulate_in_lockstep};
use super::one_by_one::one_by_one;
use super::outcome::Outcome;
use super::recorder::Recorder;
use crate::model::Case;
use crate::motion::SimdLevel;

/// Simulates a case until its ending is known. A pure function: equal cases give equal outcomes, here
/// and among others in [`super::simulate_in_lockstep`].
pub fn simulate(case: &Case) -> Outcome {
    single(case, None)
}

/// The same, to the last bit, with its motion recorded.
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
