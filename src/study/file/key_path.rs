//! The path from the top of a study file to one of its values, such as `sweep[0].grid.speed_rad_s`.

use std::fmt;

use crate::sanitize::shorten;

/// One step of a path.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Segment {
    /// Into a map, by key.
    Key(String),
    /// Into a list, by index counted from zero.
    Item(usize),
}

/// The steps from the top of the file.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct KeyPath(pub Vec<Segment>);

impl KeyPath {
    /// Returns the path with this text; `None` if a part of it is no key and no item.
    pub fn parse(text: &str) -> Option<KeyPath> {
        let mut steps = Vec::new();
        for part in text.split('.') {
            let (key, items) = part.split_at(part.find('[').unwrap_or(part.len()));
            steps.push(Segment::Key(key.to_owned()));
            for item in items.split_terminator(']') {
                steps.push(Segment::Item(item.strip_prefix('[')?.parse().ok()?));
            }
        }
        Some(KeyPath(steps))
    }

    /// Creates the path with this text, or that of a single key if a part of the text is no key and no item.
    pub fn of(text: &str) -> KeyPath {
        KeyPath::parse(text).unwrap_or_else(|| KeyPath(vec![Segment::Key(text.to_owned())]))
    }
}

impl fmt::Display for KeyPath {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (depth, step) in self.0.iter().enumerate() {
            match step {
                Segment::Key(key) if depth == 0 => write!(out, "{}", shorten(key))?,
                Segment::Key(key) => write!(out, ".{}", shorten(key))?,
                Segment::Item(index) => write!(out, "[{index}]")?,
            }
        }
        Ok(())
    }
}
