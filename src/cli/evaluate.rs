//! `stickslip evaluate`: computes responses of designs for optimisers, of a table or of requests on standard input.

use std::borrow::Cow;
use std::io::{self, BufRead, IsTerminal, Read};
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel};
use std::thread;
use std::time::Duration;

use clap::Args;
use serde_json::json;

use super::arguments::{StudyArgument, ThreadsArgument};
use super::new_table::NewTable;
use super::output::{CliError, End, OutputReader, csv_header, csv_rows, print, print_json};
use crate::classification::Label;
use crate::engine::{Parts, Planned, Progress, ProgressDisplay, WorkerPool, say, stop_on_signals};
use crate::numbers::counted;
use crate::printed_table::{PrintedTable, as_text};
use crate::report::{Estimates, estimate_columns};
use crate::responses::{
    Answer, DesignToEvaluate, MOST_DESIGNS, Neighbours, Request, check_answerable, respond,
    respond_to_all, response_columns, run_count, to_json,
};
use crate::study::{DesignValue, Study};
use crate::table::provenance;

const EXAMPLES: &str = "\
Examples:
  stickslip evaluate studies/design.yaml --designs studies/designs.csv
  stickslip evaluate studies/design.yaml --designs studies/designs.csv --out responses.parquet
  echo '{\"id\": 1, \"speed_rad_s\": -216, \"balls\": 2, \"material\": \"steel\"}' | stickslip evaluate studies/design.yaml --designs -

Computes the responses of each design. A design sets the variables that the study lists under `design`; \
`responses` lists what is computed. Sampling and uncertain parameters are those of the study, and each point of \
its sweep has its own row or answer. All designs share start states and draws, so that differences between \
designs are more precise than their values. `audit` and `expect` are ignored.

The table of responses has a row per design and point. With --out it goes to a Parquet file, or to a CSV file if the \
name ends in .csv. Otherwise it goes to standard output, as CSV; on a terminal as aligned columns with rounded \
numbers. With --designs - the command is a server: it reads one JSON object per line from standard input and answers each with one line, in order, \
until its input ends or its output is closed. The answer to an invalid request is an object with `error`. \
`stickslip optimize` searches for the best design with the same responses.";

/// Compute responses of designs for optimisers, from a table or from requests on standard input
#[derive(Clone, Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct Arguments {
    #[command(flatten)]
    study: StudyArgument,

    /// Table of designs, CSV or Parquet, with a column per variable; - for requests on standard input
    #[arg(long, value_name = "FILE")]
    designs: PathBuf,

    /// Parquet or CSV file to write, such as responses.parquet or responses.csv
    #[arg(long, short, value_name = "FILE")]
    out: Option<PathBuf>,

    #[command(flatten)]
    threads: ThreadsArgument,

    /// Print no progress
    #[arg(long, short)]
    quiet: bool,
}

/// Evaluates designs.
pub fn evaluate(arguments: &Arguments) -> Result<End, CliError> {
    let study = arguments.study.load_and_warn(arguments.quiet)?;
    check_answerable(&study, &arguments.study.study).map_err(CliError::Usage)?;
    if arguments.designs.as_os_str() == "-" {
        if arguments.out.is_some() {
            let refused = "--out: answers to requests go to standard output\n  allowed: --out with a table of designs";
            return Err(CliError::Usage(refused.to_owned()));
        }
        return serve(&study, &arguments.threads.start()?, &stop_on_signals());
    }
    let designs = study.designs(&arguments.designs)?;
    let create = |out: &PathBuf| {
        NewTable::create(out, response_columns(&study), &provenance(&study, "responses"))
    };
    let table = arguments.out.as_ref().map(create).transpose()?;
    let show = if arguments.quiet { ProgressDisplay::Nothing } else { ProgressDisplay::auto() };
    let (workers, stop) = (arguments.threads.start()?, stop_on_signals());
    let Some(answers) = compute(&study, &designs, &workers, &stop, show)? else {
        table.map_or(Ok(()), NewTable::abandon)?;
        say("interrupted; nothing is written");
        return Ok(End::Interrupted);
    };
    let failed: u64 = answers.iter().map(|answer| answer.counts.of(Label::Failed)).sum();
    if let Some(mut table) = table {
        answers.into_iter().try_for_each(|answer| table.push(answer))?;
        table.finish()?;
    } else if io::stdout().is_terminal() {
        print(&printed(&study, &answers))?;
    } else {
        let columns = response_columns(&study);
        print(&(csv_header(&columns)? + &csv_rows(&columns, &answers)?))?;
    }
    if !arguments.quiet {
        if let Some(out) = &arguments.out {
            let of = counted(designs.len(), "design");
            say(&format!("responses of {of} in {}", out.display()));
        }
        if designs.len() > MOST_DESIGNS {
            say(&format!("more than {MOST_DESIGNS} designs: `discontinuous` is not computed"));
        }
    }
    Ok(if failed > 0 { End::RunsFailed } else { End::Well })
}

/// Returns the answers as aligned columns: variables, point of the sweep, responses with their intervals, and failed runs.
fn printed(study: &Study, answers: &[Answer]) -> String {
    let mut table = PrintedTable::new(answers, "");
    table.add("design", |answer| answer.design.to_string());
    for (index, variable) in study.variables().iter().enumerate() {
        let value = |answer: &Answer| Some(variable.describe(*answer.values.get(index)?));
        table.add_known(variable.shown_name(), value);
    }
    for (index, swept) in study.swept().iter().enumerate() {
        let value = |answer: &Answer| study.shown(&answer.swept).get(index).cloned();
        table.add_known(swept.shown_name(), value);
    }
    let estimates: Vec<Estimates<'_>> =
        answers.iter().map(|answer| (&answer.estimates[..], &[][..])).collect();
    table.columns.extend(estimate_columns(study.responses(), &estimates, study.units()));
    table.add("failed", |answer| answer.counts.of(Label::Failed).to_string());
    as_text(&table.columns)
}

/// Returns the answers for all designs, in order; `None` if `stop` became true.
fn compute(
    study: &Study,
    designs: &[Vec<DesignValue>],
    workers: &WorkerPool,
    stop: &AtomicBool,
    show: ProgressDisplay,
) -> Result<Option<Vec<Answer>>, CliError> {
    let runs = run_count(study, designs).map_err(CliError::Usage)?;
    let parts = Parts::Designs(designs.len() as u64);
    let planned = Planned { study: study.name(), runs, at_most: false, parts };
    let progress = Progress::begin(planned, show);
    let finished = |label| progress.finished(label);
    let answers = respond_to_all(workers, study, designs, stop, &finished);
    progress.close();
    let answers = answers.map_err(CliError::Usage)?;
    progress.ended(answers.is_none());
    Ok(answers)
}

/// The longest request line, in bytes.
const MAX_LINE_BYTES: usize = 1 << 20;
/// How often a waiting thread checks for an interruption.
const POLL_INTERVAL: Duration = Duration::from_millis(50);

const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";

/// A line of standard input; `None` if it is longer than `MAX_LINE_BYTES`.
type Line = Option<Vec<u8>>;

/// Answers requests until the input ends, the output is closed, or `stop` becomes true.
pub fn serve(study: &Study, workers: &WorkerPool, stop: &AtomicBool) -> Result<End, CliError> {
    let lines = lines();
    let writer = Writer::start();
    let mut neighbours = Neighbours::new(study.point_count());
    let mut number = 0;
    loop {
        if stop.load(Ordering::Relaxed) {
            return Ok(End::Interrupted);
        }
        let line = match lines.recv_timeout(POLL_INTERVAL) {
            Ok(line) => line?,
            Err(RecvTimeoutError::Timeout) => continue,
            Err(RecvTimeoutError::Disconnected) => return Ok(End::Well),
        };
        let too_long = || Request::too_long(MAX_LINE_BYTES);
        let request = line.map_or_else(too_long, |line| Request::read(study, &line));
        let answer = match &request.design {
            Err(refusal) => json!({"id": request.id, "error": refusal}),
            Ok((values, set)) => {
                let plans = vec![Cow::Borrowed(set.as_ref())];
                let design = DesignToEvaluate { number, values, plans };
                let answers = respond(workers, study.responses(), design, stop, &|_| {});
                let Some(mut answers) = answers else { return Ok(End::Interrupted) };
                let counts = answers.iter().map(|answer| answer.counts).collect();
                let flags = neighbours.compare(study.scaled(values), counts);
                for (answer, flag) in answers.iter_mut().zip(flags) {
                    answer.discontinuous = flag;
                }
                to_json(study, &request.id, &answers)
            }
        };
        number += 1;
        match writer.write(format!("{answer}\n"), stop)? {
            Some(OutputReader::Reading) => {}
            Some(OutputReader::Gone) => return Ok(End::Well),
            None => return Ok(End::Interrupted),
        }
    }
}

/// Writes answers to standard output from a separate thread, because a blocking write does not see signals. The
/// thread is abandoned when the server ends.
struct Writer {
    texts: SyncSender<String>,
    written: Receiver<io::Result<OutputReader>>,
}

impl Writer {
    fn start() -> Self {
        let (texts, to_write) = sync_channel::<String>(1);
        let (results, written) = sync_channel(1);
        thread::spawn(move || {
            for text in to_write {
                // A closed channel means that the server has ended.
                if results.send(print_json(&text)).is_err() {
                    return;
                }
            }
        });
        Writer { texts, written }
    }

    /// Writes a whole text and returns whether the reader still reads; `None` if `stop` becomes true first.
    fn write(&self, text: String, stop: &AtomicBool) -> io::Result<Option<OutputReader>> {
        let ended = || io::Error::other("the writer thread has ended");
        self.texts.send(text).map_err(|_| ended())?;
        loop {
            match self.written.recv_timeout(POLL_INTERVAL) {
                Ok(written) => return written.map(Some),
                Err(RecvTimeoutError::Timeout) if stop.load(Ordering::Relaxed) => return Ok(None),
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => return Err(ended()),
            }
        }
    }
}

/// Reads the lines of standard input in a separate thread, because a blocking read does not see signals.
fn lines() -> Receiver<io::Result<Line>> {
    let (sender, receiver) = sync_channel(16);
    thread::spawn(move || {
        let mut input = io::stdin().lock();
        let mut first = true;
        loop {
            let Some(mut line) = next_line(&mut input).transpose() else { return };
            if let (true, Ok(Some(text))) = (std::mem::take(&mut first), &mut line) {
                // Windows shells begin a pipe with a byte order mark, which JSON does not allow.
                if text.starts_with(BYTE_ORDER_MARK) {
                    text.drain(..BYTE_ORDER_MARK.len());
                }
            }
            let broken = line.is_err();
            // A closed channel means that the server has ended.
            if sender.send(line).is_err() || broken {
                return;
            }
        }
    });
    receiver
}

/// Returns the next line; `None` at the end of the input.
fn next_line(input: &mut impl BufRead) -> io::Result<Option<Line>> {
    let mut line = Vec::new();
    if input.by_ref().take(MAX_LINE_BYTES as u64 + 1).read_until(b'\n', &mut line)? == 0 {
        return Ok(None);
    }
    if line.len() <= MAX_LINE_BYTES {
        return Ok(Some(Some(line)));
    }
    while line.last() != Some(&b'\n') {
        line.clear();
        if input.by_ref().take(MAX_LINE_BYTES as u64).read_until(b'\n', &mut line)? == 0 {
            break;
        }
    }
    Ok(Some(None))
}
