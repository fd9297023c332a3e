//! `stickslip evaluate --designs -`: answers requests on standard input on standard output.

use std::borrow::Cow;
use std::io::{self, BufRead, Read};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel};
use std::thread;
use std::time::Duration;

use serde_json::json;

use super::exit::{CliError, End};
use super::output::{Reader, print_json};
use crate::engine::WorkerPool;
use crate::responses::{Design, Neighbours, Request, respond, to_json};
use crate::study::Study;

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
                let design = Design { number, values, plans };
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
            Some(Reader::Reading) => {}
            Some(Reader::Gone) => return Ok(End::Well),
            None => return Ok(End::Interrupted),
        }
    }
}

/// Writes answers to standard output from a separate thread, because a blocking write does not see signals. The
/// thread is abandoned when the server ends.
struct Writer {
    texts: SyncSender<String>,
    written: Receiver<io::Result<Reader>>,
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
    fn write(&self, text: String, stop: &AtomicBool) -> io::Result<Option<Reader>> {
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
