//! Engines that compute runs one at a time or in lockstep and turn a panic into the failure of one run, and the
//! computation of one run with its motion.

use std::any::Any;
use std::cell::{Cell, RefCell};
use std::collections::HashMap;
use std::panic::{self, AssertUnwindSafe};
use std::sync::Once;
use std::sync::atomic::{AtomicUsize, Ordering};

use crate::classification::{
    Evidence, Instants, Outcome, RecordedRun, RunRecorder, Runs, simulate, simulate_in_lockstep,
    simulate_recorded,
};
use crate::model::Case;
use crate::motion::{SimdLevel, is_cancelled};
use crate::study::{Plan, Study};
use crate::table::RunRecord;

thread_local! {
    static IN_A_RUN: Cell<bool> = const { Cell::new(false) };
}

/// Computes runs until there are no more. A panic makes one run fail and leaves all others unchanged.
pub(super) type Engine<'a> = dyn Fn(&mut dyn Runs) + Sync + 'a;

/// Computes runs one at a time.
pub(super) fn one_by_one(runs: &mut dyn Runs, simulate: impl Fn(&Case) -> Outcome) {
    quieten_panics_in_runs();
    while let Some((number, case)) = runs.next() {
        let outcome = guarded(&case, &simulate);
        runs.ended(number, outcome);
    }
}

/// Computes runs in lockstep.
pub(super) fn in_lockstep(runs: &mut dyn Runs) {
    together(runs, |runs| simulate_in_lockstep(SimdLevel::best(), runs), simulate);
}

/// Computes runs with `all`. If that panics, each run in progress is computed again with `alone`: the run that
/// caused the panic fails, and the others get the outcome that they would have had without it.
fn together(runs: &mut dyn Runs, all: impl Fn(&mut dyn Runs), alone: impl Fn(&Case) -> Outcome) {
    quieten_panics_in_runs();
    let mut tracked = TrackedRuns { runs, begun: HashMap::new() };
    loop {
        IN_A_RUN.set(true);
        // Only cases and outcomes survive the unwinding: plain values, each complete or absent.
        let computed = panic::catch_unwind(AssertUnwindSafe(|| all(&mut tracked)));
        IN_A_RUN.set(false);
        let Err(payload) = computed else { return };
        if tracked.begun.is_empty() || is_cancelled(payload.as_ref()) {
            // No run caused the panic, so a retry would panic again; or all runs are cancelled.
            panic::resume_unwind(payload);
        }
        let mut begun: Vec<(u64, Case)> = tracked.begun.drain().collect();
        begun.sort_by_key(|(number, _)| *number);
        for (number, case) in begun {
            let outcome = guarded(&case, &alone);
            tracked.runs.ended(number, outcome);
        }
    }
}

/// Records the cases of runs in progress.
struct TrackedRuns<'a> {
    runs: &'a mut dyn Runs,
    begun: HashMap<u64, Case>,
}

impl Runs for TrackedRuns<'_> {
    fn next(&mut self) -> Option<(u64, Case)> {
        let (number, case) = self.runs.next()?;
        self.begun.insert(number, case.clone());
        Some((number, case))
    }

    fn ended(&mut self, number: u64, outcome: Outcome) {
        self.begun.remove(&number);
        self.runs.ended(number, outcome);
    }
}

/// Plans and simulates one run, and simulates an audited run a second time. Invalid parameters and panics become
/// outcomes of the run.
pub fn compute(plan: &Plan, run_id: u64, simulate: impl Fn(&Case) -> Outcome) -> RunRecord {
    quieten_panics_in_runs();
    let planned = plan.planned_run(run_id);
    let (outcome, again) = match &planned.case {
        Err(invalid) => {
            let evidence = Evidence::InvalidParameters(invalid.to_string());
            let again = planned.audited.then(|| evidence.clone());
            (Outcome::of(evidence), again)
        }
        Ok(case) => {
            let again = || {
                let simulation = case.simulation.counter_check();
                guarded(&Case { simulation, ..case.clone() }, &simulate).evidence
            };
            (guarded(case, &simulate), planned.audited.then(again))
        }
    };
    RunRecord { planned, outcome, audit: again }
}

/// Simulates a case and returns a panic as its outcome.
fn guarded(case: &Case, simulate: &impl Fn(&Case) -> Outcome) -> Outcome {
    IN_A_RUN.set(true);
    // Case and outcome are plain values that an unwinding run cannot leave inconsistent.
    let result = panic::catch_unwind(AssertUnwindSafe(|| simulate(case)));
    IN_A_RUN.set(false);
    match result {
        Ok(outcome) => outcome,
        Err(payload) if is_cancelled(payload.as_ref()) => panic::resume_unwind(payload),
        Err(payload) => Outcome::of(Evidence::Panic(panic_message(payload.as_ref()))),
    }
}

fn panic_message(payload: &(dyn Any + Send)) -> String {
    let text = payload.downcast_ref::<&str>().map(|text| (*text).to_owned());
    let text = text.or_else(|| payload.downcast_ref::<String>().cloned());
    format!("the program failed in this run: {}", text.unwrap_or_else(|| "no message".to_owned()))
}

/// Installs a panic hook that is silent for panics in runs: their message goes into the run's row and must not
/// disturb the progress bar.
fn quieten_panics_in_runs() {
    static INSTALL: Once = Once::new();
    INSTALL.call_once(|| {
        let usual = panic::take_hook();
        panic::set_hook(Box::new(move |info| {
            if !IN_A_RUN.get() && QUIET.load(Ordering::Relaxed) == 0 {
                usual(info);
            }
        }));
    });
}

/// Number of calls of [`quietly`] in progress.
static QUIET: AtomicUsize = AtomicUsize::new(0);

/// Runs `work`, which may panic in a library on any thread, and returns `None` if it panics. Suppresses all panic
/// messages meanwhile. After a panic, the caller must not use any value that `work` could change.
pub fn quietly<T>(work: impl FnOnce() -> T) -> Option<T> {
    quieten_panics_in_runs();
    QUIET.fetch_add(1, Ordering::Relaxed);
    let result = panic::catch_unwind(AssertUnwindSafe(work));
    QUIET.fetch_sub(1, Ordering::Relaxed);
    result.ok()
}

/// The largest number of instants, of switches and of impacts of a motion.
pub const MOST_INSTANTS: usize = 1_000_000;

/// Computes a run and returns its row and its motion, at the given times (ascending, in s) or at every step. At most
/// [`MOST_INSTANTS`] instants and as many switches are recorded.
///
/// # Panics
/// If `run_id` is not below [`crate::study::Plan::run_count`].
pub fn record(study: &Study, run_id: u64, times_s: Option<&[f64]>) -> (RunRecord, RecordedRun) {
    let natural = |case: &Case| case.model.natural_frequency_rad_s();
    // An audited run is simulated twice; only the first simulation is recorded.
    let recorder: RefCell<Option<RunRecorder>> = RefCell::new(None);
    let simulated = |case: &Case| {
        if recorder.borrow().is_some() {
            return simulate(case);
        }
        let instants = match times_s {
            None => Instants::EveryStep { inside: 0 },
            Some(times) => Instants::At(times.iter().map(|time| time * natural(case)).collect()),
        };
        let mut slot = recorder.borrow_mut();
        simulate_recorded(case, slot.insert(RunRecorder::new(instants, MOST_INSTANTS)))
    };
    let record = compute(study, run_id, simulated);
    let recording = recorder.into_inner().map(RunRecorder::finish).unwrap_or_default();
    (record, recording)
}

#[cfg(test)]
mod tests {
    use super::together;
    use crate::classification::{Outcome, Runs};
    use crate::model::{Case, Machine, Simulation, Start};

    /// Twenty cases with different start states.
    struct Twenty {
        next: u64,
        ended: Vec<(u64, Outcome)>,
    }

    impl Runs for Twenty {
        fn next(&mut self) -> Option<(u64, Case)> {
            let number = self.next;
            self.next += 1;
            let start = Start(vec![number as f64]);
            let model = Machine::default().into();
            let case = Case { model, start, simulation: Simulation::default() };
            (number < 20).then_some((number, case))
        }

        fn ended(&mut self, number: u64, outcome: Outcome) {
            self.ended.push((number, outcome));
        }
    }

    fn sound(case: &Case) -> Outcome {
        Outcome { end_time_s: Some(case.start.0[0]), ..Outcome::default() }
    }

    fn unless_bad(case: &Case) -> Outcome {
        assert!(case.start.0[0] % 9.0 != 5.0, "bad");
        sound(case)
    }

    /// In batches of three runs, two of twenty runs panic: each of these ends once, as a panic, and all other runs have
    /// the outcome that they have in a batch without panics.
    #[test]
    fn a_panic_does_not_change_other_runs() {
        let three_at_once = |runs: &mut dyn Runs| loop {
            let batch: Vec<_> = (0..3).map_while(|_| runs.next()).collect();
            if batch.is_empty() {
                return;
            }
            for (number, case) in batch {
                runs.ended(number, unless_bad(&case));
            }
        };
        let mut runs = Twenty { next: 0, ended: Vec::new() };
        together(&mut runs, three_at_once, unless_bad);
        runs.ended.sort_by_key(|(number, _)| *number);
        assert!(runs.ended.iter().map(|(number, _)| *number).eq(0..20));
        for (number, outcome) in runs.ended {
            if number % 9 == 5 {
                assert_eq!(outcome.evidence.name(), "panic", "run {number}");
            } else {
                assert_eq!(outcome.end_time_s, Some(number as f64));
            }
        }
    }
}
