//! Command-line arguments that several commands share.

use std::fmt::Display;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::time::{Duration, Instant};

use clap::{Args, ValueEnum};

use super::output::CliError;
use crate::check::warnings;
use crate::engine::{EngineOptions, ProgressDisplay, Shard, WorkerPool, say};
use crate::study::{Study, StudyError};

/// The study file argument, with the directories in which its tables may lie.
#[derive(Clone, Debug, Args)]
pub struct StudyArgument {
    /// Study file, YAML (`stickslip schema` describes it)
    #[arg(value_name = "STUDY")]
    pub study: PathBuf,

    /// Also allow table files in this directory; may be repeated
    ///
    /// A `table:` path that leads out of the study file's directory is an error unless its directory is named
    /// here. The option only grants access; paths remain relative to the study file.
    #[arg(long, value_name = "DIR")]
    tables: Vec<PathBuf>,
}

impl StudyArgument {
    /// Reads the study file and the tables that it names.
    pub fn load(&self) -> Result<Study, StudyError> {
        Study::load_with_tables(&self.study, &self.tables)
    }

    /// Reads and resolves the study, and prints what is implausible in it unless `quiet`.
    pub fn load_and_warn(&self, quiet: bool) -> Result<Study, StudyError> {
        let study = self.load()?;
        if !quiet {
            warnings(&study).iter().for_each(|warning| say(&format!("warning: {warning}")));
        }
        Ok(study)
    }
}

/// The argument `--threads`.
#[derive(Clone, Debug, Args)]
pub struct ThreadsArgument {
    /// Worker threads [default: one per core]
    #[arg(long, value_name = "N", value_parser = threads, allow_negative_numbers = true)]
    threads: Option<NonZeroUsize>,
}

impl ThreadsArgument {
    /// Returns the number of worker threads.
    pub fn count(&self) -> usize {
        let cores = || std::thread::available_parallelism().unwrap_or(NonZeroUsize::MIN);
        self.threads.unwrap_or_else(cores).get()
    }

    /// Starts the worker threads.
    pub fn start(&self) -> Result<WorkerPool, CliError> {
        WorkerPool::new(self.count()).map_err(CliError::Threads)
    }
}

/// Arguments of the computation. No value here changes a result.
#[derive(Clone, Debug, Args)]
pub struct EngineArguments {
    #[command(flatten)]
    threads: ThreadsArgument,

    /// Number of runs that are computed before they are written to disk and to the tables; limits the memory
    #[arg(long, value_name = "RUNS", default_value = "1024", value_parser = positive)]
    #[arg(allow_negative_numbers = true)]
    chunk: NonZeroUsize,

    /// Stop after this many seconds with exit code 130; the same command continues the study
    ///
    /// Runs in progress get one more second. Runs that take longer are abandoned and computed again when the
    /// study continues, so choose a time much longer than one run.
    #[arg(long, value_name = "S", value_parser = seconds, allow_negative_numbers = true)]
    max_seconds: Option<Duration>,

    /// Whether to stop when runs fail: continue, stop at the first, or stop after more than N failed runs
    #[arg(long, value_name = "stop|continue|limit=N", default_value = "continue")]
    #[arg(value_parser = on_failure, hide_possible_values = true)]
    on_failure: OnFailure,

    /// Short form of --on-failure limit=N
    #[arg(long, value_name = "N", conflicts_with = "on_failure", value_parser = failed_runs)]
    #[arg(allow_negative_numbers = true)]
    max_failed: Option<u64>,

    /// Compute failed runs again, each from the same start state and parameters
    #[arg(long)]
    pub retry_failed: bool,

    /// Print neither progress nor a table
    #[arg(long, short)]
    pub quiet: bool,

    /// Print the result as JSON
    #[arg(long)]
    pub json: bool,

    /// How progress is shown on standard error
    ///
    /// auto: a bar on a terminal, lines elsewhere, nothing with --quiet. Bar and lines also report each
    /// finished point, but with more than 40 points at most one per second. json: one object per line, whose
    /// `event` is begun, progress (once a second), point (each one) or ended, with `elapsed_s` since the
    /// start. With --quiet standard error holds only these objects; without it, lines of other messages do
    /// not begin with a brace.
    #[arg(long, value_name = "HOW", value_enum, default_value = "auto")]
    progress: ProgressChoice,
}

/// The values of `--progress`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum ProgressChoice {
    Auto,
    Bar,
    Lines,
    Json,
    None,
}

/// The number of runs that may fail; any number if `None`.
#[derive(Clone, Copy, Debug)]
struct OnFailure(Option<u64>);

impl EngineArguments {
    /// Returns how progress is shown. A display that is named explicitly is shown with `--quiet`, too.
    pub fn show(&self) -> ProgressDisplay {
        match self.progress {
            ProgressChoice::Auto if self.quiet => ProgressDisplay::Nothing,
            ProgressChoice::Auto => ProgressDisplay::auto(),
            ProgressChoice::Bar => ProgressDisplay::Bar,
            ProgressChoice::Lines => ProgressDisplay::Lines,
            ProgressChoice::Json => ProgressDisplay::Json,
            ProgressChoice::None => ProgressDisplay::Nothing,
        }
    }

    /// Returns the engine's options; the time limit starts now.
    pub fn options(&self, shard: Shard) -> EngineOptions {
        EngineOptions {
            threads: self.threads.count(),
            chunk: self.chunk.get(),
            shard,
            deadline: self.max_seconds.and_then(|time| Instant::now().checked_add(time)),
            most_failed: self.max_failed.or(self.on_failure.0),
            retry_failed: self.retry_failed,
        }
    }
}

/// Returns the directory for results: `out`, or one in `results` with the name of the study and this suffix.
pub fn results_directory(out: Option<&PathBuf>, study: &Study, suffix: &str) -> PathBuf {
    let usual = || Path::new("results").join(format!("{}{suffix}", study.name()));
    out.cloned().unwrap_or_else(usual)
}

/// Parses a value for which `is_allowed` holds; `allowed` describes the allowed values.
pub fn parsed<T: FromStr>(
    text: &str,
    allowed: impl Display,
    is_allowed: impl FnOnce(&T) -> bool,
) -> Result<T, String> {
    let value = text.parse().ok().filter(is_allowed);
    value.ok_or_else(|| format!("found {text:?}, allowed: {allowed}"))
}

/// Parses a time span in seconds.
fn seconds(text: &str) -> Result<Duration, String> {
    let seconds = text.parse().ok().and_then(|number| Duration::try_from_secs_f64(number).ok());
    seconds.ok_or_else(|| format!("found {text:?}, allowed: a number of seconds, from 0 to 1e19"))
}

fn on_failure(text: &str) -> Result<OnFailure, String> {
    let limit = || text.strip_prefix("limit=")?.parse().ok();
    match text {
        "stop" => Ok(OnFailure(Some(0))),
        "continue" => Ok(OnFailure(None)),
        _ => limit().map(|limit| OnFailure(Some(limit))).ok_or_else(|| {
            format!("found {text:?}, allowed: stop, continue, or limit=N with a whole number N")
        }),
    }
}

fn failed_runs(text: &str) -> Result<u64, String> {
    let allowed = "the number of runs that may fail, a whole number from 0, as in 10";
    parsed(text, allowed, |_| true)
}

/// The largest number of threads. No machine has more cores, and further threads would only take memory.
const MOST_THREADS: usize = 1024;

fn threads(text: &str) -> Result<NonZeroUsize, String> {
    let allowed = format!("a whole number from 1 to {MOST_THREADS}");
    parsed(text, allowed, |threads: &NonZeroUsize| threads.get() <= MOST_THREADS)
}

fn positive(text: &str) -> Result<NonZeroUsize, String> {
    parsed(text, "a whole number from 1", |_| true)
}
