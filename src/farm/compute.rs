//! One run by its number, whatever happens in it.

use std::any::Any;
use std::cell::Cell;
use std::panic::{self, AssertUnwindSafe};
use std::sync::Once;

use crate::ending::{Evidence, Outcome};
use crate::model::Case;
use crate::study::Study;
use crate::table::RunRecord;

thread_local! {
    static IN_A_RUN: Cell<bool> = const { Cell::new(false) };
}

/// Plans and simulates one run, an audited one twice; what is nearest to where it ended is left open.
/// Parameters without physical sense and panics are outcomes, not
/// ends of the program.
pub fn compute(study: &Study, run_id: u64, simulate: impl Fn(&Case) -> Outcome) -> RunRecord {
    quieten_panics_in_runs();
    let planned = study.planned_run(run_id);
    let (outcome, again) = match &planned.case {
        Err(invalid) => {
            let evidence = Evidence::InvalidParameters;
            (Outcome::failed(evidence, invalid.to_string()), planned.audited.then_some(evidence))
        }
        Ok(case) => {
            let again = || {
                let simulation = case.simulation.counter_check();
                guarded(&Case { simulation, ..case.clone() }, &simulate).evidence
            };
            (guarded(case, &simulate), planned.audited.then(again))
        }
    };
    RunRecord { planned, outcome, audit: again, nearest: None }
}

/// Simulates a case; a panic is its outcome.
fn guarded(case: &Case, simulate: impl Fn(&Case) -> Outcome) -> Outcome {
    IN_A_RUN.set(true);
    // Nothing outlives a run that unwinds: case and outcome are plain values.
    let result = panic::catch_unwind(AssertUnwindSafe(|| simulate(case)));
    IN_A_RUN.set(false);
    result
        .unwrap_or_else(|payload| Outcome::failed(Evidence::Panic, panic_message(payload.as_ref())))
}

fn panic_message(payload: &(dyn Any + Send)) -> String {
    let text = payload.downcast_ref::<&str>().map(|text| (*text).to_owned());
    let text = text.or_else(|| payload.downcast_ref::<String>().cloned());
    format!("the program failed in this run: {}", text.unwrap_or_else(|| "no message".to_owned()))
}

/// A panic in a run goes into its row; it should not also tear the progress bar.
fn quieten_panics_in_runs() {
    static INSTALL: Once = Once::new();
    INSTALL.call_once(|| {
        let usual = panic::take_hook();
        panic::set_hook(Box::new(move |info| {
            if !IN_A_RUN.get() {
                usual(info);
            }
        }));
    });
}
