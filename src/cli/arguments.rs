//! Arguments that several commands have in common.

use std::num::NonZeroUsize;
use std::path::PathBuf;

use clap::Args;

use crate::farm::{FarmOptions, Shard};
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

/// How the runs are farmed. None of it changes a result.
#[derive(Clone, Debug, Args)]
pub struct FarmArguments {
    /// Worker threads [default: one per core]
    #[arg(long, value_name = "N", value_parser = threads, allow_negative_numbers = true)]
    threads: Option<NonZeroUsize>,

    /// Compute part K of N of the runs only
    ///
    /// Every N-th run, so that parts cost about the same. In a study with `precision`, every N-th point
    /// with all its runs: a part of a point's runs could not decide how many it needs.
    #[arg(long, value_name = "K/N", default_value = "1/1")]
    pub shard: Shard,

    /// Runs computed before they are handed to the tables; bounds the memory
    #[arg(long, value_name = "RUNS", default_value = "1024", value_parser = positive)]
    #[arg(allow_negative_numbers = true)]
    chunk: NonZeroUsize,

    /// No progress and no table on the terminal
    #[arg(long, short)]
    pub quiet: bool,

    /// Print the result as JSON
    #[arg(long)]
    pub json: bool,
}

impl FarmArguments {
    /// As the farm wants them.
    pub fn options(&self) -> FarmOptions {
        let cores = || std::thread::available_parallelism().unwrap_or(NonZeroUsize::MIN);
        FarmOptions {
            threads: self.threads.unwrap_or_else(cores).get(),
            chunk: self.chunk.get(),
            shard: self.shard,
        }
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
