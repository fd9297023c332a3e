//! The text of a study file as a tree of values with their lines and columns.
//!
//! The budgets of the YAML parser stop alias bombs and deep nesting. Duplicate keys are errors.

use std::fmt;
use std::path::{Path, PathBuf};

use serde::de::{Deserialize, Deserializer, Error as _, MapAccess, SeqAccess, Visitor};
use serde_saphyr::Spanned;
use serde_saphyr::options::{DuplicateKeyPolicy, MergeKeyPolicy, NonFiniteFloatPolicy};

use crate::study::error::{Fault, Locate, Location, Spot, StudyError, shorten};
use crate::study::file::key_path::{KeyPath, Segment};

/// The largest study file, and the largest table that a study names, in bytes.
pub(crate) const MAX_FILE_BYTES: u64 = 64 * 1024 * 1024;

/// The largest number of values in one study file.
const MAX_NODES: usize = 3_000_000;

/// The deepest nesting of maps and lists; a study needs eight levels.
const MAX_DEPTH: usize = 24;

/// A value and its place.
#[derive(Clone, Debug)]
pub(crate) struct Node {
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
    /// `true` or `false`.
    Truth(bool),
    /// A whole number, zero or more.
    Natural(u64),
    /// A negative whole number.
    Negative(i64),
    /// Any other number, possibly not finite.
    Number(f64),
    /// Text.
    Text(String),
    /// A list.
    List(Vec<Node>),
    /// A map in the order of the file.
    Map(Vec<(Key, Node)>),
}

/// A key of a map and its place.
#[derive(Clone, Debug)]
pub(crate) struct Key {
    /// The key.
    pub name: String,
    /// Where the key starts.
    pub place: Location,
}

/// The text of a study file, its tree and its name, which a message needs.
pub(crate) struct Source {
    file: PathBuf,
    text: String,
    /// The whole file.
    pub root: Node,
}

impl Source {
    /// Parses a text into a tree.
    ///
    /// # Errors
    /// Returns an error if the text is empty, is not YAML, contains more than one document, is too
    /// deep or too large, repeats a key, or contains a number that is not finite.
    pub fn new(file: &Path, text: String) -> Result<Source, StudyError> {
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
            duplicate_keys: DuplicateKeyPolicy::Error,
            merge_keys: MergeKeyPolicy::Error,
            non_finite_float_policy: NonFiniteFloatPolicy::PassThrough,
            strict_booleans: true,
            with_snippet: false,
        };
        let parsed: Result<Node, _> = serde_saphyr::from_str_with_options(&text, options);
        match parsed {
            Ok(root) => {
                let source = Source { file: file.to_path_buf(), text, root };
                source.check_top()?;
                source.check_finite()?;
                Ok(source)
            }
            Err(error) => Err(reader_error(file, &text, error.without_snippet())),
        }
    }

    fn check_top(&self) -> Result<(), StudyError> {
        match self.root.content {
            Content::Map(_) => Ok(()),
            Content::Nothing => Err(StudyError::about_file(
                &self.file,
                Fault::new("the file is empty", "no keys", "a study, starting with `schema: 1`"),
            )),
            _ => Err(self.refuse_value(
                &KeyPath::default(),
                Fault::new(
                    "not a study",
                    self.root.describe(),
                    "keys and values, starting with `schema: 1`",
                ),
            )),
        }
    }

    fn check_finite(&self) -> Result<(), StudyError> {
        let Some((mut steps, node)) = self.root.first_not_finite() else { return Ok(()) };
        steps.reverse();
        let fault = Fault::new("not a finite number", node.describe(), "a finite number");
        Err(self.refuse_at(node.place, &KeyPath(steps), fault))
    }

    /// Creates the message for a fault at a known place.
    pub fn refuse_at(&self, place: Location, path: &KeyPath, fault: Fault) -> StudyError {
        let line = self.text.lines().nth(place.line.saturating_sub(1));
        StudyError::new(&self.file, Some(place), path.to_string(), fault, line)
    }

    /// Returns the place of a path, or of its deepest part that the file contains.
    fn place(&self, path: &KeyPath, spot: Spot) -> Location {
        let mut node = &self.root;
        let mut place = node.place;
        for step in &path.0 {
            match (step, &node.content) {
                (Segment::Key(name), Content::Map(entries)) => {
                    let Some((key, value)) = entries.iter().find(|(key, _)| key.name == *name)
                    else {
                        return place;
                    };
                    node = value;
                    place = if spot == Spot::Key { key.place } else { node.place };
                }
                (Segment::Item(index), Content::List(items)) => {
                    let Some(item) = items.get(*index) else { return place };
                    node = item;
                    place = node.place;
                }
                _ => return place,
            }
        }
        place
    }
}

impl Locate for Source {
    fn refuse(&self, path: &KeyPath, spot: Spot, fault: Fault) -> StudyError {
        self.refuse_at(self.place(path, spot), path, fault)
    }
}

fn reader_error(file: &Path, text: &str, error: &serde_saphyr::Error) -> StudyError {
    use serde_saphyr::Error;
    let place = error.location().map(|location| Location {
        line: usize::try_from(location.line()).unwrap_or(1).max(1),
        column: usize::try_from(location.column()).unwrap_or(1).max(1),
    });
    let mut key = String::new();
    let said = error.to_string();
    let said = shorten(said.split(" at line ").next().unwrap_or_default());
    let fault = match error {
        Error::DuplicateMappingKey { key: name, .. } => {
            key = name.as_deref().map(shorten).unwrap_or_default();
            Fault::new("the key is given twice", "a second value for the same key", "each key once")
        }
        Error::MultipleDocuments { .. } => {
            Fault::new("more than one YAML document", "a further document", "one study per file")
        }
        Error::MergeKeyNotAllowed { .. } => {
            Fault::new("merge keys are not supported", "<<", "every key written out")
        }
        _ if ["budget", "recursion limit", "alias replay", "alias expansion"]
            .iter()
            .any(|limit| said.contains(limit)) =>
        {
            let allowed = format!(
                "at most {MAX_NODES} values, {MAX_DEPTH} levels of nesting and few, small aliases"
            );
            Fault::new("too large or too deep a file, or too many aliases", said, allowed)
        }
        _ => Fault::new("not valid YAML", said, "a study in YAML"),
    };
    let line = place.and_then(|place| text.lines().nth(place.line - 1));
    StudyError::new(file, place, key, fault, line)
}

impl Node {
    /// Describes the content in words for a message.
    pub fn describe(&self) -> String {
        match &self.content {
            Content::Nothing => "nothing".to_owned(),
            Content::Truth(truth) => truth.to_string(),
            Content::Natural(number) => number.to_string(),
            Content::Negative(number) => number.to_string(),
            Content::Number(number) if number.is_nan() => ".nan".to_owned(),
            Content::Number(number) if number.is_infinite() => {
                format!("{}.inf (or too large a number)", if *number < 0.0 { "-" } else { "" })
            }
            Content::Number(number) => describe_number(*number),
            Content::Text(text) => format!("text {:?}", shorten(text)),
            Content::List(items) => format!("a list of {}", items.len()),
            Content::Map(entries) => {
                let names: Vec<&str> =
                    entries.iter().take(8).map(|(key, _)| key.name.as_str()).collect();
                shorten(&format!("keys {}", names.join(", ")))
            }
        }
    }

    /// Returns the first number that is not finite, with the steps to it from the last to the
    /// first.
    fn first_not_finite(&self) -> Option<(Vec<Segment>, &Node)> {
        let (step, (mut steps, node)) = match &self.content {
            Content::Number(number) if !number.is_finite() => return Some((Vec::new(), self)),
            Content::List(items) => items
                .iter()
                .enumerate()
                .find_map(|(index, item)| Some((Segment::Item(index), item.first_not_finite()?)))?,
            Content::Map(entries) => entries.iter().find_map(|(key, value)| {
                let found = value.first_not_finite()?;
                Some((Segment::Key(key.name.clone()), found))
            })?,
            _ => return None,
        };
        steps.push(step);
        Some((steps, node))
    }
}

/// Formats a number for a message: plain, or with an exponent if that is shorter.
pub(crate) fn describe_number(number: f64) -> String {
    let size = number.abs();
    if size != 0.0 && !(1.0e-4..1.0e15).contains(&size) {
        format!("{number:e}")
    } else {
        number.to_string()
    }
}

impl<'de> Deserialize<'de> for Node {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Node, D::Error> {
        let spanned: Spanned<Content> = Spanned::deserialize(deserializer)?;
        Ok(Node { place: place_of(&spanned.referenced)?, content: spanned.value })
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
        Ok(u64::try_from(value).map_or(Content::Negative(value), Content::Natural))
    }

    fn visit_f64<E>(self, value: f64) -> Result<Content, E> {
        Ok(Content::Number(value))
    }

    fn visit_str<E>(self, value: &str) -> Result<Content, E> {
        Ok(Content::Text(value.to_owned()))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Content, A::Error> {
        let mut items = Vec::new();
        while let Some(item) = list.next_element()? {
            items.push(item);
        }
        Ok(Content::List(items))
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Content, A::Error> {
        let mut entries: Vec<(Key, Node)> = Vec::new();
        while let Some(key) = map.next_key::<Spanned<String>>()? {
            let key = Key { place: place_of(&key.referenced)?, name: key.value };
            if entries.len() >= 10_000 {
                return Err(A::Error::custom("more than 10000 keys in one map"));
            }
            entries.push((key, map.next_value()?));
        }
        Ok(Content::Map(entries))
    }
}
