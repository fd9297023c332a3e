//! Arguments that several commands have in common.

use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::time::{Duration, Instant};

use clap::{Args, ValueEnum};

use crate::engine::{EngineOptions, Shard, Show};
use crate::study::{Study, StudyError};

/// The study file.
#[derive(Clone, Debug, Args)]
pub struct StudyArgument {
    /// Study file, YAML (`stickslip schema` describes it)
    #[arg(value_name = "STUDY")]
    pub study: PathBuf,

    /// Directory in which tables of the study may lie as well as beside the study file; may be repeated
    ///
    /// Without it, a `table:` that leads out of the study file's directory is refused. It allows files
    /// and finds none: paths of tables stay relative to the study file, and results the same.
    #[arg(long, value_name = "DIR")]
    tables: Vec<PathBuf>,
}

impl StudyArgument {
    /// Reads the study and the tables that it names.
    ///
    /// # Errors
    /// The first thing that is wrong, with its place.
    pub fn load(&self) -> Result<Study, StudyError> {
        Study::load_with_tables(&self.study, &self.tables)
    }
}

/// The part of a study.
#[derive(Clone, Debug, Args)]
pub struct ShardArgument {
    /// Compute part K of N of the runs only
    ///
    /// One of each N runs, so that parts cost about the same. In a study with `precision`, one of each N
    /// points with all its runs: a part of a point's runs could not decide how many it needs.
    #[arg(long, value_name = "K/N", default_value = "1/1")]
    pub shard: Shard,
}

/// How the runs are computed. None of it changes a result.
#[derive(Clone, Debug, Args)]
pub struct EngineArguments {
    /// Worker threads [default: one per core]
    #[arg(long, value_name = "N", value_parser = threads, allow_negative_numbers = true)]
    threads: Option<NonZeroUsize>,

    /// Runs computed before they are handed to the tables and put on disk; bounds the memory
    #[arg(long, value_name = "RUNS", default_value = "1024", value_parser = positive)]
    #[arg(allow_negative_numbers = true)]
    chunk: NonZeroUsize,

    /// Stop after so many seconds; exit code 130, and the same command goes on
    ///
    /// Runs in progress have one more second; those that take longer are given up and computed anew when the
    /// study goes on. So this should be many times what a run takes.
    #[arg(long, value_name = "S", value_parser = seconds, allow_negative_numbers = true)]
    max_seconds: Option<Duration>,

    /// What to do when runs fail: continue; stop at the first; or stop when more than N have failed
    #[arg(long, value_name = "stop|continue|limit=N", default_value = "continue")]
    #[arg(value_parser = on_failure, hide_possible_values = true)]
    on_failure: OnFailure,

    /// The same as --on-failure limit=N
    #[arg(long, value_name = "N", conflicts_with = "on_failure")]
    max_failed: Option<u64>,

    /// Compute finished runs that failed again, each from the same start state and parameters
    #[arg(long)]
    pub retry_failed: bool,

    /// No progress and no table on the terminal
    #[arg(long, short)]
    pub quiet: bool,

    /// Print the result as JSON
    #[arg(long)]
    pub json: bool,

    /// How progress is shown on standard error
    ///
    /// auto: a bar where it is a terminal, lines elsewhere, nothing with --quiet. Bar and lines tell of each
    /// finished point as well, of more than 40 points at most once a second. json: one object per line,
    /// whose `event` is begun, progress (once a second), point (each one) or ended, with `elapsed_s`
    /// since the start; with --quiet nothing else is there, without it lines of other messages do
    /// not begin with a brace.
    #[arg(long, value_name = "HOW", value_enum, default_value = "auto")]
    progress: ProgressChoice,
}

/// How progress is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum ProgressChoice {
    Auto,
    Bar,
    Lines,
    Json,
    None,
}

/// How many runs may fail; any number if none.
#[derive(Clone, Copy, Debug)]
struct OnFailure(Option<u64>);

impl EngineArguments {
    /// How progress is shown; what is asked for by name is shown with `--quiet`, too.
    pub fn show(&self) -> Show {
        match self.progress {
            ProgressChoice::Auto if self.quiet => Show::Nothing,
            ProgressChoice::Auto => Show::auto(),
            ProgressChoice::Bar => Show::Bar,
            ProgressChoice::Lines => Show::Lines,
            ProgressChoice::Json => Show::Json,
            ProgressChoice::None => Show::Nothing,
        }
    }

    /// As the engine takes them; time counts from now.
    pub fn options(&self, shard: Shard) -> EngineOptions {
        let cores = || std::thread::available_parallelism().unwrap_or(NonZeroUsize::MIN);
        EngineOptions {
            threads: self.threads.unwrap_or_else(cores).get(),
            chunk: self.chunk.get(),
            shard,
            deadline: self.max_seconds.and_then(|time| Instant::now().checked_add(time)),
            most_failed: self.max_failed.or(self.on_failure.0),
            retry_failed: self.retry_failed,
        }
    }
}

/// A time span.
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

/// More threads than any machine has cores would only take memory.
const MOST_THREADS: usize = 1024;

/// A number of worker threads.
///
/// # Errors
/// What was found and what is allowed.
pub fn threads(text: &str) -> Result<NonZeroUsize, String> {
    let threads = text.parse().ok().filter(|threads: &NonZeroUsize| threads.get() <= MOST_THREADS);
    threads
        .ok_or_else(|| format!("found {text:?}, allowed: a whole number from 1 to {MOST_THREADS}"))
}

fn positive(text: &str) -> Result<NonZeroUsize, String> {
    text.parse().map_err(|_| format!("found {text:?}, allowed: a whole number from 1"))
}
