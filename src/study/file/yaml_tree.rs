//! A YAML text as a tree of values with their lines and columns.
//!
//! The budgets of the YAML parser stop alias bombs and deep nesting. Duplicate keys are errors.

use std::collections::HashSet;
use std::fmt;

use serde::de::value::SeqAccessDeserializer;
use serde::de::{Deserialize, Deserializer, Error as _, MapAccess, SeqAccess, Visitor};
use serde_saphyr::Spanned;
use serde_saphyr::options::{DuplicateKeyPolicy, MergeKeyPolicy, NonFiniteFloatPolicy};

use crate::study::error::{Location, describe_number, shorten};
use crate::study::file::key_path::{KeyPath, Segment};
use crate::study::file::key_units::without_unit;

/// The largest study file, and the largest table that a study names, in bytes.
pub(crate) const MAX_FILE_BYTES: u64 = 64 * 1024 * 1024;

/// The largest number of values in one study file.
pub(super) const MAX_NODES: usize = 3_000_000;

/// The deepest nesting of maps and lists; a study needs eight levels.
pub(super) const MAX_DEPTH: usize = 24;

/// A value and its place.
#[derive(Clone, Debug)]
pub(crate) struct YamlNode {
    /// Where the value starts; for an alias, where it is used.
    pub place: Location,
    /// The value.
    pub content: Content,
}

/// The content of a node.
#[derive(Clone, Debug)]
pub(crate) enum Content {
    /// Nothing: an empty value, `null` or `~`.
    Nothing,
    /// In the place of a missing key, while further missing keys are searched.
    Placeholder,
    /// `true` or `false`.
    Truth(bool),
    /// A whole number, zero or more.
    Natural(u64),
    /// Any other number, possibly not finite.
    Number(f64),
    /// Text.
    Text(String),
    /// A list.
    List(Vec<YamlNode>),
    /// A map in the order of the file; its keys are texts.
    Map(Vec<(YamlNode, YamlNode)>),
}

/// Parses a text within the limits of a study file.
pub(super) fn parsed(
    text: &str,
    duplicates: DuplicateKeyPolicy,
) -> Result<YamlNode, serde_saphyr::Error> {
    let options = serde_saphyr::options! {
        budget: serde_saphyr::budget! {
            max_depth: MAX_DEPTH,
            flow_nesting_limit: MAX_DEPTH,
            max_nodes: MAX_NODES,
            max_events: 2 * MAX_NODES,
            max_aliases: 1_000,
            max_anchors: 1_000,
            max_recorded_anchor_events: 100_000,
            max_documents: 2,
        },
        alias_limits: serde_saphyr::alias_limits! {
            max_total_replayed_events: 100_000,
        },
        duplicate_keys: duplicates,
        merge_keys: MergeKeyPolicy::Error,
        non_finite_float_policy: NonFiniteFloatPolicy::PassThrough,
        strict_booleans: true,
        with_snippet: false,
    };
    serde_saphyr::from_str_with_options(text, options)
}

impl YamlNode {
    /// Describes the content in words for a message.
    pub fn describe(&self) -> String {
        match &self.content {
            Content::Nothing | Content::Placeholder => "nothing".to_owned(),
            Content::Truth(truth) => truth.to_string(),
            Content::Natural(number) => number.to_string(),
            Content::Number(number) if number.is_nan() => ".nan".to_owned(),
            Content::Number(number) if number.is_infinite() => {
                format!("{}.inf (or too large a number)", if *number < 0.0 { "-" } else { "" })
            }
            Content::Number(number) => {
                // The file contains a point or an exponent: without them, a whole number that is not negative is natural.
                let text = describe_number(*number);
                let looks_natural = text.bytes().all(|byte| byte.is_ascii_digit());
                if looks_natural { text + ".0" } else { text }
            }
            Content::Text(text) => format!("text {:?}", shorten(text)),
            Content::List(items) => format!("a list of {}", items.len()),
            Content::Map(entries) => {
                let names: Vec<&str> = entries.iter().take(8).map(|(key, _)| key.name()).collect();
                shorten(&format!("keys {}", names.join(", ")))
            }
        }
    }

    /// Returns the keys and their places, without lists of values, which may be long.
    pub fn outline(&self) -> YamlNode {
        let is_map = |item: &YamlNode| matches!(item.content, Content::Map(_));
        let content = match &self.content {
            Content::Map(entries) => {
                let outline = |(key, value): &(YamlNode, YamlNode)| (key.clone(), value.outline());
                Content::Map(entries.iter().map(outline).collect())
            }
            Content::List(items) if items.first().is_none_or(|first| !is_map(first)) => {
                Content::List(Vec::new())
            }
            Content::List(items) => Content::List(items.iter().map(YamlNode::outline).collect()),
            other => other.clone(),
        };
        YamlNode { place: self.place, content }
    }

    /// Returns the name of a key; empty if this is not a text.
    pub fn name(&self) -> &str {
        if let Content::Text(name) = &self.content { name } else { "" }
    }

    /// Returns the value of a key, if this is a map with this key.
    pub fn get(&self, key: &str) -> Option<&YamlNode> {
        Some(self.below(&Segment::Key(key.to_owned()))?.1)
    }

    /// Returns the key and the value one step below; the key of a list's item is the item itself. A key with a unit may be
    /// written without it.
    pub fn below(&self, step: &Segment) -> Option<(&YamlNode, &YamlNode)> {
        match (step, &self.content) {
            (Segment::Key(name), Content::Map(entries)) => {
                let is_short = |key: &YamlNode| without_unit(name).contains(&key.name());
                let exact = entries.iter().find(|(key, _)| key.name() == name);
                let found = exact.or_else(|| entries.iter().find(|(key, _)| is_short(key)))?;
                Some((&found.0, &found.1))
            }
            (Segment::Item(index), Content::List(items)) => {
                items.get(*index).map(|item| (item, item))
            }
            _ => None,
        }
    }

    /// Returns the value at a path.
    pub fn at(&self, path: &KeyPath) -> Option<&YamlNode> {
        path.0.iter().try_fold(self, |node, step| Some(node.below(step)?.1))
    }

    /// Returns a path with the keys as the file writes them.
    pub fn as_written(&self, path: &KeyPath) -> KeyPath {
        let mut node = Some(self);
        let written = |step: &Segment| {
            let below = node.and_then(|node| node.below(step));
            node = below.map(|(_, value)| value);
            match (step, below) {
                (Segment::Key(_), Some((key, _))) => Segment::Key(key.name().to_owned()),
                _ => step.clone(),
            }
        };
        KeyPath(path.0.iter().map(written).collect())
    }

    /// Returns the value at a path, in which keys are exactly as the file writes them.
    pub fn at_mut(&mut self, path: &[Segment]) -> Option<&mut YamlNode> {
        let mut node = self;
        for step in path {
            node = match (step, &mut node.content) {
                (Segment::Key(name), Content::Map(entries)) => {
                    entries.iter_mut().find(|(key, _)| key.name() == name).map(|(_, value)| value)
                }
                (Segment::Item(index), Content::List(items)) => items.get_mut(*index),
                _ => None,
            }?;
        }
        Some(node)
    }

    /// Inserts a value at the path of a missing key, if this tree has a map there.
    pub fn insert(&mut self, path: &KeyPath, value: YamlNode) {
        let Some((Segment::Key(name), above)) = path.0.split_last() else { return };
        let Some(node) = self.at_mut(above) else { return };
        // A placeholder with a key is a map with this key alone.
        if let Content::Placeholder = node.content {
            node.content = Content::Map(Vec::new());
        }
        if let Content::Map(entries) = &mut node.content {
            let key = YamlNode { place: value.place, content: Content::Text(name.clone()) };
            entries.push((key, value));
        }
    }

    /// Returns the first key or value in this tree that is wanted, with its path.
    pub fn find(&self, wanted: &dyn Fn(&YamlNode) -> bool) -> Option<(KeyPath, &YamlNode)> {
        if wanted(self) {
            return Some((KeyPath::default(), self));
        }
        let (step, (mut path, node)) = match &self.content {
            Content::List(items) => items
                .iter()
                .enumerate()
                .find_map(|(index, item)| Some((Segment::Item(index), item.find(wanted)?)))?,
            Content::Map(entries) => entries.iter().find_map(|(key, value)| {
                let found = key.find(wanted).or_else(|| value.find(wanted))?;
                Some((Segment::Key(key.name().to_owned()), found))
            })?,
            _ => return None,
        };
        path.0.insert(0, step);
        Some((path, node))
    }
}

impl<'de> Deserialize<'de> for YamlNode {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<YamlNode, D::Error> {
        let spanned: Spanned<Content> = Spanned::deserialize(deserializer)?;
        Ok(YamlNode { place: place_of(&spanned.referenced)?, content: spanned.value })
    }
}

fn place_of<E: serde::de::Error>(location: &serde_saphyr::Location) -> Result<Location, E> {
    let number = |value: u64| usize::try_from(value).map_err(E::custom);
    Ok(Location { line: number(location.line())?, column: number(location.column())? })
}

impl<'de> Deserialize<'de> for Content {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Content, D::Error> {
        deserializer.deserialize_any(ContentVisitor)
    }
}

struct ContentVisitor;

impl<'de> Visitor<'de> for ContentVisitor {
    type Value = Content;

    fn expecting(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str("a YAML value")
    }

    fn visit_unit<E>(self) -> Result<Content, E> {
        Ok(Content::Nothing)
    }

    fn visit_none<E>(self) -> Result<Content, E> {
        Ok(Content::Nothing)
    }

    fn visit_bool<E>(self, value: bool) -> Result<Content, E> {
        Ok(Content::Truth(value))
    }

    fn visit_u64<E>(self, value: u64) -> Result<Content, E> {
        Ok(Content::Natural(value))
    }

    fn visit_i64<E>(self, value: i64) -> Result<Content, E> {
        Ok(u64::try_from(value).map_or(Content::Number(value as f64), Content::Natural))
    }

    fn visit_f64<E>(self, value: f64) -> Result<Content, E> {
        Ok(Content::Number(value))
    }

    fn visit_str<E>(self, value: &str) -> Result<Content, E> {
        Ok(Content::Text(value.to_owned()))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, list: A) -> Result<Content, A::Error> {
        Vec::deserialize(SeqAccessDeserializer::new(list)).map(Content::List)
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Content, A::Error> {
        let (mut entries, mut names) = (Vec::new(), HashSet::new());
        while let Some(key) = map.next_key::<Spanned<String>>()? {
            let place = place_of(&key.referenced)?;
            // The parser distinguishes keys by tag, and numbers from texts.
            if !names.insert(key.value.clone()) {
                return Err(A::Error::custom(
                    "the same key is given twice, with another tag or notation",
                ));
            }
            if entries.len() >= 10_000 {
                return Err(A::Error::custom("more than 10000 keys in one map"));
            }
            entries
                .push((YamlNode { place, content: Content::Text(key.value) }, map.next_value()?));
        }
        Ok(Content::Map(entries))
    }
}
