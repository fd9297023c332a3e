//! Progress of a computation on standard error: number of runs, rate, remaining time, and endings so far.
//!
//! Workers update a few atomic counters; text is produced only when a line is due.

use std::io::{self, IsTerminal, Write};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};
use serde_json::{Value, json};

use crate::analysis::{Z_95, wilson_with_failures};
use crate::classification::Label;
use crate::sanitize::{harmless, harmless_json};

/// How progress is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Show {
    /// A bar, if standard error is a terminal.
    Bar,
    /// A line every ten seconds.
    Lines,
    /// An event every second, as a line of JSON.
    Json,
    /// Nothing.
    Nothing,
}

impl Show {
    /// Returns a bar on a terminal, lines elsewhere.
    pub fn auto() -> Self {
        if io::stderr().is_terminal() { Show::Bar } else { Show::Lines }
    }

    /// Returns the seconds between two lines.
    fn every(self) -> u64 {
        if self == Show::Json { 1 } else { 10 }
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
    /// Number of points.
    pub points: u64,
}

/// Progress over the runs of a study.
pub struct Progress {
    show: Show,
    bar: ProgressBar,
    counts: Arc<Counts>,
    points: Mutex<PointLines>,
}

struct Counts {
    started: Instant,
    planned: AtomicU64,
    /// Words before the number of planned runs and the remaining time.
    bound: &'static str,
    runs: AtomicU64,
    equilibria: AtomicU64,
    failed: AtomicU64,
    /// Runs that were already on disk.
    found: AtomicU64,
    /// Seconds since the start at which the next line is due.
    next_line: AtomicU64,
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

/// A snapshot of the counters.
#[derive(Clone, Copy)]
struct Now {
    elapsed_s: f64,
    planned: u64,
    runs: u64,
    found: u64,
    equilibria: u64,
    failed: u64,
}

impl Counts {
    fn now(&self) -> Now {
        let read = |count: &AtomicU64| count.load(Ordering::Relaxed);
        // Parts are read before the total, so that no part exceeds it.
        let (equilibria, failed) = (read(&self.equilibria), read(&self.failed));
        let (found, runs) = (read(&self.found), read(&self.runs));
        let elapsed_s = self.started.elapsed().as_secs_f64();
        Now { elapsed_s, planned: read(&self.planned), runs, found, equilibria, failed }
    }
}

impl Now {
    /// Returns the rate of computed runs per second, without those that were on disk.
    fn rate(&self) -> f64 {
        self.runs.saturating_sub(self.found) as f64 / self.elapsed_s.max(1e-9)
    }

    /// Returns the estimated remaining seconds; `None` if nothing has been computed yet.
    fn left_s(&self) -> Option<f64> {
        let left = self.planned.saturating_sub(self.runs) as f64 / self.rate();
        Duration::try_from_secs_f64(left).ok().map(|left| left.as_secs_f64())
    }

    /// Returns the fraction of equilibria with its 95 % interval.
    fn fraction(&self) -> Option<(f64, (f64, f64))> {
        let fraction = self.equilibria as f64 / self.runs as f64;
        let ends = wilson_with_failures(self.equilibria, self.failed, self.runs, Z_95);
        (self.runs > 0).then_some((fraction, ends))
    }

    fn fraction_text(&self) -> String {
        self.fraction().map_or_else(
            || "-".to_owned(),
            |(fraction, (low, high))| format!("{fraction:.3} ({low:.3} .. {high:.3})"),
        )
    }

    /// Returns the number of failed runs after a separator; empty if there are none.
    fn failed_text(&self, separator: &str) -> String {
        if self.failed > 0 { format!("{separator}{} failed", self.failed) } else { String::new() }
    }

    fn event(&self, event: &str) -> Value {
        let fraction = self.fraction();
        json!({
            "event": event,
            "elapsed_s": self.elapsed_s,
            "runs_finished": self.runs,
            "runs_planned": self.planned,
            "runs_kept": self.found,
            "runs_per_s": self.rate(),
            "left_s": self.left_s(),
            "equilibrium_fraction": fraction.map(|(fraction, _)| fraction),
            "ci_low": fraction.map(|(_, (low, _))| low),
            "ci_high": fraction.map(|(_, (_, high))| high),
            "failed_runs": self.failed,
        })
    }
}

/// Writes a message to standard error, without terminal control characters. Ignores write errors, such as from a
/// closed terminal, so that the computation continues; `eprintln` would panic.
pub fn say(message: &str) {
    write_line(&harmless(message).replace('\t', " "));
}

/// Writes a JSON event to standard error.
fn say_json(event: &Value) {
    write_line(&harmless_json(&event.to_string()));
}

fn write_line(line: &str) {
    // A single write keeps the lines of several threads apart.
    let _ = io::stderr().lock().write_all(format!("{line}\n").as_bytes());
}

impl Progress {
    /// Starts progress over `planned` runs of one point, shown as standard error allows.
    pub fn new(planned: u64, quiet: bool) -> Self {
        let planned = Planned { study: "", runs: planned, at_most: false, points: 1 };
        Self::begin(planned, if quiet { Show::Nothing } else { Show::auto() })
    }

    /// Starts progress over the planned computation.
    pub fn begin(planned: Planned<'_>, show: Show) -> Self {
        let Planned { study, runs, at_most, points } = planned;
        let counts = Arc::new(Counts {
            started: Instant::now(),
            planned: runs.into(),
            bound: if at_most { "at most " } else { "" },
            runs: 0.into(),
            equilibria: 0.into(),
            failed: 0.into(),
            found: 0.into(),
            next_line: show.every().into(),
        });
        if show == Show::Json {
            let begun = json!({
                "event": "begun",
                "elapsed_s": 0.0,
                "study": study,
                "runs_planned": runs,
                "runs_are_at_most": at_most,
                "points_planned": points,
            });
            say_json(&begun);
        }
        let bar = match show {
            Show::Bar => bar(runs, at_most, &counts),
            _ => ProgressBar::hidden(),
        };
        let points = PointLines { many: points > FEW_POINTS, last: None, left_out: 0 };
        Progress { show, bar, counts, points: Mutex::new(points) }
    }

    /// Sets the number of planned runs.
    pub fn expect(&self, planned: u64) {
        if self.counts.planned.swap(planned, Ordering::Relaxed) != planned {
            self.bar.set_length(planned);
        }
    }

    /// Counts a run that was already on disk.
    pub fn found(&self, label: Label) {
        self.counts.found.fetch_add(1, Ordering::Relaxed);
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
        match self.show {
            Show::Bar => self.bar.inc(1),
            Show::Lines | Show::Json => self.line_if_due(),
            Show::Nothing => {}
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
        let now = self.counts.now();
        if self.show == Show::Json {
            say_json(&now.event("progress"));
            return;
        }
        let left = now.left_s().map_or_else(|| "?".to_owned(), |left| format!("{left:.0}"));
        let bound = self.counts.bound;
        let about = if bound.is_empty() { "about " } else { bound };
        say(&format!(
            "{} of {bound}{} runs, {:.0} runs/s, equilibria {}{}, {about}{left} s left",
            now.runs,
            now.planned,
            now.rate(),
            now.fraction_text(),
            now.failed_text(", "),
        ));
    }

    /// Reports a point whose runs have all finished: `text` is a line of text, `facts` are the fields of an event.
    pub fn point(&self, text: impl FnOnce() -> String, facts: impl FnOnce() -> Value) {
        match self.show {
            Show::Nothing => {}
            Show::Json => {
                let elapsed_s = self.counts.started.elapsed().as_secs_f64();
                let mut event = json!({"event": "point", "elapsed_s": elapsed_s});
                if let (Value::Object(event), Value::Object(facts)) = (&mut event, facts()) {
                    event.extend(facts);
                }
                say_json(&event);
            }
            Show::Bar | Show::Lines => {
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
                    left_out => format!(" ({left_out} earlier points not shown)"),
                };
                self.line(&format!("{}{before}", text()));
            }
        }
    }

    /// Writes a line, above the bar if there is one.
    fn line(&self, line: &str) {
        match self.show {
            Show::Bar => self.bar.println(harmless(line)),
            _ => say(line),
        }
    }

    /// Removes the bar and returns the elapsed time.
    pub fn close(&self) -> Duration {
        let left_out = self.points.lock().unwrap_or_else(PoisonError::into_inner).left_out;
        if left_out > 0 {
            self.line(&format!("{left_out} more points finished"));
        }
        self.bar.finish_and_clear();
        self.counts.started.elapsed()
    }

    /// Writes the final event: all planned runs have finished, or the computation was `interrupted`.
    pub fn ended(&self, interrupted: bool) {
        if self.show == Show::Json {
            let mut event = self.counts.now().event("ended");
            event["interrupted"] = interrupted.into();
            say_json(&event);
        }
    }
}

fn bar(planned: u64, at_most: bool, counts: &Arc<Counts>) -> ProgressBar {
    let target = ProgressDrawTarget::stderr_with_hz(10);
    let bar = ProgressBar::with_draw_target(Some(planned), target);
    let sign = if at_most { "≤" } else { "" };
    let template = format!(
        "{{wide_bar}} {{human_pos}}/{sign}{{human_len}} runs  {{rate}}/s  equilibria \
         {{fraction}}{{failed}}  {sign}{{left}} left"
    );
    let key = |text: fn(Now) -> String| {
        let counts = Arc::clone(counts);
        move |_: &ProgressState, out: &mut dyn std::fmt::Write| {
            // A bar that cannot be drawn is ignored.
            let _ = out.write_str(&text(counts.now()));
        }
    };
    if let Ok(style) = ProgressStyle::with_template(&template) {
        bar.set_style(
            style
                .with_key("rate", key(|now| format!("{:.0}", now.rate())))
                .with_key("fraction", key(|now| now.fraction_text()))
                .with_key("failed", key(|now| now.failed_text("  ")))
                .with_key("left", key(|now| time_text(now.left_s()))),
        );
    }
    bar
}

/// Returns a time in words.
fn time_text(seconds: Option<f64>) -> String {
    // A cast from a floating-point number saturates.
    match seconds.map(|seconds| seconds.ceil() as u64) {
        None => "?".to_owned(),
        Some(seconds @ 0..120) => format!("{seconds} s"),
        Some(seconds @ 120..7200) => format!("{} min", seconds.div_ceil(60)),
        Some(seconds) => format!("{} h", seconds.div_ceil(3600)),
    }
}

#[cfg(test)]
mod tests {
    use super::{Now, time_text};
    use crate::analysis::{Z_95, wilson};

    #[test]
    fn what_is_computed_of_the_counts() {
        let now = Now {
            elapsed_s: 10.0,
            planned: 1000,
            runs: 300,
            found: 100,
            equilibria: 150,
            failed: 0,
        };
        assert_eq!((now.rate(), now.left_s()), (20.0, Some(35.0)));
        assert_eq!(now.fraction(), Some((0.5, wilson(150, 300, Z_95))));
        assert_eq!(now.failed_text(", "), "");
        // Failed runs widen the interval upwards only.
        let failed = Now { failed: 30, ..now };
        let ends = (wilson(150, 300, Z_95).0, wilson(180, 300, Z_95).1);
        assert_eq!(failed.fraction(), Some((0.5, ends)));
        assert_eq!(failed.failed_text(", "), ", 30 failed");
        // Before the first computed run the rate and the remaining time are unknown.
        let begun = Now { runs: 0, found: 0, equilibria: 0, ..now };
        assert_eq!(
            (begun.fraction(), begun.left_s(), begun.fraction_text()),
            (None, None, "-".into())
        );
        assert_eq!(Now { found: 300, ..now }.left_s(), None);
        assert_eq!(begun.event("progress")["left_s"], serde_json::Value::Null);
    }

    #[test]
    fn times() {
        for (seconds, text) in
            [(0.0, "0 s"), (119.0, "119 s"), (119.5, "2 min"), (7140.0, "119 min"), (7201.0, "3 h")]
        {
            assert_eq!(time_text(Some(seconds)), text);
        }
        assert_eq!(time_text(None), "?");
    }
}
