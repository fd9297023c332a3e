//! Messages on standard error.

use std::io::{self, Write};

use serde_json::Value;

use crate::sanitize::{harmless, harmless_json};

/// Writes a message to standard error, without terminal control characters. Ignores write errors, such as from a
/// closed terminal, so that the computation continues; `eprintln` would panic.
pub fn say(message: &str) {
    write_line(&harmless(message).replace('\t', " "));
}

/// Writes a JSON event to standard error.
pub(super) fn say_json(event: &Value) {
    write_line(&harmless_json(&event.to_string()));
}

fn write_line(line: &str) {
    // A single write keeps the lines of several threads apart.
    let _ = io::stderr().lock().write_all(format!("{line}\n").as_bytes());
}
