//! Parts that a text must have.

use std::fmt::Display;

/// Asserts that a text contains every part.
#[track_caller]
pub fn assert_has(text: &str, parts: &[impl Display]) {
    for part in parts {
        assert!(text.contains(&part.to_string()), "no {part} in\n{text}");
    }
}
