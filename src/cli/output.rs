//! Standard output: data only; a reader that stops reading is not an error.

use std::io::{self, Write};

use crate::sanitize::{harmless, harmless_json};

/// Whether standard output still has a reader.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reader {
    /// The reader took the text.
    Reading,
    /// The reader has closed its end, as `| head` does; further output is pointless.
    Gone,
}

/// Writes text to standard output, without terminal control characters.
///
/// # Errors
/// Returns an error if standard output cannot be written to, except when its reader has gone.
pub fn print(text: &str) -> io::Result<Reader> {
    write(&harmless(text))
}

/// Writes JSON to standard output, with terminal control characters escaped.
///
/// # Errors
/// Returns an error if standard output cannot be written to, except when its reader has gone.
pub fn print_json(json: &str) -> io::Result<Reader> {
    write(&harmless_json(json))
}

fn write(text: &str) -> io::Result<Reader> {
    let mut out = io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(Reader::Gone),
        result => result.map(|()| Reader::Reading),
    }
}
