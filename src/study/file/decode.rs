//! Deserialisation of located values into the types of the study file, with located errors.
//!
//! serde-saphyr alone does not give these messages: it reads the text `"0.3"` as a number and the number 12 as text, its
//! errors name neither the key path nor the value found, and later checks of the content need the place of any key.

use std::ptr;

use serde::de::value::{
    BorrowedStrDeserializer, MapDeserializer, SeqDeserializer, StrDeserializer,
};
use serde::de::{
    DeserializeOwned, DeserializeSeed, Deserializer, EnumAccess, Error as _, Expected,
    IntoDeserializer, Unexpected, VariantAccess, Visitor,
};
use serde::forward_to_deserialize_any;

use crate::model::WRITTEN;
use crate::study::error::{Fault, Location, StudyError, list_names, shorten};
use crate::study::file::friction_file::example_of_friction;
use crate::study::file::key_path::{KeyPath, Segment};
use crate::study::file::key_units::{WITHOUT_UNIT, list_keys};
use crate::study::file::schema_place::SchemaPlace;
use crate::study::file::source::Source;
use crate::study::file::unit_keys::{Keys, Names, UnitKey};
use crate::study::file::yaml_tree::{Content, YamlNode};

/// Deserialises a value of type `T` from the whole source, with the bounds of numbers that `place` declares.
pub(in crate::study) fn decode<T: DeserializeOwned>(
    source: &Source,
    names: &Names,
    place: Option<SchemaPlace<'static>>,
) -> Result<T, StudyError> {
    let read = |root: &YamlNode| read(root, source, names, place);
    let (key, error) = match read(&source.root) {
        Ok(value) => return Ok(value),
        Err((None, error)) => return Err(error),
        Err((Some(key), error)) => (key, error),
    };
    // Each missing key becomes a placeholder, and the next reading finds the next missing key.
    let (mut missing, mut root) = (vec![key.clone()], source.root.clone());
    while missing.len() < MOST_MISSING {
        if let Some(path) = missing.last() {
            root.insert(path, YamlNode { place: root.place, content: Content::Placeholder });
        }
        match read(&root) {
            Err((Some(key), _)) if !missing.contains(&key) => missing.push(key),
            // A wrong value is said before what is missing.
            Err((None, error)) => return Err(error),
            _ => break,
        }
    }
    // A missing key contains the missing keys below it.
    let all = missing.clone();
    missing.retain(|path| {
        !all.iter().any(|other| other.0.len() < path.0.len() && path.0.starts_with(&other.0))
    });
    if missing.len() == 1 {
        return Err(match EXAMPLES.iter().find(|(name, _)| *name == key.to_string()) {
            Some((name, example)) => {
                let name = name.rsplit('.').next().unwrap_or(name);
                let allowed = format!("a value for `{name}`, such as {example}");
                error.with_fault(Fault::new("missing key", "no such key", allowed))
            }
            None => error,
        });
    }
    let names: Vec<String> =
        missing.iter().map(|path| format!("`{}`", source.root.as_written(path))).collect();
    let examples: Vec<String> = missing
        .iter()
        .map(|path| {
            let key = path.to_string();
            let example = EXAMPLES.iter().find(|(name, _)| *name == key);
            example.map_or_else(|| format!("{key}: ..."), |(_, example)| (*example).to_owned())
        })
        .collect();
    let found = format!("no {}", names.join(", no "));
    let fault = Fault::new("missing keys", found, format!("such as {}", examples.join("; ")));
    Err(error.with_fault(fault))
}

/// The largest number of missing keys that a message lists.
const MOST_MISSING: usize = 20;

/// Examples of keys that every study needs.
const EXAMPLES: [(&str, &str); 6] = [
    ("schema", "schema: 1"),
    ("name", "name: my-study"),
    ("seed", "seed: 1"),
    ("model", "model: {kind: ball_balancer}"),
    ("model.kind", "model: {kind: ball_balancer}"),
    ("initial_conditions", "initial_conditions: {design: {monte_carlo: {samples: 100}}}"),
];

/// Reads a tree; an error comes with the path of the key if a key is missing.
fn read<T: DeserializeOwned>(
    root: &YamlNode,
    source: &Source,
    names: &Names,
    place: Option<SchemaPlace<'static>>,
) -> Result<T, (Option<KeyPath>, StudyError)> {
    T::deserialize(At { node: root, names, keys: None, unit: None, place }).map_err(|error| {
        let node = error.node.unwrap_or(root);
        let found = root.find(&|other| ptr::eq(other, node));
        let mut path = found.map_or_else(KeyPath::default, |(path, _)| path);
        path.0.extend(error.missing.map(|field| Segment::Key(field.to_owned())));
        let is_missing = error.missing.is_some() || matches!(node.content, Content::Placeholder);
        let missing = is_missing.then(|| path.clone());
        (missing, source.refuse_at(error.place.unwrap_or(node.place), &path, error.fault))
    })
}

/// The problem of a key that its map does not have.
const UNKNOWN: &str = "unknown key";

/// A fault of a node. The innermost level that knows the node adds it.
#[derive(Debug)]
pub(crate) struct DecodeError<'de> {
    /// The key or value whose path the message shows.
    node: Option<&'de YamlNode>,
    /// The place that the message shows if it is not the place of the node.
    place: Option<Location>,
    /// The missing key below the node.
    missing: Option<&'static str>,
    fault: Fault,
}

impl<'de> DecodeError<'de> {
    fn new(fault: Fault) -> DecodeError<'de> {
        DecodeError { node: None, place: None, missing: None, fault }
    }

    fn with_allowed(problem: &str, allowed: &dyn Expected) -> DecodeError<'de> {
        let allowed = Some(plain(allowed));
        DecodeError::new(Fault { problem: problem.to_owned(), found: None, allowed })
    }

    /// Adds the node, and its content as the value found, unless an inner level has added its own.
    fn at(mut self, node: &'de YamlNode) -> DecodeError<'de> {
        if self.node.is_none() {
            self.node = Some(node);
            self.fault.found.get_or_insert_with(|| node.describe());
        }
        self
    }
}

impl std::fmt::Display for DecodeError<'_> {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        out.write_str(&self.fault.problem)
    }
}

impl std::error::Error for DecodeError<'_> {}

impl serde::de::Error for DecodeError<'_> {
    fn custom<T: std::fmt::Display>(problem: T) -> Self {
        DecodeError::new(Fault { problem: problem.to_string(), found: None, allowed: None })
    }

    fn invalid_type(_: Unexpected<'_>, allowed: &dyn Expected) -> Self {
        DecodeError::with_allowed("wrong type", allowed)
    }

    fn invalid_value(_: Unexpected<'_>, allowed: &dyn Expected) -> Self {
        DecodeError::with_allowed("not allowed here", allowed)
    }

    fn invalid_length(length: usize, allowed: &dyn Expected) -> Self {
        let found = format!("a list of {length}");
        DecodeError::new(Fault::new("wrong number of values", found, plain(allowed)))
    }

    fn unknown_variant(found: &str, allowed: &'static [&'static str]) -> Self {
        DecodeError::new(Fault::new("unknown choice", shorten(found), list_names(found, allowed)))
    }

    fn unknown_field(found: &str, allowed: &'static [&'static str]) -> Self {
        DecodeError::new(Fault::new(UNKNOWN, shorten(found), list_keys(found, allowed)))
    }

    fn missing_field(field: &'static str) -> Self {
        let fault = Fault::new("missing key", "no such key", format!("a value for `{field}`"));
        DecodeError { missing: Some(field), ..DecodeError::new(fault) }
    }
}

fn plain(allowed: &dyn Expected) -> String {
    let text = allowed.to_string();
    match text.as_str() {
        "f64" => "a number".to_owned(),
        "u64" => "a whole number from 0 to 2^64 - 1".to_owned(),
        "a string" => "text (quote it if it looks like a number)".to_owned(),
        "a sequence" => "a list".to_owned(),
        "a map" => "names and values".to_owned(),
        _ if text.starts_with("struct ") => "keys and values".to_owned(),
        _ => text,
    }
}

/// A value, and how it is read.
#[derive(Clone, Copy)]
struct At<'de> {
    node: &'de YamlNode,
    names: &'de Names,
    /// The keys of a map, if they are names of the model.
    keys: Option<Keys>,
    /// The key around it that has a unit.
    unit: Option<UnitKey<'de>>,
    /// What its type declares, unless the model decides which values are possible.
    place: Option<SchemaPlace<'static>>,
}

impl<'de> At<'de> {
    /// Returns an item of this list.
    fn item(self, node: &'de YamlNode) -> At<'de> {
        At { node, keys: None, ..self }
    }

    /// Checks that a number is within the bounds that its type declares.
    fn check_bounds(self, number: f64) -> Result<(), DecodeError<'de>> {
        let allowed = self.place.and_then(|place| place.allowed_instead_of(number));
        let fault = |allowed| Fault::new("out of range", self.node.describe(), allowed);
        allowed.map_or(Ok(()), |allowed| Err(DecodeError::new(fault(allowed)).at(self.node)))
    }

    /// Returns the SI name of a key of this map, and its value.
    fn entry(self, keys: Keys, key: &'de YamlNode, node: &'de YamlNode) -> (&'de str, At<'de>) {
        let (si, unit) = self.names.find(keys, key.name());
        let around = self.unit.filter(|_| !WITHOUT_UNIT.contains(&si));
        let place = match keys {
            Keys::Of(_) => self.place.and_then(|place| Some(place.key(si)?.place)),
            _ => None,
        };
        let keys = match keys {
            Keys::ParametersOfEach => Some(Keys::Parameters),
            _ => Keys::below(si),
        };
        (si, At { node, keys, unit: unit.or(around), place, ..self })
    }

    /// Returns the number of a value with a unit.
    fn number(self) -> Result<Option<f64>, DecodeError<'de>> {
        let number = self.unit.map_or(Ok(None), |key| self.names.number(self.node, &key));
        number.map_err(|fault| DecodeError::new(fault).at(self.node))
    }

    fn map<V: Visitor<'de>>(
        self,
        keys: Option<Keys>,
        entries: &'de [(YamlNode, YamlNode)],
        visitor: V,
    ) -> Result<V::Value, DecodeError<'de>> {
        let keys = keys.unwrap_or(Keys::Of(&[]));
        let once = self.names.check_once(keys, entries);
        once.map_err(|(key, fault)| DecodeError::new(fault).at(key))?;
        let each = entries.iter().map(|(key, value)| {
            let (si, value) = self.entry(keys, key, value);
            (BorrowedStrDeserializer::new(si), value)
        });
        visitor.visit_map(MapDeserializer::new(each)).map_err(|error: DecodeError<'de>| {
            let found = error.fault.found.as_deref().filter(|_| error.fault.problem == UNKNOWN);
            match entries.iter().find(|(key, _)| Some(shorten(key.name()).as_str()) == found) {
                Some((key, _)) => error.at(key),
                None => error,
            }
        })
    }
}

impl<'de> IntoDeserializer<'de, DecodeError<'de>> for At<'de> {
    type Deserializer = Self;

    fn into_deserializer(self) -> Self {
        self
    }
}

impl<'de> Deserializer<'de> for At<'de> {
    type Error = DecodeError<'de>;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Self::Error> {
        if let Some(number) = self.number()? {
            self.check_bounds(number)?;
            return visitor
                .visit_f64(number)
                .map_err(|error: DecodeError<'de>| error.at(self.node));
        }
        let value = match &self.node.content {
            Content::Nothing => visitor.visit_unit(),
            Content::Placeholder => visitor.visit_u64(1),
            Content::Truth(truth) => visitor.visit_bool(*truth),
            Content::Natural(number) => {
                self.check_bounds(*number as f64)?;
                visitor.visit_u64(*number)
            }
            Content::Number(number) => {
                self.check_bounds(*number)?;
                visitor.visit_f64(*number)
            }
            Content::Text(text) => visitor.visit_borrowed_str(text),
            Content::List(items) => {
                let place = self.place.and_then(|place| place.item());
                let items = items.iter().map(|item| At { place, ..self.item(item) });
                visitor.visit_seq(SeqDeserializer::new(items))
            }
            Content::Map(entries) => self.map(self.keys, entries, visitor),
        };
        value.map_err(|error| error.at(self.node))
    }

    /// A key in the file must have a value: only an absent key means "not given".
    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Self::Error> {
        visitor.visit_some(self)
    }

    fn deserialize_newtype_struct<V: Visitor<'de>>(
        self,
        name: &'static str,
        visitor: V,
    ) -> Result<V::Value, Self::Error> {
        let unit = if name == "NumberOrLength" { Some(UnitKey::LENGTH) } else { self.unit };
        visitor.visit_newtype_struct(At { unit, ..self })
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        _name: &'static str,
        variants: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Self::Error> {
        let number = self.number()?;
        let (name, value) = match &self.node.content {
            Content::Text(_) if number.is_none() => (self.node, None),
            Content::Placeholder => {
                let first = variants.first().copied().unwrap_or_default();
                let first: StrDeserializer<'_, Self::Error> = first.into_deserializer();
                return visitor.visit_enum(first).map_err(|error| error.at(self.node));
            }
            Content::Map(entries) if entries.len() == 1 => (&entries[0].0, Some(&entries[0].1)),
            _ => {
                let allowed = format!("one of {}", variants.join(", "));
                let fault = Fault::new("not a choice", self.node.describe(), allowed);
                return Err(DecodeError::new(fault).at(self.node));
            }
        };
        let (variant, at) = self.entry(Keys::Of(variants), name, value.unwrap_or(&NOTHING));
        // The visitor of kinds knows those of system files.
        if !variants.contains(&variant) && !variant.starts_with(WRITTEN) {
            let unknown = DecodeError::unknown_variant(variant, variants);
            return Err(DecodeError { place: Some(name.place), ..unknown }.at(self.node));
        }
        let value = value.map(|_| at);
        let choice = Choice { name: variant, names: self.names, value };
        visitor.visit_enum(choice).map_err(|error| error.at(self.node))
    }

    /// Accepts keys and values only: serde's derived structs would also accept a list of the values
    /// in order.
    fn deserialize_struct<V: Visitor<'de>>(
        self,
        _name: &'static str,
        fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Self::Error> {
        self.number()?;
        match &self.node.content {
            Content::Map(entries) => {
                let keys = self.keys.unwrap_or(Keys::Of(fields));
                let is_unknown =
                    |key: &YamlNode| !fields.contains(&self.names.find(keys, key.name()).0);
                if let Some((key, _)) = entries.iter().find(|(key, _)| is_unknown(key)) {
                    return Err(DecodeError::unknown_field(key.name(), fields).at(key));
                }
                let value = self.map(Some(keys), entries, visitor);
                return value.map_err(|error| error.at(self.node));
            }
            Content::Placeholder => {
                let empty: [(BorrowedStrDeserializer<'de, _>, At<'de>); 0] = [];
                let keys = MapDeserializer::new(empty.into_iter());
                let value = visitor.visit_map(keys);
                return value.map_err(|error: DecodeError<'de>| error.at(self.node));
            }
            _ => {}
        }
        let keys: Vec<String> = fields.iter().map(|field| format!("{field}: ...")).collect();
        let allowed = format!("keys and values, {}", shorten(&keys.join(", ")));
        Err(DecodeError::new(Fault::new("wrong type", self.node.describe(), allowed)).at(self.node))
    }

    fn deserialize_string<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Self::Error> {
        match self.node.content {
            Content::Placeholder => visitor.visit_borrowed_str(""),
            _ => self.deserialize_any(visitor),
        }
    }

    forward_to_deserialize_any! {
        bool i8 i16 i32 i64 i128 u8 u16 u32 u64 u128 f32 f64 char str bytes byte_buf
        unit unit_struct seq tuple tuple_struct map identifier ignored_any
    }
}

/// A choice: a word alone, or one key with its settings.
struct Choice<'de> {
    name: &'de str,
    names: &'de Names,
    value: Option<At<'de>>,
}

/// Stands for missing settings.
static NOTHING: YamlNode =
    YamlNode { place: Location { line: 1, column: 1 }, content: Content::Nothing };

impl<'de> EnumAccess<'de> for Choice<'de> {
    type Error = DecodeError<'de>;
    type Variant = Choice<'de>;

    fn variant_seed<V: DeserializeSeed<'de>>(
        self,
        seed: V,
    ) -> Result<(V::Value, Choice<'de>), Self::Error> {
        let name: StrDeserializer<'_, Self::Error> = self.name.into_deserializer();
        Ok((seed.deserialize(name)?, self))
    }
}

impl<'de> Choice<'de> {
    fn read<T>(
        self,
        read: impl FnOnce(At<'de>) -> Result<T, DecodeError<'de>>,
    ) -> Result<T, DecodeError<'de>> {
        if let Some(value) = self.value {
            return read(value);
        }
        let name = self.name;
        read(At { node: &NOTHING, names: self.names, keys: None, unit: None, place: None }).map_err(
            |error| {
                let needed = error.fault.allowed.unwrap_or_default();
                let example =
                    example_of_friction(name).map(|example| format!("; such as {example}"));
                let allowed =
                    format!("{{{name}: ...}} with {needed}{}", example.unwrap_or_default());
                DecodeError::new(Fault::new("settings are missing", name, allowed))
            },
        )
    }
}

impl<'de> VariantAccess<'de> for Choice<'de> {
    type Error = DecodeError<'de>;

    fn unit_variant(self) -> Result<(), Self::Error> {
        let Some(value) = self.value else { return Ok(()) };
        let fault = Fault::new("takes no settings", value.node.describe(), self.name);
        Err(DecodeError { place: Some(value.node.place), ..DecodeError::new(fault) })
    }

    fn newtype_variant_seed<T: DeserializeSeed<'de>>(
        self,
        seed: T,
    ) -> Result<T::Value, Self::Error> {
        self.read(|value| seed.deserialize(value))
    }

    fn tuple_variant<V: Visitor<'de>>(
        self,
        _len: usize,
        visitor: V,
    ) -> Result<V::Value, Self::Error> {
        self.read(|value| value.deserialize_any(visitor))
    }

    fn struct_variant<V: Visitor<'de>>(
        self,
        fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Self::Error> {
        self.read(|value| value.deserialize_struct("", fields, visitor))
    }
}
