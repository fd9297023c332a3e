//! Names that a study gives: its own and those of variables, responses and choices.

use crate::study::error::{Fault, shorten};

/// Checks a name of 1 to 100 ASCII letters, digits and `further` characters. `allowed` describes it in words.
pub(in crate::study) fn check_name(
    name: &str,
    further: &str,
    is_first: impl Fn(char) -> bool,
    allowed: &str,
) -> Result<(), Fault> {
    let is_usual =
        |character: char| character.is_ascii_alphanumeric() || further.contains(character);
    if name.starts_with(is_first) && name.len() <= 100 && name.chars().all(is_usual) {
        return Ok(());
    }
    Err(Fault::new("not a name", format!("text {:?}", shorten(name)), allowed))
}

/// Returns whether a name has lower-case letters, digits and `_`, with a letter first.
pub(in crate::study) fn is_key(name: &str) -> bool {
    let is_usual = |byte: u8| matches!(byte, b'a'..=b'z' | b'0'..=b'9' | b'_');
    name.starts_with(|first: char| first.is_ascii_lowercase()) && name.bytes().all(is_usual)
}

/// Checks the name of a study, which becomes the name of a directory.
pub(in crate::study) fn check_study_name(name: &str) -> Result<(), Fault> {
    let allowed = "1 to 100 letters, digits, `-`, `_` and `.`, not starting with `.`";
    check_name(name, "-_.", |first| first != '.', allowed)
}

/// Checks the name of a variable or response, which becomes a column and a key of results.
pub(in crate::study) fn check_column_name(name: &str) -> Result<(), Fault> {
    let allowed = "1 to 100 letters, digits and `_`, beginning with a letter";
    check_name(name, "_", |first| first.is_ascii_alphabetic(), allowed)
}
