//! Standard output: data only, and a reader that has seen enough is no error.

use std::io::{self, Write};

use crate::foreign::{harmless, harmless_json};

/// Whether anyone still reads standard output.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reader {
    /// It took the text.
    Reading,
    /// It has gone (`| head`): nothing more is owed.
    Gone,
}

/// Writes text to standard output, without what a terminal acts on.
///
/// # Errors
/// Where it cannot be written, and not because its reader has gone.
pub fn print(text: &str) -> io::Result<Reader> {
    write(&harmless(text))
}

/// Writes JSON to standard output; what a terminal acts on is escaped and means the same.
///
/// # Errors
/// Where it cannot be written, and not because its reader has gone.
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
