//! Progress that another thread looks at, which draws it in its own way, such as the thread of a notebook.

use std::sync::{Arc, Mutex, PoisonError};

use super::progress_counts::ProgressCounts;

/// The counters of a computation. A search has several parts, one after another, each with its own counters.
#[derive(Clone, Default)]
pub struct Watch(Arc<Mutex<Vec<WatchedPart>>>);

/// A part of a computation: the last one is in progress, the others have ended.
struct WatchedPart {
    study: String,
    counts: Arc<ProgressCounts>,
}

/// What the counters say at one moment.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SeenProgress {
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
    /// Returns what the counters of all parts say, in order; nothing before the computation begins.
    pub fn look(&self) -> Vec<SeenProgress> {
        // A counter is valid whatever happened to the thread that held the lock.
        let parts = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let seen = |(part, WatchedPart { study, counts }): (u64, &WatchedPart)| {
            let counts = counts.snapshot();
            SeenProgress {
                part,
                study: study.clone(),
                runs: counts.runs,
                most_runs: counts.most_runs,
                at_most: counts.at_most,
                equilibria: counts.equilibria,
                failed: counts.failed,
            }
        };
        (1..).zip(parts.iter()).map(seen).collect()
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
        assert_eq!(watch.look(), []);
        let begin = |runs| {
            let planned = Planned { study: "night", runs, at_most: true, parts: Parts::Designs(1) };
            Progress::begin(planned, ProgressDisplay::Watched(watch.clone()))
        };
        let progress = begin(3);
        progress.finished(Label::Equilibrium);
        progress.finished(Label::Failed);
        let first = || watch.look().into_iter().next().unwrap();
        let seen = first();
        assert_eq!((seen.part, seen.study.as_str()), (1, "night"));
        assert_eq!((seen.runs, seen.most_runs, seen.at_most), (2, 3, true));
        assert_eq!((seen.equilibria, seen.failed), (1, 1));
        progress.limit(2);
        assert_eq!(first().most_runs, 2);
        begin(7);
        let all = watch.look();
        assert_eq!(all[0], first());
        assert_eq!((all.len(), all[1].part, all[1].runs, all[1].most_runs), (2, 2, 0, 7));
    }
}
