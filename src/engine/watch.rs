//! Progress that another thread looks at, which draws it in its own way, such as the thread of a notebook.

use std::sync::{Arc, Mutex, PoisonError};

use super::progress_counts::{ProgressCounts, Snapshot};

/// The counters of a computation. A search has several parts, one after another, each with its own counters.
#[derive(Clone, Default)]
pub struct Watch(Arc<Mutex<Vec<WatchedPart>>>);

/// A part of a computation: the last one is in progress, the others have ended.
struct WatchedPart {
    study: String,
    counts: Arc<ProgressCounts>,
}

impl Watch {
    /// Returns the name of the study and the counts of each part, in order; nothing before the computation begins.
    pub fn look(&self) -> Vec<(String, Snapshot)> {
        // A counter is valid whatever happened to the thread that held the lock.
        let parts = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        parts.iter().map(|part| (part.study.clone(), part.counts.snapshot())).collect()
    }

    /// Shows the counters of a part that begins.
    pub(super) fn begin(&self, study: &str, counts: &Arc<ProgressCounts>) {
        let mut parts = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        parts.push(WatchedPart { study: study.to_owned(), counts: Arc::clone(counts) });
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
    use crate::engine::{Parts, Planned, Progress, ProgressDisplay};

    #[test]
    fn each_part_of_a_computation_has_its_own_counters() {
        let watch = Watch::default();
        assert!(watch.look().is_empty());
        let begin = |runs| {
            let planned = Planned { study: "night", runs, at_most: true, parts: Parts::Designs(1) };
            Progress::begin(planned, ProgressDisplay::Watched(watch.clone()))
        };
        let progress = begin(3);
        progress.finished(Label::Equilibrium);
        progress.finished(Label::Failed);
        let first = || watch.look().into_iter().next().unwrap();
        let (study, seen) = first();
        assert_eq!(study, "night");
        assert_eq!((seen.runs, seen.most_runs, seen.at_most), (2, 3, true));
        assert_eq!((seen.equilibria, seen.failed), (1, 1));
        progress.limit(2);
        assert_eq!(first().1.most_runs, 2);
        begin(7);
        let all = watch.look();
        assert_eq!((all[0].1.runs, all[0].1.most_runs), (2, 2));
        assert_eq!((all.len(), all[1].1.runs, all[1].1.most_runs), (2, 0, 7));
    }
}
