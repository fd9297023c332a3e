//! Progress of a computation, in messages or as a bar on standard error: number of runs, rate, remaining time, and finished
//! points.
//!
//! Workers update a few atomic counters; text is produced only when a line is due.

use std::io::{self, IsTerminal};
use std::sync::atomic::Ordering;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};
use serde_json::{Value, json};

use super::message::{say, say_json};
use super::progress_counts::{Parts, ProgressCounts, Watch};
use crate::classification::Label;
use crate::sanitize::harmless;

/// How progress is shown.
#[derive(Clone, Debug)]
pub enum ProgressDisplay {
    /// A bar, if standard error is a terminal.
    Bar,
    /// A line every ten seconds.
    Lines,
    /// An event every second, as a line of JSON.
    Json,
    /// Nothing here; another thread looks at the counters, such as that of a notebook.
    Watched(Watch),
    /// Nothing.
    Nothing,
}

impl ProgressDisplay {
    /// Returns a bar on a terminal, lines elsewhere.
    pub fn auto() -> Self {
        if io::stderr().is_terminal() { ProgressDisplay::Bar } else { ProgressDisplay::Lines }
    }

    /// Returns the seconds between two lines.
    fn every(&self) -> u64 {
        if matches!(self, ProgressDisplay::Json) { 1 } else { 10 }
    }
}

/// The planned computation.
#[derive(Clone, Copy, Debug)]
pub struct Planned<'a> {
    /// Name of the study.
    pub study: &'a str,
    /// Number of runs.
    pub runs: u64,
    /// Whether `runs` is an upper bound.
    pub at_most: bool,
    /// The groups of runs.
    pub parts: Parts,
}

/// Progress over the runs of a study.
pub struct Progress {
    show: ProgressDisplay,
    /// Number of planned runs; if `at_most`, an upper bound.
    planned: u64,
    bar: ProgressBar,
    counts: Arc<ProgressCounts>,
    points: Mutex<PointLines>,
}

/// State of the lines about points, which are rate-limited when there are many points.
struct PointLines {
    /// Whether the lines are rate-limited.
    many: bool,
    /// Time of the last line.
    last: Option<Instant>,
    left_out: u64,
}

/// The largest number of points that each get a line.
const FEW_POINTS: u64 = 40;
/// The least time between lines of more points.
const LINES_APART: Duration = Duration::from_secs(1);

impl Progress {
    /// Starts progress over `planned` runs of one point, shown as standard error allows.
    pub fn new(planned: u64, quiet: bool) -> Self {
        let planned = Planned { study: "", runs: planned, at_most: false, parts: Parts::Points(1) };
        Self::begin(planned, if quiet { ProgressDisplay::Nothing } else { ProgressDisplay::auto() })
    }

    /// Starts progress over the planned computation.
    pub fn begin(planned: Planned<'_>, show: ProgressDisplay) -> Self {
        let Planned { study, runs, at_most, parts } = planned;
        let counts = Arc::new(ProgressCounts {
            started: Instant::now(),
            most_runs: runs.into(),
            at_most,
            runs: 0.into(),
            equilibria: 0.into(),
            failed: 0.into(),
            parts,
            parts_finished: 0.into(),
            reused: 0.into(),
            next_line: show.every().into(),
        });
        if let ProgressDisplay::Watched(watch) = &show {
            watch.begin(study, &counts);
        }
        if matches!(show, ProgressDisplay::Json) {
            let begun = json!({
                "event": "begun",
                "elapsed_s": 0.0,
                "study": study,
                "runs_planned": runs,
                "runs_are_at_most": at_most,
                "points_planned": parts.count(),
            });
            say_json(&begun);
        }
        let bar = match &show {
            ProgressDisplay::Bar => bar(runs, &counts),
            _ => ProgressBar::hidden(),
        };
        let points = PointLines { many: parts.count() > FEW_POINTS, last: None, left_out: 0 };
        Progress { show, planned: runs, bar, counts, points: Mutex::new(points) }
    }

    /// Shows progress while `work` computes `planned`; `work` calls its argument for each finished run and returns `None`
    /// if it was interrupted.
    pub fn during<T>(
        planned: Planned<'_>,
        show: ProgressDisplay,
        work: impl FnOnce(&(dyn Fn(Label) + Sync)) -> Option<T>,
    ) -> Option<T> {
        let progress = Self::begin(planned, show);
        let result = work(&|label| progress.finished(label));
        progress.close();
        progress.ended(result.is_none());
        result
    }

    /// Redraws the bar also while no run finishes, so that it shows that the program works.
    pub fn keep_drawing(&self) {
        if matches!(self.show, ProgressDisplay::Bar) {
            self.bar.enable_steady_tick(Duration::from_millis(100));
        }
    }

    /// Sets the upper bound of the number of runs from what is known so far.
    pub fn limit(&self, most_runs: u64) {
        if self.counts.most_runs.swap(most_runs, Ordering::Relaxed) != most_runs {
            self.bar.set_length(most_runs);
        }
    }

    /// Counts a run that was already on disk.
    pub fn reused(&self, label: Label) {
        self.counts.reused.fetch_add(1, Ordering::Relaxed);
        self.finished(label);
    }

    /// Counts a finished run.
    pub fn finished(&self, label: Label) {
        self.counts.runs.fetch_add(1, Ordering::Relaxed);
        match label {
            Label::Equilibrium => self.counts.equilibria.fetch_add(1, Ordering::Relaxed),
            Label::Failed => self.counts.failed.fetch_add(1, Ordering::Relaxed),
            _ => 0,
        };
        match &self.show {
            ProgressDisplay::Bar => self.bar.inc(1),
            ProgressDisplay::Lines | ProgressDisplay::Json => self.line_if_due(),
            ProgressDisplay::Watched(_) | ProgressDisplay::Nothing => {}
        }
    }

    fn line_if_due(&self) {
        let elapsed = self.counts.started.elapsed().as_secs();
        let due = self.counts.next_line.load(Ordering::Relaxed);
        let claim = || {
            let (next, order) = (elapsed + self.show.every(), Ordering::Relaxed);
            self.counts.next_line.compare_exchange(due, next, order, order)
        };
        if elapsed < due || claim().is_err() {
            return;
        }
        let counts = self.counts.snapshot();
        match &self.show {
            ProgressDisplay::Json => say_json(&counts.event("progress", self.planned)),
            _ => say(&counts.text()),
        }
    }

    /// Reports a point whose runs have all finished: `text` is a line of text, `facts` are the fields of an event.
    pub fn point(&self, text: impl FnOnce() -> String, facts: impl FnOnce() -> Value) {
        self.counts.parts_finished.fetch_add(1, Ordering::Relaxed);
        match &self.show {
            ProgressDisplay::Watched(_) | ProgressDisplay::Nothing => {}
            ProgressDisplay::Json => {
                let elapsed_s = self.counts.started.elapsed().as_secs_f64();
                let mut event = json!({"event": "point", "elapsed_s": elapsed_s});
                if let (Value::Object(event), Value::Object(facts)) = (&mut event, facts()) {
                    event.extend(facts);
                }
                say_json(&event);
            }
            ProgressDisplay::Bar | ProgressDisplay::Lines => {
                // Counters and times stay usable after a panic of another thread.
                let mut lines = self.points.lock().unwrap_or_else(PoisonError::into_inner);
                let now = Instant::now();
                let soon = lines.last.is_some_and(|last| now.duration_since(last) < LINES_APART);
                if lines.many && soon {
                    lines.left_out += 1;
                    return;
                }
                lines.last = Some(now);
                let before = match std::mem::take(&mut lines.left_out) {
                    0 => String::new(),
                    left_out => {
                        format!(" ({left_out} earlier {} not shown)", self.counts.parts.name())
                    }
                };
                self.line(&format!("{}{before}", text()));
            }
        }
    }

    /// Writes a line, above the bar if there is one.
    fn line(&self, line: &str) {
        match &self.show {
            ProgressDisplay::Bar => self.bar.println(harmless(line)),
            _ => say(line),
        }
    }

    /// Removes the bar and returns the elapsed time.
    pub fn close(&self) -> Duration {
        let left_out = self.points.lock().unwrap_or_else(PoisonError::into_inner).left_out;
        if left_out > 0 {
            self.line(&format!("{left_out} more {} finished", self.counts.parts.name()));
        }
        self.bar.finish_and_clear();
        self.counts.started.elapsed()
    }

    /// Writes the final event: all planned runs have finished, or the computation was `interrupted`.
    pub fn ended(&self, interrupted: bool) {
        if matches!(self.show, ProgressDisplay::Json) {
            let mut event = self.counts.snapshot().event("ended", self.planned);
            event["interrupted"] = interrupted.into();
            say_json(&event);
        }
    }
}

fn bar(runs: u64, counts: &Arc<ProgressCounts>) -> ProgressBar {
    let bar = ProgressBar::with_draw_target(Some(runs), ProgressDrawTarget::stderr_with_hz(10));
    let counts = Arc::clone(counts);
    let text = move |_: &ProgressState, out: &mut dyn std::fmt::Write| {
        // A bar that cannot be drawn is ignored.
        let _ = out.write_str(&counts.snapshot().text());
    };
    if let Ok(style) = ProgressStyle::with_template("{wide_bar} {text}") {
        bar.set_style(style.with_key("text", text));
    }
    bar
}
