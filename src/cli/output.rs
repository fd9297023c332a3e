//! Standard output: data only, and a reader that has seen enough is no error.

use std::io::{self, Write};

/// Writes text to standard output. Where its reader has gone (`| head`), nothing more is owed.
///
/// # Errors
/// Where it cannot be written for another reason.
pub fn print(text: &str) -> io::Result<()> {
    let mut out = io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(()),
        result => result,
    }
}
