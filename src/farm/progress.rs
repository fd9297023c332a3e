//! Progress while runs are computed: how many, how fast, until when, and how they end so far.

use std::io::{self, IsTerminal, Write};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};

use crate::ending::Label;

/// A progress bar on a terminal; a line now and then elsewhere; nothing when told to be quiet.
/// All of it goes to stderr.
pub struct Progress {
    bar: ProgressBar,
    lines: bool,
    planned: AtomicU64,
    /// What stands before the number of planned runs and before the time left.
    bound: &'static str,
    started: Instant,
    counts: Arc<Counts>,
}

#[derive(Default)]
struct Counts {
    runs: AtomicU64,
    equilibria: AtomicU64,
    /// Runs that were finished before.
    found: AtomicU64,
    /// Seconds after which the next line is due.
    next_line: AtomicU64,
}

impl Counts {
    fn fraction(&self) -> String {
        match self.runs.load(Ordering::Relaxed) {
            0 => "-".to_owned(),
            runs => {
                let equilibria = self.equilibria.load(Ordering::Relaxed) as f64;
                format!("{:.3}", equilibria / runs as f64)
            }
        }
    }
}

/// Writes a line to standard error. Where nobody can read it any more (a terminal that was closed, a
/// reader that has gone) it is lost, and the runs are not: `eprintln` would end the program.
pub fn say(line: &str) {
    let _ = writeln!(io::stderr().lock(), "{line}");
}

/// Seconds between lines where there is no terminal.
const LINE_EVERY: u64 = 10;

impl Progress {
    /// Progress over `planned` runs.
    pub fn new(planned: u64, quiet: bool) -> Self {
        Self::with_bound(planned, quiet, "")
    }

    /// Progress over so many runs at most.
    pub fn at_most(planned: u64, quiet: bool) -> Self {
        Self::with_bound(planned, quiet, "at most ")
    }

    fn with_bound(planned: u64, quiet: bool, bound: &'static str) -> Self {
        let terminal = std::io::stderr().is_terminal();
        let counts = Arc::new(Counts::default());
        counts.next_line.store(LINE_EVERY, Ordering::Relaxed);
        let target = if terminal && !quiet {
            ProgressDrawTarget::stderr_with_hz(10)
        } else {
            ProgressDrawTarget::hidden()
        };
        let bar = ProgressBar::with_draw_target(Some(planned), target);
        let sign = if bound.is_empty() { "" } else { "≤" };
        let template = format!(
            "{{bar:32}} {{human_pos}}/{sign}{{human_len}} runs  {{runs_per_s}}  \
             equilibria {{fraction}}  {sign}{{eta}} left"
        );
        let for_fraction = Arc::clone(&counts);
        if let Ok(style) = ProgressStyle::with_template(&template) {
            bar.set_style(
                style
                    .with_key(
                        "fraction",
                        move |_: &ProgressState, out: &mut dyn std::fmt::Write| {
                            // Nobody can do anything about a bar that cannot be drawn.
                            let _ = out.write_str(&for_fraction.fraction());
                        },
                    )
                    .with_key(
                        "runs_per_s",
                        |state: &ProgressState, out: &mut dyn std::fmt::Write| {
                            let _ = write!(out, "{:.0}/s", state.per_sec());
                        },
                    ),
            );
        }
        Progress {
            bar,
            lines: !terminal && !quiet,
            planned: planned.into(),
            bound,
            started: Instant::now(),
            counts,
        }
    }

    /// Corrects the number of planned runs.
    pub fn expect(&self, planned: u64) {
        if self.planned.swap(planned, Ordering::Relaxed) != planned {
            self.bar.set_length(planned);
        }
    }

    /// Counts a run that was finished before.
    pub fn found(&self, label: Label) {
        self.counts.found.fetch_add(1, Ordering::Relaxed);
        self.finished(label);
    }

    /// Counts a finished run.
    pub fn finished(&self, label: Label) {
        let runs = self.counts.runs.fetch_add(1, Ordering::Relaxed) + 1;
        if label == Label::Equilibrium {
            self.counts.equilibria.fetch_add(1, Ordering::Relaxed);
        }
        self.bar.inc(1);
        if self.lines {
            self.line_if_due(runs);
        }
    }

    fn line_if_due(&self, runs: u64) {
        let elapsed = self.started.elapsed();
        let due = self.counts.next_line.load(Ordering::Relaxed);
        let next = elapsed.as_secs() + LINE_EVERY;
        let claim = |counts: &Counts| {
            counts.next_line.compare_exchange(due, next, Ordering::Relaxed, Ordering::Relaxed)
        };
        if elapsed.as_secs() < due || claim(&self.counts).is_err() {
            return;
        }
        let found = self.counts.found.load(Ordering::Relaxed);
        let rate = runs.saturating_sub(found) as f64 / elapsed.as_secs_f64();
        let planned = self.planned.load(Ordering::Relaxed);
        // Where nothing has been computed yet, nothing is known.
        let left = Duration::try_from_secs_f64(planned.saturating_sub(runs) as f64 / rate);
        let left = left.map_or_else(|_| "?".to_owned(), |left| left.as_secs().to_string());
        let bound = self.bound;
        let about = if bound.is_empty() { "about " } else { bound };
        say(&format!(
            "{runs} of {bound}{planned} runs, {rate:.0} runs/s, equilibria {}, {about}{left} s left",
            self.counts.fraction(),
        ));
    }

    /// Takes the bar away and returns how long it all took.
    pub fn close(&self) -> Duration {
        self.bar.finish_and_clear();
        self.started.elapsed()
    }
}
