//! The runs of one worker: taken from what is left of a chunk, planned, and finished.

use std::collections::HashMap;
use std::collections::VecDeque;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use super::Progress;
use super::rounds::Round;
use crate::analysis::NearestFinder;
use crate::ending::{Evidence, Outcome, Runs};
use crate::model::Case;
use crate::study::{PlannedRun, Study};
use crate::table::RunRecord;

/// A chunk of runs that workers share.
pub(super) struct Chunk<'a> {
    pub(super) study: &'a Study,
    pub(super) round: Round,
    /// Its first run in the round.
    pub(super) first: u64,
    pub(super) runs: u64,
    /// How many of its runs have been begun.
    pub(super) begun: AtomicU64,
    pub(super) finder: &'a NearestFinder,
    pub(super) stop: &'a AtomicBool,
    pub(super) progress: &'a Progress,
}

/// What one worker does of a chunk.
pub(super) struct Work<'a> {
    chunk: &'a Chunk<'a>,
    /// Second computations of audited runs that are still to be begun.
    again: VecDeque<(u64, Case)>,
    open: HashMap<u64, Open>,
    /// Finished runs by their place in the chunk, in any order.
    pub(super) finished: Vec<(u64, RunRecord)>,
}

/// A run of which something is still to come.
struct Open {
    planned: PlannedRun,
    outcome: Option<Outcome>,
    again: Option<Evidence>,
}

impl<'a> Work<'a> {
    pub(super) fn new(chunk: &'a Chunk<'a>) -> Self {
        Work { chunk, again: VecDeque::new(), open: HashMap::new(), finished: Vec::new() }
    }

    /// Takes in what is known of a run; it is finished when all of it is.
    fn take_in(&mut self, place: u64, open: Open) {
        let Open { planned, outcome, again } = open;
        let complete = !planned.audited || again.is_some();
        let (Some(outcome), true) = (&outcome, complete) else {
            self.open.insert(place, Open { planned, outcome, again });
            return;
        };
        let nearest =
            planned.case.as_ref().ok().and_then(|case| self.chunk.finder.nearest(case, outcome));
        self.chunk.progress.finished(outcome.label());
        let record = RunRecord { planned, outcome: outcome.clone(), audit: again, nearest };
        self.finished.push((place, record));
    }
}

/// Of each place in the chunk there are two numbers: the run itself and its second computation.
impl Runs for Work<'_> {
    fn next(&mut self) -> Option<(u64, Case)> {
        if let Some(again) = self.again.pop_front() {
            return Some(again);
        }
        loop {
            if self.chunk.stop.load(Ordering::Relaxed) {
                return None;
            }
            let place = self.chunk.begun.fetch_add(1, Ordering::Relaxed);
            if place >= self.chunk.runs {
                return None;
            }
            let run_id = self.chunk.round.run_id(self.chunk.first + place);
            let planned = self.chunk.study.planned_run(run_id);
            match &planned.case {
                Ok(case) => {
                    let case = case.clone();
                    if planned.audited {
                        let simulation = case.simulation.counter_check();
                        self.again.push_back((2 * place + 1, Case { simulation, ..case.clone() }));
                    }
                    self.open.insert(place, Open { planned, outcome: None, again: None });
                    return Some((2 * place, case));
                }
                Err(invalid) => {
                    let evidence = Evidence::InvalidParameters;
                    let outcome = Some(Outcome::failed(evidence, invalid.to_string()));
                    let again = planned.audited.then_some(evidence);
                    self.take_in(place, Open { planned, outcome, again });
                }
            }
        }
    }

    fn ended(&mut self, number: u64, outcome: Outcome) {
        let place = number / 2;
        let Some(mut open) = self.open.remove(&place) else { return };
        if number.is_multiple_of(2) {
            open.outcome = Some(outcome);
        } else {
            open.again = Some(outcome.evidence);
        }
        self.take_in(place, open);
    }
}
