//! Adds comments to the text of a study: meaning, unit, range and default of each key, and the
//! optional keys that it does not have.
//!
//! The text is in block style, with one key per line; a value on the line of its key stays as it is.

use std::collections::HashSet;

use serde_json::Value;

use crate::study::file::resolved_yaml::write_flow;
use crate::study::file::schema_place::{SchemaKey, SchemaPlace};
use crate::study::file::source::Source;
use crate::study::file::yaml_tree::{Content, YamlNode};

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

/// Returns the text of a source with comments. `defaults` is the resolved study of the same kind of model without any
/// optional key.
pub(super) fn annotate(source: &Source, schema: &Value, defaults: &Value) -> String {
    let lines: Vec<&str> = source.text.lines().collect();
    let mut annotator =
        Annotator { before: vec![String::new(); lines.len() + 1], lines, said: HashSet::new() };
    if let Some(blank) = annotator.lines.iter().position(|line| line.is_empty()) {
        annotator.before[blank].push_str("#\n");
        annotator.comment(blank, 0, LEGEND);
    }
    let root =
        Map { path: "", indent: 0, place: SchemaPlace::root(schema), defaults: Some(defaults) };
    annotator.map(&source.root, &root);
    let Annotator { lines, before, .. } = annotator;
    let each = before.into_iter().zip(lines.iter().map(Some).chain([None]));
    each.map(|(before, line)| before + &line.map_or_else(String::new, |line| format!("{line}\n")))
        .collect()
}

/// The text, and what is written before each of its lines and at its end.
struct Annotator<'t> {
    lines: Vec<&'t str>,
    before: Vec<String>,
    /// Every description and every list of choices so far.
    said: HashSet<String>,
}

/// A map of the study.
struct Map<'a> {
    /// Names of the keys that lead to it, separated by dots.
    path: &'a str,
    /// Blanks before its keys.
    indent: usize,
    place: SchemaPlace<'a>,
    /// Its default values.
    defaults: Option<&'a Value>,
}

impl Annotator<'_> {
    /// Annotates the keys of a map that has one key per line, and lists the keys that it lacks.
    fn map(&mut self, node: &YamlNode, map: &Map<'_>) {
        let Content::Map(entries) = &node.content else { return };
        for (key, value) in entries {
            let Some(known) = map.place.key(key.name()) else { continue };
            let line = key.place.line - 1;
            if let Some(about) = self.about(&known) {
                // The text's own comments on a key are below what is generated.
                let before = self.lines[..line].iter().rev();
                let comments = before.take_while(|line| line.trim_start().starts_with('#')).count();
                let is_item = self.lines[line].trim_start().starts_with("- ");
                // The dash of an entry is to the left of its first key.
                let indent = key.place.column - 1 - if is_item { 2 } else { 0 };
                self.comment(line - comments, indent, &about);
            }
            if value.place.line == key.place.line {
                continue;
            }
            let path = below(map.path, key.name());
            let defaults = map.defaults.and_then(|defaults| defaults.get(key.name()));
            let below = |node: &YamlNode, place| {
                let Content::Map(entries) = &node.content else { return None };
                let indent = entries.first()?.0.place.column - 1;
                Some(Map { path: &path, indent, place, defaults })
            };
            match &value.content {
                Content::List(items) => {
                    for item in items {
                        let inner = known.place.item().and_then(|place| below(item, place));
                        inner.iter().for_each(|inner| self.map(item, inner));
                    }
                }
                _ => {
                    let inner = below(value, known.place);
                    inner.iter().for_each(|inner| self.map(value, inner));
                }
            }
        }
        if COMPLETE.contains(&map.path) {
            self.missing_keys(node, map);
        }
    }

    /// Writes the optional keys that a map does not have, as comments.
    fn missing_keys(&mut self, node: &YamlNode, map: &Map<'_>) {
        let end = last_line(node);
        let mut without_default = Vec::new();
        for name in map.place.names() {
            let Some(key) = map.place.key(name).filter(|_| node.get(name).is_none()) else {
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
                    about.iter().for_each(|about| self.comment(end, map.indent, about));
                    self.before[end].push_str(&(line + "\n"));
                }
                None => without_default.push((name, about.unwrap_or_default())),
            }
        }
        if OF_MODEL.contains(&map.path) {
            return;
        }
        // A key that takes a value with its unit, such as `end_time` beside `end_time_s`, is not listed.
        let names = map.place.names();
        let has_unit = |name: &str| {
            let of_unit =
                |other: &&str| other.strip_prefix(name).is_some_and(|rest| rest.starts_with('_'));
            names.iter().any(of_unit)
        };
        without_default.retain(|(name, _)| !has_unit(name));
        if map.path.is_empty() && !without_default.is_empty() {
            self.before[end].push('\n');
            self.comment(end, 0, FURTHER);
        }
        for (name, about) in without_default {
            self.comment(end, map.indent, &format!("`{name}`: {about}"));
        }
    }

    /// Returns what is said about a key: its description, its choices, and a default that the description does not
    /// state. No description and no list of choices is said twice.
    fn about(&mut self, key: &SchemaKey<'_>) -> Option<String> {
        let description = key.description.filter(|about| self.said.insert((*about).to_owned()))?;
        let mut characters = description.chars();
        let first = characters.next()?;
        let mut about: String = first.to_uppercase().chain(characters).collect();
        let choices = format!(" Choices: {}.", key.place.choices().join(", "));
        if !key.place.choices().is_empty() && self.said.insert(choices.clone()) {
            about.push_str(&choices);
        }
        if let Some(default) = key.default.filter(|_| !description.contains("default")) {
            about.push_str(" Default: ");
            write_flow(default, &mut about);
            about.push('.');
        }
        Some(about)
    }

    /// Writes a comment before a line, counted from 0, in lines of limited width.
    fn comment(&mut self, line: usize, indent: usize, text: &str) {
        let out = &mut self.before[line];
        let margin = format!("{}#", " ".repeat(indent));
        let mut width = usize::MAX;
        for word in text.split_whitespace() {
            let characters = word.chars().count();
            if width.saturating_add(1 + characters) > WIDTH {
                if width != usize::MAX {
                    out.push('\n');
                }
                out.push_str(&margin);
                width = margin.len();
            }
            out.push(' ');
            out.push_str(word);
            width += 1 + characters;
        }
        out.push('\n');
    }
}

/// Returns the number of the last line of a value, from 1.
fn last_line(node: &YamlNode) -> usize {
    let below = match &node.content {
        Content::Map(entries) => entries.iter().map(|(_, value)| last_line(value)).max(),
        Content::List(items) => items.iter().map(last_line).max(),
        _ => None,
    };
    below.unwrap_or(0).max(node.place.line)
}

fn below(path: &str, key: &str) -> String {
    if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") }
}
