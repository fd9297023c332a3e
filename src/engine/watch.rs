//! Progress that another thread looks at, which draws it in its own way, such as the thread of a notebook.

use std::sync::{Arc, Mutex, PoisonError};

use super::progress_counts::Counts;

/// The counters of the computation in progress. A search has several parts, one after another, each with its own counters.
#[derive(Clone, Default)]
pub struct Watch(Arc<Mutex<Option<Part>>>);

/// The part of a computation that is in progress.
struct Part {
    number: u64,
    study: String,
    counts: Arc<Counts>,
}

/// What the counters say at one moment.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Seen {
    /// The number of the part of the computation, from 1.
    pub part: u64,
    /// The name of the study.
    pub study: String,
    /// The number of finished runs.
    pub runs: u64,
    /// The number of runs of this part, or an upper bound.
    pub most_runs: u64,
    /// Whether `most_runs` is an upper bound.
    pub at_most: bool,
    /// The number of runs at rest.
    pub equilibria: u64,
    /// The number of failed runs.
    pub failed: u64,
}

impl Watch {
    /// Returns what the counters say; `None` before the computation begins.
    pub fn look(&self) -> Option<Seen> {
        let part = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        part.as_ref().map(|Part { number, study, counts }| {
            let counts = counts.snapshot();
            Seen {
                part: *number,
                study: study.clone(),
                runs: counts.runs,
                most_runs: counts.most_runs,
                at_most: counts.at_most,
                equilibria: counts.equilibria,
                failed: counts.failed,
            }
        })
    }

    /// Shows the counters of a part that begins.
    pub(super) fn begin(&self, study: &str, counts: &Arc<Counts>) {
        // A counter is valid whatever happened to the thread that held the lock.
        let mut part = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let number = part.as_ref().map_or(1, |part| part.number + 1);
        *part = Some(Part { number, study: study.to_owned(), counts: Arc::clone(counts) });
    }
}

impl std::fmt::Debug for Watch {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.debug_tuple("Watch").field(&self.look()).finish()
    }
}

#[cfg(test)]
mod tests {
    use super::Watch;
    use crate::classification::Label;
    use crate::engine::{Parts, Planned, Progress, Show};

    #[test]
    fn each_part_of_a_computation_has_its_own_counters() {
        let watch = Watch::default();
        assert_eq!(watch.look(), None);
        let begin = |runs| {
            let planned = Planned { study: "night", runs, at_most: true, parts: Parts::Designs(1) };
            Progress::begin(planned, Show::Watched(watch.clone()))
        };
        let progress = begin(3);
        progress.finished(Label::Equilibrium);
        progress.finished(Label::Failed);
        let seen = watch.look().unwrap();
        assert_eq!((seen.part, seen.study.as_str()), (1, "night"));
        assert_eq!((seen.runs, seen.most_runs, seen.at_most), (2, 3, true));
        assert_eq!((seen.equilibria, seen.failed), (1, 1));
        progress.limit(2);
        assert_eq!(watch.look().map(|seen| seen.most_runs), Some(2));
        begin(7);
        let seen = watch.look().unwrap();
        assert_eq!((seen.part, seen.runs, seen.most_runs), (2, 0, 7));
    }
}
