//! Messages of the library, which the program that uses it shows, such as the command line on standard error.

use std::sync::OnceLock;

use serde_json::Value;

use crate::sanitize::harmless_json;

static SHOWN_BY: OnceLock<fn(&str)> = OnceLock::new();

/// Passes all later messages to a function, unless an earlier call has named one. Before this call, nothing is shown.
pub fn show_messages(show: fn(&str)) {
    SHOWN_BY.get_or_init(|| show);
}

/// Passes a message to the function that shows messages.
pub fn say(message: &str) {
    if let Some(show) = SHOWN_BY.get() {
        show(message);
    }
}

/// Passes a JSON event to the function that shows messages.
pub(super) fn say_json(event: &Value) {
    say(&harmless_json(&event.to_string()));
}
