//! Evaluates designs on all cores and hands their answers on in their order.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::channel;
use std::thread;

use super::search::Search;
use crate::classification::Label;
use crate::responses::{Answer, respond};
use crate::study::{DesignValue, Study};

/// Number of runs per thread that keeps all threads busy. Designs with fewer runs are evaluated at the same time.
const RUNS_PER_THREAD: u64 = 512;

/// A design to evaluate: its number, its values, and the study with these values.
pub(super) type Numbered<'a> = (u64, &'a [DesignValue], &'a Study);

/// Evaluates designs and calls `each` with the index and the answers of each one, in order. Several designs are
/// evaluated at the same time if one has too few runs for all threads. Returns false if the search was stopped before
/// all designs were evaluated.
///
/// # Errors
/// Returns the first error of `each`; no further design is begun after it.
pub(super) fn evaluate_in_order<E>(
    search: &Search,
    designs: &[Numbered],
    finished: &(dyn Fn(Label) + Sync),
    mut each: impl FnMut(usize, Vec<Answer>) -> Result<(), E>,
) -> Result<bool, E> {
    let Search { study, workers, stop, .. } = *search;
    let runs = designs.iter().map(|(_, _, set)| set.run_count()).max().unwrap_or(1).max(1);
    let threads = workers.threads();
    let enough = (RUNS_PER_THREAD * threads as u64).div_ceil(runs);
    let at_once = usize::try_from(enough).unwrap_or(threads).clamp(1, threads);
    let (next, failed) = (AtomicUsize::new(0), AtomicBool::new(false));
    let (sender, receiver) = channel();
    let evaluate = |sender: std::sync::mpsc::Sender<(usize, Vec<Answer>)>| {
        while !failed.load(Ordering::Relaxed) {
            let index = next.fetch_add(1, Ordering::Relaxed);
            let Some((number, values, set)) = designs.get(index) else { return };
            let one = std::slice::from_ref(*set);
            let answers =
                respond(workers, one, study.responses(), (*number, *values), stop, finished);
            // Without a receiver, or stopped: the others learn of it, too.
            let Some(answers) = answers else { return };
            if sender.send((index, answers)).is_err() {
                return;
            }
        }
    };
    thread::scope(|scope| {
        for _ in 0..at_once {
            let (sender, evaluate) = (sender.clone(), &evaluate);
            scope.spawn(move || evaluate(sender));
        }
        drop(sender);
        let mut waiting = BTreeMap::new();
        let mut expected = 0;
        for (index, answers) in receiver {
            waiting.insert(index, answers);
            while let Some(answers) = waiting.remove(&expected) {
                each(expected, answers).inspect_err(|_| failed.store(true, Ordering::Relaxed))?;
                expected += 1;
            }
        }
        Ok(expected == designs.len())
    })
}
