//! Simulation of a case: the function from a case to its outcome.

use super::in_lockstep::{KernelChoice, Runs, simulate_with};
use super::outcome::Outcome;
use super::run_recorder::RunRecorder;
use crate::model::Case;
use crate::motion::SimdLevel;

/// Simulates a case until its ending is known. This is a pure function: equal cases give equal
/// outcomes, also in [`super::simulate_in_lockstep`].
pub fn simulate(case: &Case) -> Outcome {
    single(case, KernelChoice::Fastest, None)
}

/// Simulates a case like [`simulate`] with the general kernel, also where a tuned one exists. The outcomes of both agree
/// within the tolerances.
pub fn simulate_by_recorded_equations(case: &Case) -> Outcome {
    single(case, KernelChoice::General, None)
}

/// Simulates a case like [`simulate`], with bit for bit the same outcome, and records its motion.
pub fn simulate_recorded(case: &Case, recorder: &mut RunRecorder) -> Outcome {
    recorder.restart();
    single(case, KernelChoice::Fastest, Some(recorder))
}

fn single(case: &Case, kernel: KernelChoice, recorder: Option<&mut RunRecorder>) -> Outcome {
    let mut runs = SingleRun { case: Some(case.clone()), outcome: None, recorder };
    simulate_with(kernel, SimdLevel::best(), &mut runs);
    runs.outcome.expect("every run ends")
}

struct SingleRun<'a> {
    case: Option<Case>,
    outcome: Option<Outcome>,
    recorder: Option<&'a mut RunRecorder>,
}

impl Runs for SingleRun<'_> {
    fn next(&mut self) -> Option<(u64, Case)> {
        self.case.take().map(|case| (0, case))
    }

    fn ended(&mut self, _: u64, outcome: Outcome) {
        self.outcome = Some(outcome);
    }

    fn recorder(&mut self) -> Option<&mut RunRecorder> {
        self.recorder.as_deref_mut()
    }
}
