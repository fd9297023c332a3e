//! The counters of a computation, what progress reports about them, and a watch, through which another thread looks at them,
//! which draws them in its own way, such as the thread of a notebook.

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use indicatif::HumanDuration;
use serde_json::{Value, json};

use crate::analysis::{Z_95, wilson_with_failures};

/// Groups of runs that progress counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Parts {
    /// A number of points of one sweep. The runs of a single point have a common fraction of equilibria.
    Points(u64),
    /// A number of designs, which differ, so that their runs have no common fraction.
    Designs(u64),
    /// A number of parameter sets, which differ like designs.
    ParameterSets(u64),
}

impl Parts {
    /// Returns the number of parts.
    pub fn count(self) -> u64 {
        match self {
            Parts::Points(count) | Parts::Designs(count) | Parts::ParameterSets(count) => count,
        }
    }

    /// Returns the word for the groups.
    pub(super) fn name(self) -> &'static str {
        match self {
            Parts::Points(_) => "points",
            Parts::Designs(_) => "designs",
            Parts::ParameterSets(_) => "parameter sets",
        }
    }
}

/// Counters that workers update.
pub(super) struct ProgressCounts {
    pub started: Instant,
    /// Upper bound of the number of runs from what is known so far.
    pub most_runs: AtomicU64,
    /// Whether `most_runs` may decrease.
    pub at_most: bool,
    pub runs: AtomicU64,
    pub equilibria: AtomicU64,
    pub failed: AtomicU64,
    pub parts: Parts,
    pub parts_finished: AtomicU64,
    /// Runs that were already on disk.
    pub reused: AtomicU64,
    /// Seconds since the start at which the next line is due.
    pub next_line: AtomicU64,
}

/// What the counters say at one moment.
#[derive(Clone, Copy, Debug)]
pub struct Snapshot {
    /// The time since the start, s.
    pub elapsed_s: f64,
    /// The number of runs of this part of the computation, or an upper bound.
    pub most_runs: u64,
    /// Whether `most_runs` is an upper bound.
    pub at_most: bool,
    /// The number of finished runs.
    pub runs: u64,
    /// The number of runs that were already on disk.
    pub reused: u64,
    /// The number of runs at rest.
    pub equilibria: u64,
    /// The number of failed runs.
    pub failed: u64,
    /// The groups of runs.
    pub parts: Parts,
    /// The number of finished groups.
    pub parts_finished: u64,
}

impl ProgressCounts {
    pub(super) fn snapshot(&self) -> Snapshot {
        let read = |count: &AtomicU64| count.load(Ordering::Relaxed);
        // Parts are read before the total, so that no part exceeds it.
        let [equilibria, failed, reused] = [&self.equilibria, &self.failed, &self.reused].map(read);
        Snapshot {
            elapsed_s: self.started.elapsed().as_secs_f64(),
            most_runs: read(&self.most_runs),
            at_most: self.at_most,
            runs: read(&self.runs),
            reused,
            equilibria,
            failed,
            parts: self.parts,
            parts_finished: read(&self.parts_finished),
        }
    }
}

impl Snapshot {
    /// Returns the rate of computed runs per second, without those that were on disk.
    pub(super) fn rate(&self) -> f64 {
        self.runs.saturating_sub(self.reused) as f64 / self.elapsed_s.max(1e-9)
    }

    fn runs_left(&self) -> u64 {
        self.most_runs.saturating_sub(self.runs)
    }

    /// Returns the estimated remaining time; `None` if nothing has been computed yet.
    pub(super) fn left(&self) -> Option<Duration> {
        Duration::try_from_secs_f64(self.runs_left() as f64 / self.rate()).ok()
    }

    /// Returns the fraction of equilibria with its 95 % interval.
    pub(super) fn fraction(&self) -> Option<(f64, (f64, f64))> {
        let fraction = self.equilibria as f64 / self.runs as f64;
        let ends = wilson_with_failures(self.equilibria, self.failed, self.runs, Z_95);
        (self.runs > 0).then_some((fraction, ends))
    }

    /// Returns the counts as one line of text, for the bar and for lines. The fraction of
    /// equilibria is that of a single point; runs of different points have no common one.
    pub(super) fn text(&self) -> String {
        let Snapshot { runs, most_runs, failed, .. } = self;
        let bound = if self.at_most { "at most " } else { "" };
        let mut parts = vec![format!("{runs} of {bound}{most_runs} runs")];
        if self.runs > self.reused {
            parts.push(format!("{:.0}/s", self.rate()));
        }
        if self.parts_finished > 0 {
            let (count, name) = (self.parts.count(), self.parts.name());
            parts.push(format!("{} of {count} {name}", self.parts_finished));
        }
        if let Some((fraction, (low, high))) =
            self.fraction().filter(|_| self.parts == Parts::Points(1))
        {
            let [fraction, low, high] = [fraction, low, high].map(|fraction| 100.0 * fraction);
            parts.push(format!("{fraction:.1} % at rest ({low:.1} .. {high:.1} %)"));
        }
        if *failed > 0 {
            parts.push(format!("{failed} failed"));
        }
        parts.extend(self.left().map(|left| format!("{bound}{:#} left", HumanDuration(left))));
        parts.join(", ")
    }

    /// Returns an event; `planned` is the number of runs that were planned at the start.
    pub(super) fn event(&self, event: &str, planned: u64) -> Value {
        let fraction = self.fraction();
        json!({
            "event": event,
            "elapsed_s": self.elapsed_s,
            "runs_finished": self.runs,
            "runs_planned": planned,
            "runs_left_at_most": self.runs_left(),
            "runs_kept": self.reused,
            "runs_per_s": self.rate(),
            "left_s": self.left().map(|left| left.as_secs_f64()),
            "equilibrium_fraction": fraction.map(|(fraction, _)| fraction),
            "ci_low": fraction.map(|(_, (low, _))| low),
            "ci_high": fraction.map(|(_, (_, high))| high),
            "failed_runs": self.failed,
        })
    }
}

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
    use std::time::Duration;

    use super::{Parts, Snapshot, Watch};
    use crate::analysis::{Z_95, wilson};
    use crate::classification::Label;
    use crate::engine::{Planned, Progress, ProgressDisplay};

    #[test]
    fn what_is_computed_of_the_counts() {
        let counts = Snapshot {
            elapsed_s: 10.0,
            most_runs: 1000,
            at_most: false,
            runs: 300,
            reused: 100,
            equilibria: 150,
            failed: 0,
            parts: Parts::Points(1),
            parts_finished: 0,
        };
        assert_eq!((counts.rate(), counts.left()), (20.0, Some(Duration::from_secs(35))));
        assert_eq!(counts.fraction(), Some((0.5, wilson(150, 300, Z_95))));
        assert_eq!(
            counts.text(),
            "300 of 1000 runs, 20/s, 50.0 % at rest (44.4 .. 55.6 %), 35s left"
        );
        // The share of several points together says nothing.
        let sweep = Snapshot { parts: Parts::Points(6), parts_finished: 2, ..counts };
        assert_eq!(sweep.text(), "300 of 1000 runs, 20/s, 2 of 6 points, 35s left");
        let search = Snapshot { parts: Parts::Designs(1), parts_finished: 1, ..counts };
        assert_eq!(search.text(), "300 of 1000 runs, 20/s, 1 of 1 designs, 35s left");
        let sets = Snapshot { parts: Parts::ParameterSets(160), parts_finished: 24, ..counts };
        assert!(sets.text().contains(", 24 of 160 parameter sets, "), "{}", sets.text());
        // Failed runs widen the interval upwards only.
        let failed = Snapshot { failed: 30, at_most: true, ..counts };
        let ends = (wilson(150, 300, Z_95).0, wilson(180, 300, Z_95).1);
        assert_eq!(failed.fraction(), Some((0.5, ends)));
        let text = failed.text();
        assert!(text.starts_with("300 of at most 1000 runs, ") && text.contains(", 30 failed, "));
        assert!(text.ends_with("at most 35s left"));
        // Before the first computed run the rate and the remaining time are unknown.
        let begun = Snapshot { runs: 0, reused: 0, equilibria: 0, ..counts };
        assert_eq!((begun.fraction(), begun.left()), (None, None));
        assert_eq!(begun.text(), "0 of 1000 runs");
        let reused = Snapshot { reused: 300, ..counts };
        assert!(reused.left().is_none() && !reused.text().contains("/s"));
        // The planned number of runs stays when the bound decreases.
        let event = Snapshot { most_runs: 900, ..begun }.event("progress", 1000);
        assert_eq!(
            (&event["runs_planned"], &event["runs_left_at_most"]),
            (&1000.into(), &900.into())
        );
        assert_eq!(event["left_s"], serde_json::Value::Null);
    }

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
        let first = || watch.look().into_iter().next().expect("a display watches one part");
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
