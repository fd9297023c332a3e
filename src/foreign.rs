//! Text that comes from files, as messages, pages and commands may show it.
//!
//! Names of files, columns of tables, manifests and studies may come from anywhere, and a terminal acts on what it
//! is sent: escape sequences move its cursor, change its title or hide what stands there. Whatever is quoted
//! goes through [`shorten`] or [`shown_path`] where it is quoted: one line, not too long, nothing that a terminal acts
//! on. All that goes to a terminal goes through [`harmless`] or [`harmless_json`] once more, and what stands in
//! a command to paste through [`shell_word`].

use std::borrow::Cow;
use std::fmt::Write;
use std::path::Path;

/// The most characters of a file that a message quotes at a time.
const LONGEST: usize = 96;
/// The most characters of a path that a message shows.
const LONGEST_PATH: usize = 1024;

/// Whether a character is acted on instead of shown: a control character, or one that begins a line or changes the
/// direction of writing.
pub(crate) fn is_acted_on(character: char) -> bool {
    character.is_control() || matches!(character, '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

/// White space as a blank, and whatever else is acted on as a mark of replacement.
fn tamed(character: char) -> char {
    match character {
        acted if !is_acted_on(acted) => acted,
        space if space.is_whitespace() => ' ',
        _ => '\u{fffd}',
    }
}

/// So much of a text as is quoted: one line without control characters.
pub(crate) fn one_line(text: &str, most: usize) -> String {
    let mut characters = text.trim_end().chars();
    let mut short: String = characters.by_ref().take(most).map(tamed).collect();
    if characters.next().is_some() {
        short.push_str(" ...");
    }
    short
}

/// Text as it is quoted in a message: one line, not too long, no control characters.
pub(crate) fn shorten(text: &str) -> String {
    one_line(text, LONGEST)
}

/// A path as it stands in a message: one line, no control characters.
pub(crate) fn shown_path(path: &Path) -> String {
    one_line(&path.to_string_lossy(), LONGEST_PATH)
}

/// A path as a shell takes it in a command to paste.
pub(crate) fn shell_word(path: &Path) -> String {
    let path = shown_path(path);
    // What begins with a dash would be an option.
    let path = if path.starts_with('-') { format!("./{path}") } else { path };
    let plain =
        |c: char| c.is_alphanumeric() || "_-./+=:,@%".contains(c) || (cfg!(windows) && c == '\\');
    match !path.is_empty() && path.chars().all(plain) {
        true => path,
        false => format!("'{}'", path.replace('\'', r"'\''")),
    }
}

/// Text of any length with nothing but line breaks and tabs that a terminal acts on.
pub(crate) fn harmless(text: &str) -> Cow<'_, str> {
    let kept = |c: char| c == '\n' || c == '\t' || !is_acted_on(c);
    if text.chars().all(kept) {
        return Cow::Borrowed(text);
    }
    Cow::Owned(text.chars().map(|c| if kept(c) { c } else { tamed(c) }).collect())
}

/// JSON that means the same, with nothing but line breaks that a terminal acts on: serde_json leaves some
/// control characters in texts as they are, which may be escaped.
pub(crate) fn harmless_json(json: &str) -> Cow<'_, str> {
    let kept = |c: char| c == '\n' || !is_acted_on(c);
    if json.chars().all(kept) {
        return Cow::Borrowed(json);
    }
    let mut escaped = String::with_capacity(json.len());
    for c in json.chars() {
        if kept(c) {
            escaped.push(c);
        } else {
            // All that is acted on is in the basic plane; writing into a string cannot fail.
            let _ = write!(escaped, "\\u{:04x}", u32::from(c));
        }
    }
    Cow::Owned(escaped)
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::{harmless, harmless_json, is_acted_on, shell_word, shorten, shown_path};

    /// All that a terminal acts on: C0 and C1 controls, and marks of direction.
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
