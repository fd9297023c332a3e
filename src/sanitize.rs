//! Sanitisation of foreign text for messages, pages and commands.
//!
//! File names, column names, manifests and studies may come from anywhere, and a terminal executes
//! escape sequences that move its cursor, change its title or hide text. Quoted text passes through
//! [`shorten`] or [`shown_path`], which return one line of limited length without control
//! characters. All output to a terminal additionally passes through [`harmless`] or
//! [`harmless_json`], and arguments of commands to paste pass through [`shell_word`].

use std::borrow::Cow;
use std::fmt::Write;
use std::path::Path;

/// The largest number of characters that a message quotes at a time.
const LONGEST: usize = 96;
/// The largest number of characters of a path in a message.
const LONGEST_PATH: usize = 1024;

/// Returns whether a terminal acts on a character instead of showing it: a control character, a
/// line separator, or a character that changes the direction of writing.
pub(crate) fn is_acted_on(character: char) -> bool {
    character.is_control() || matches!(character, '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

/// Replaces white space by a blank, and any other active character by a replacement character.
fn without_effect(character: char) -> char {
    match character {
        acted if !is_acted_on(acted) => acted,
        space if space.is_whitespace() => ' ',
        _ => '\u{fffd}',
    }
}

/// Returns the beginning of a text as one line without control characters.
pub(crate) fn one_line(text: &str, most: usize) -> String {
    let mut characters = text.trim_end().chars();
    let mut short: String = characters.by_ref().take(most).map(without_effect).collect();
    if characters.next().is_some() {
        short.push_str(" ...");
    }
    short
}

/// Returns a text for a message: one line of limited length, without control characters.
pub(crate) fn shorten(text: &str) -> String {
    one_line(text, LONGEST)
}

/// Returns a path for a message: one line, without control characters.
pub(crate) fn shown_path(path: &Path) -> String {
    one_line(&path.to_string_lossy(), LONGEST_PATH)
}

/// Quotes a path for a shell command to paste.
pub(crate) fn shell_word(path: &Path) -> String {
    let path = shown_path(path);
    // A leading dash would start an option.
    let path = if path.starts_with('-') { format!("./{path}") } else { path };
    let plain =
        |c: char| c.is_alphanumeric() || "_-./+=:,@%".contains(c) || (cfg!(windows) && c == '\\');
    match !path.is_empty() && path.chars().all(plain) {
        true => path,
        false => format!("'{}'", path.replace('\'', r"'\''")),
    }
}

/// Returns a text of any length in which line breaks and tabs are the only active characters.
pub(crate) fn harmless(text: &str) -> Cow<'_, str> {
    let is_harmless = |c: char| c == '\n' || c == '\t' || !is_acted_on(c);
    if text.chars().all(is_harmless) {
        return Cow::Borrowed(text);
    }
    Cow::Owned(text.chars().map(|c| if is_harmless(c) { c } else { without_effect(c) }).collect())
}

/// Returns equivalent JSON in which line breaks are the only active characters. serde_json leaves
/// some control characters in strings unescaped; this function escapes them.
pub(crate) fn harmless_json(json: &str) -> Cow<'_, str> {
    let is_harmless = |c: char| c == '\n' || !is_acted_on(c);
    if json.chars().all(is_harmless) {
        return Cow::Borrowed(json);
    }
    let mut escaped = String::with_capacity(json.len());
    for c in json.chars() {
        if is_harmless(c) {
            escaped.push(c);
        } else {
            // All active characters are in the basic plane; writing into a string cannot fail.
            let _ = write!(escaped, "\\u{:04x}", u32::from(c));
        }
    }
    Cow::Owned(escaped)
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::{harmless, harmless_json, is_acted_on, shell_word, shorten, shown_path};

    /// The active characters: C0 and C1 controls, and marks of direction.
    const ACTED_ON: &str = "\0\u{7}\u{8}\r\u{1b}[2J\u{7f}\u{9b}31m\u{85}\u{2028}\u{202e}\u{2066}";

    #[test]
    fn nothing_that_is_acted_on_is_left() {
        let foreign = format!("a{ACTED_ON}\n\tb");
        let quiet = |text: &str| !text.chars().any(is_acted_on);
        assert!(quiet(&shorten(&foreign)) && quiet(&shown_path(Path::new(&foreign))));
        assert!(quiet(&shell_word(Path::new(&foreign))));
        assert!(quiet(&harmless(&foreign).replace(['\n', '\t'], "")));
        assert_eq!(harmless("a\n\tå – 日本 \u{200d}"), "a\n\tå – 日本 \u{200d}");
        assert_eq!(shorten("a\n b\u{1b}[1mc \n"), "a  b\u{fffd}[1mc");
        assert_eq!(shorten(&"å".repeat(97)), format!("{} ...", "å".repeat(96)));
        assert_eq!(shorten(&"å".repeat(96)), "å".repeat(96));
    }

    #[test]
    fn json_keeps_its_meaning() {
        let value = serde_json::json!({"id": format!("å\n{ACTED_ON}"), "n": 1.5});
        for text in [value.to_string(), format!("{value:#}")] {
            let harmless = harmless_json(&text);
            assert!(!harmless.replace('\n', "").chars().any(is_acted_on));
            assert_eq!(serde_json::from_str::<serde_json::Value>(&harmless).unwrap(), value);
        }
    }

    #[test]
    fn commands_take_a_path_as_one_word() {
        for (path, word) in [
            ("results/night-1_a.b", "results/night-1_a.b"),
            ("a b", "'a b'"),
            ("a'; rm -r ~ #", r"'a'\''; rm -r ~ #'"),
            ("$(reboot)`x`", "'$(reboot)`x`'"),
            ("-rf", "./-rf"),
            ("-a b", "'./-a b'"),
            ("", "''"),
            ("~", "'~'"),
            ("å/日本", "å/日本"),
        ] {
            assert_eq!(shell_word(Path::new(path)), word);
        }
    }
}
