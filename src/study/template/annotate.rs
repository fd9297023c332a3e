//! Adds comments to the text of a study: meaning, unit, range and default of each key, and the
//! optional keys that it does not have.
//!
//! The text is in block style, with one key per line; a value on the line of its key stays as it is.

use serde_json::Value;

use super::schema_place::{SchemaKey, SchemaPlace};
use crate::study::file::resolved_yaml::write_flow;

/// The width of the text.
const WIDTH: usize = 100;

/// What the comments say, after the head.
const LEGEND: &str = "The comment above a key states its meaning, unit, range and default. A key after `#` is \
                      optional and shows its default: to change the value, remove the `#`.";

/// What is above the top-level keys that the text does not have.
const FURTHER: &str = "Further optional keys (`stickslip schema` describes them in full):";

/// Maps whose missing keys are listed, by key path; the root has the empty path.
const COMPLETE: [&str; 7] = [
    "",
    "model",
    "model.parameters",
    "initial_conditions",
    "simulation",
    "simulation.tolerance",
    "optimize",
];

/// Maps whose missing keys are listed only if this kind of model has a default for them.
const OF_MODEL: [&str; 2] = ["model", "model.parameters"];

/// Returns the text with comments. `defaults` is the resolved study of the same kind of model without any optional key.
pub(super) fn annotate(text: &str, schema: &Value, defaults: &Value) -> String {
    let root = Map {
        indent: 0,
        path: String::new(),
        place: Some(SchemaPlace::root(schema)),
        defaults: Some(defaults),
        keys: Vec::new(),
        open: None,
    };
    let mut annotator = Annotator { maps: vec![root], ..Annotator::default() };
    let (head, body) = text.split_once("\n\n").unwrap_or(("", text));
    if !head.is_empty() {
        annotator.out.push_str(head);
        annotator.out.push_str("\n#\n");
        annotator.comment(0, LEGEND);
        annotator.out.push('\n');
    }
    body.lines().for_each(|line| annotator.line(line));
    annotator.close_maps(|_| true);
    annotator.out
}

/// The text so far, and the maps around its end.
#[derive(Default)]
struct Annotator<'a> {
    out: String,
    /// Maps that contain the next line, the outermost first.
    maps: Vec<Map<'a>>,
    /// Blank lines and comments that belong to the next key.
    before_key: String,
    /// Every description and every list of choices so far.
    written: Vec<String>,
}

/// A map of the study.
struct Map<'a> {
    /// Blanks before its keys.
    indent: usize,
    /// Names of the keys that lead to it, separated by dots.
    path: String,
    place: Option<SchemaPlace<'a>>,
    /// Its default values.
    defaults: Option<&'a Value>,
    /// Keys so far.
    keys: Vec<String>,
    /// The last key, if its value begins on the next line.
    open: Option<Open<'a>>,
}

/// A key whose value begins on the next line.
#[derive(Clone)]
struct Open<'a> {
    path: String,
    place: Option<SchemaPlace<'a>>,
    defaults: Option<&'a Value>,
}

/// A line that begins with a key.
struct KeyLine<'a> {
    /// Blanks and dash before the key.
    indent: usize,
    /// Whether the key is the first of an entry of a list.
    begins_item: bool,
    key: &'a str,
    /// Whether the value begins on the next line.
    opens: bool,
}

impl<'a> KeyLine<'a> {
    fn parse(line: &'a str) -> Option<Self> {
        let rest = line.trim_start_matches(' ');
        let (begins_item, rest) =
            rest.strip_prefix("- ").map_or((false, rest), |rest| (true, rest));
        let (key, value) = rest.split_once(':')?;
        let usual = |character: char| character.is_ascii_alphanumeric() || character == '_';
        let is_key = !key.is_empty() && key.chars().all(usual);
        let indent = line.len() - rest.len();
        is_key.then_some(KeyLine { indent, begins_item, key, opens: value.trim().is_empty() })
    }
}

impl<'a> Annotator<'a> {
    fn line(&mut self, line: &str) {
        if line.trim().is_empty() || line.trim_start().starts_with('#') {
            self.before_key.push_str(line);
            self.before_key.push('\n');
            return;
        }
        match KeyLine::parse(line) {
            Some(key_line) => self.begin_key(&key_line),
            None => self.out.push_str(&std::mem::take(&mut self.before_key)),
        }
        self.out.push_str(line);
        self.out.push('\n');
    }

    /// Writes what stands above a key.
    fn begin_key(&mut self, line: &KeyLine<'_>) {
        let indent = line.indent;
        self.close_maps(|map| map.indent > indent || line.begins_item && map.indent == indent);
        self.open_map(line);
        let Some(map) = self.maps.last_mut() else { return };
        map.keys.push(line.key.to_owned());
        let key = map.place.as_ref().and_then(|place| place.key(line.key));
        map.open = line.opens.then(|| Open {
            path: below(&map.path, line.key),
            place: key.as_ref().map(|key| key.place.clone()),
            defaults: map.defaults.and_then(|defaults| defaults.get(line.key)),
        });
        // What stands above the last blank line, what is generated, and the text's own comments on the key.
        let own = std::mem::take(&mut self.before_key);
        let blank = own.rfind("\n\n").map_or(usize::from(own.starts_with('\n')), |place| place + 2);
        let (before, comments) = own.split_at(blank);
        self.out.push_str(before);
        if let Some(comment) = key.and_then(|key| self.about(&key)) {
            // The dash of an entry is to the left of its first key.
            self.comment(indent - if line.begins_item { 2 } else { 0 }, &comment);
        }
        self.out.push_str(comments);
    }

    /// Opens the map that a key is the first of.
    fn open_map(&mut self, line: &KeyLine<'_>) {
        let Some(outer) = self.maps.last() else { return };
        if outer.indent == line.indent {
            return;
        }
        let Some(Open { path, place, defaults }) = outer.open.clone() else { return };
        let place =
            place.and_then(|place| if line.begins_item { place.item() } else { Some(place) });
        self.maps.push(Map {
            indent: line.indent,
            path,
            place,
            defaults,
            keys: Vec::new(),
            open: None,
        });
    }

    /// Closes the innermost maps of a kind, after the keys that they lack.
    fn close_maps(&mut self, is_over: impl Fn(&Map<'a>) -> bool) {
        while let Some(map) = self.maps.pop_if(|map| is_over(map)) {
            self.missing_keys(&map);
        }
    }

    /// Writes the optional keys that a map does not have, as comments.
    fn missing_keys(&mut self, map: &Map<'a>) {
        let Some(place) = map.place.as_ref().filter(|_| COMPLETE.contains(&map.path.as_str()))
        else {
            return;
        };
        let mut without_default = Vec::new();
        for name in place.names() {
            let Some(key) = place.key(name).filter(|_| !map.keys.iter().any(|own| own == name))
            else {
                continue;
            };
            let default = map.defaults.and_then(|defaults| defaults.get(name));
            let about = self.about(&key);
            let line = default.map(|default| {
                let mut line = format!("{}# {name}: ", " ".repeat(map.indent));
                write_flow(default, &mut line);
                line
            });
            match line.filter(|line| line.len() <= WIDTH) {
                Some(line) => {
                    about.iter().for_each(|about| self.comment(map.indent, about));
                    self.out.push_str(&line);
                    self.out.push('\n');
                }
                None => without_default.push((name, about.unwrap_or_default())),
            }
        }
        if OF_MODEL.contains(&map.path.as_str()) {
            return;
        }
        // A key that takes a value with its unit, such as `end_time` beside `end_time_s`, is not listed.
        let names = place.names();
        let has_unit = |name: &str| {
            let of_unit =
                |other: &&str| other.strip_prefix(name).is_some_and(|rest| rest.starts_with('_'));
            names.iter().any(of_unit)
        };
        without_default.retain(|(name, _)| !has_unit(name));
        if map.path.is_empty() && !without_default.is_empty() {
            self.out.push('\n');
            self.comment(0, FURTHER);
        }
        for (name, about) in without_default {
            self.comment(map.indent, &format!("`{name}`: {about}"));
        }
    }

    /// Returns what is said about a key: its description, its choices, and a default that the description does not
    /// state. No description and no list of choices is said twice.
    fn about(&mut self, key: &SchemaKey<'_>) -> Option<String> {
        let description = key.description.filter(|about| !self.is_written(about))?;
        let mut characters = description.chars();
        let first = characters.next()?;
        let mut about: String = first.to_uppercase().chain(characters).collect();
        let choices = format!(" Choices: {}.", key.place.choices().join(", "));
        if !key.place.choices().is_empty() && !self.is_written(&choices) {
            about.push_str(&choices);
        }
        if let Some(default) = key.default.filter(|_| !description.contains("default")) {
            about.push_str(" Default: ");
            write_flow(default, &mut about);
            about.push('.');
        }
        Some(about)
    }

    /// Returns whether this has been asked before about the same text.
    fn is_written(&mut self, text: &str) -> bool {
        let known = self.written.iter().any(|written| written == text);
        if !known {
            self.written.push(text.to_owned());
        }
        known
    }

    /// Writes a comment in lines of limited width.
    fn comment(&mut self, indent: usize, text: &str) {
        let margin = format!("{}#", " ".repeat(indent));
        let mut width = usize::MAX;
        for word in text.split_whitespace() {
            let characters = word.chars().count();
            if width.saturating_add(1 + characters) > WIDTH {
                if width != usize::MAX {
                    self.out.push('\n');
                }
                self.out.push_str(&margin);
                width = margin.len();
            }
            self.out.push(' ');
            self.out.push_str(word);
            width += 1 + characters;
        }
        self.out.push('\n');
    }
}

fn below(path: &str, key: &str) -> String {
    if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") }
}
