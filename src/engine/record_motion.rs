//! Computes one run and records its motion.

use std::cell::RefCell;

use super::compute;
use crate::classification::{Instants, RecordedRun, RunRecorder, simulate, simulate_recorded};
use crate::model::Case;
use crate::study::Study;
use crate::table::RunRecord;

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
