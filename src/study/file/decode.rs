//! Deserialisation of located values into the types of the study file, with located errors.

use serde::de::value::StrDeserializer;
use serde::de::{
    Deserialize, DeserializeSeed, Deserializer, EnumAccess, Error as _, Expected, IntoDeserializer,
    MapAccess, SeqAccess, Unexpected, VariantAccess, Visitor,
};
use serde::forward_to_deserialize_any;

use crate::study::error::{Fault, Location, StudyError, list_names, shorten};
use crate::study::file::key_path::{KeyPath, Segment};
use crate::study::file::yaml_tree::{Content, Key, Node, Source, describe_number};

/// Deserialises a value of type `T` from the whole source.
///
/// # Errors
/// Returns the first value that does not fit `T`, with its place and key path.
pub(crate) fn decode<'de, T: Deserialize<'de>>(source: &'de Source) -> Result<T, StudyError> {
    T::deserialize(At(&source.root)).map_err(|mut error| {
        error.steps.reverse();
        let place = error.place.unwrap_or(source.root.place);
        source.refuse_at(place, &KeyPath(error.steps), error.fault)
    })
}

/// An error that is passed upwards: each level adds its step, and the innermost level adds the
/// place.
#[derive(Debug)]
struct DecodeError {
    steps: Vec<Segment>,
    place: Option<Location>,
    fault: Fault,
}

impl DecodeError {
    fn new(fault: Fault) -> DecodeError {
        DecodeError { steps: Vec::new(), place: None, fault }
    }

    fn at(mut self, place: Location) -> DecodeError {
        self.place.get_or_insert(place);
        self
    }

    fn below(mut self, step: Segment) -> DecodeError {
        self.steps.push(step);
        self
    }
}

impl std::fmt::Display for DecodeError {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        out.write_str(&self.fault.problem)
    }
}

impl std::error::Error for DecodeError {}

impl serde::de::Error for DecodeError {
    fn custom<T: std::fmt::Display>(problem: T) -> DecodeError {
        DecodeError::new(Fault { problem: problem.to_string(), found: None, allowed: None })
    }

    fn invalid_type(found: Unexpected<'_>, allowed: &dyn Expected) -> DecodeError {
        DecodeError::new(Fault::new("wrong type", in_words(found), plain(allowed)))
    }

    fn invalid_value(found: Unexpected<'_>, allowed: &dyn Expected) -> DecodeError {
        DecodeError::new(Fault::new("not allowed here", in_words(found), plain(allowed)))
    }

    fn invalid_length(length: usize, allowed: &dyn Expected) -> DecodeError {
        let found = format!("a list of {length}");
        DecodeError::new(Fault::new("wrong number of values", found, plain(allowed)))
    }

    fn unknown_variant(found: &str, allowed: &'static [&'static str]) -> DecodeError {
        DecodeError::new(Fault::new("unknown choice", shorten(found), list_names(found, allowed)))
    }

    fn unknown_field(found: &str, allowed: &'static [&'static str]) -> DecodeError {
        DecodeError::new(Fault::new("unknown key", shorten(found), list_names(found, allowed)))
    }

    fn missing_field(field: &'static str) -> DecodeError {
        let fault = Fault::new("missing key", "no such key", format!("a value for `{field}`"));
        DecodeError::new(fault).below(Segment::Key(field.to_owned()))
    }
}

fn in_words(found: Unexpected<'_>) -> String {
    match found {
        Unexpected::Bool(truth) => truth.to_string(),
        Unexpected::Unsigned(number) => number.to_string(),
        Unexpected::Signed(number) => number.to_string(),
        Unexpected::Float(number) => describe_number(number),
        Unexpected::Str(text) => format!("text {:?}", shorten(text)),
        Unexpected::Unit => "nothing".to_owned(),
        Unexpected::Seq => "a list".to_owned(),
        Unexpected::Map => "keys and values".to_owned(),
        other => other.to_string(),
    }
}

fn plain(allowed: &dyn Expected) -> String {
    let text = allowed.to_string();
    match text.as_str() {
        "f64" => "a number".to_owned(),
        "u64" => "a whole number from 0 to 2^64 - 1".to_owned(),
        "a string" => "text (quote it if it looks like a number)".to_owned(),
        "a sequence" => "a list".to_owned(),
        _ if text.starts_with("struct ") => "keys and values".to_owned(),
        _ => text,
    }
}

/// A node of the tree from which serde deserialises.
#[derive(Clone, Copy)]
struct At<'de>(&'de Node);

impl<'de> At<'de> {
    fn read<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, DecodeError> {
        match &self.0.content {
            Content::Nothing => visitor.visit_unit(),
            Content::Truth(truth) => visitor.visit_bool(*truth),
            Content::Natural(number) => visitor.visit_u64(*number),
            Content::Negative(number) => visitor.visit_i64(*number),
            Content::Number(number) => visitor.visit_f64(*number),
            Content::Text(text) => visitor.visit_borrowed_str(text),
            Content::List(items) => visitor.visit_seq(Items { items, next: 0 }),
            Content::Map(entries) => visitor.visit_map(Entries { entries, next: 0 }),
        }
    }
}

impl<'de> Deserializer<'de> for At<'de> {
    type Error = DecodeError;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, DecodeError> {
        self.read(visitor).map_err(|error| error.at(self.0.place))
    }

    /// A key in the file must have a value: only an absent key means "not given".
    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, DecodeError> {
        visitor.visit_some(self)
    }

    fn deserialize_newtype_struct<V: Visitor<'de>>(
        self,
        _name: &'static str,
        visitor: V,
    ) -> Result<V::Value, DecodeError> {
        visitor.visit_newtype_struct(self)
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        _name: &'static str,
        variants: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, DecodeError> {
        let choice = match &self.0.content {
            Content::Text(text) => Choice { name: text, place: self.0.place, value: None },
            Content::Map(entries) if entries.len() == 1 => {
                let (key, value) = &entries[0];
                Choice { name: &key.name, place: key.place, value: Some(value) }
            }
            _ => {
                let allowed = format!("one of {}", variants.join(", "));
                let fault = Fault::new("not a choice", self.0.describe(), allowed);
                return Err(DecodeError::new(fault).at(self.0.place));
            }
        };
        visitor.visit_enum(choice).map_err(|error| error.at(self.0.place))
    }

    /// Accepts keys and values only: serde's derived structs would also accept a list of the values
    /// in order.
    fn deserialize_struct<V: Visitor<'de>>(
        self,
        _name: &'static str,
        fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, DecodeError> {
        if let Content::Map(_) = self.0.content {
            return self.deserialize_any(visitor);
        }
        let keys: Vec<String> = fields.iter().map(|field| format!("{field}: ...")).collect();
        let allowed = format!("keys and values, {}", shorten(&keys.join(", ")));
        Err(DecodeError::new(Fault::new("wrong type", self.0.describe(), allowed)).at(self.0.place))
    }

    forward_to_deserialize_any! {
        bool i8 i16 i32 i64 i128 u8 u16 u32 u64 u128 f32 f64 char str string bytes byte_buf
        unit unit_struct seq tuple tuple_struct map identifier ignored_any
    }
}

struct Items<'de> {
    items: &'de [Node],
    next: usize,
}

impl<'de> SeqAccess<'de> for Items<'de> {
    type Error = DecodeError;

    fn next_element_seed<T: DeserializeSeed<'de>>(
        &mut self,
        seed: T,
    ) -> Result<Option<T::Value>, DecodeError> {
        let Some(item) = self.items.get(self.next) else { return Ok(None) };
        let step = Segment::Item(self.next);
        self.next += 1;
        seed.deserialize(At(item)).map(Some).map_err(|error| error.at(item.place).below(step))
    }

    fn size_hint(&self) -> Option<usize> {
        Some(self.items.len() - self.next)
    }
}

struct Entries<'de> {
    entries: &'de [(Key, Node)],
    next: usize,
}

impl<'de> MapAccess<'de> for Entries<'de> {
    type Error = DecodeError;

    fn next_key_seed<K: DeserializeSeed<'de>>(
        &mut self,
        seed: K,
    ) -> Result<Option<K::Value>, DecodeError> {
        let Some((key, _)) = self.entries.get(self.next) else { return Ok(None) };
        let name: StrDeserializer<'_, DecodeError> = key.name.as_str().into_deserializer();
        seed.deserialize(name)
            .map(Some)
            .map_err(|error| error.at(key.place).below(Segment::Key(key.name.clone())))
    }

    fn next_value_seed<T: DeserializeSeed<'de>>(
        &mut self,
        seed: T,
    ) -> Result<T::Value, DecodeError> {
        let Some((key, value)) = self.entries.get(self.next) else {
            return Err(DecodeError::custom("a value was read before its key"));
        };
        self.next += 1;
        seed.deserialize(At(value))
            .map_err(|error| error.at(value.place).below(Segment::Key(key.name.clone())))
    }
}

/// A choice: a word alone, or one key with its settings.
struct Choice<'de> {
    name: &'de str,
    place: Location,
    value: Option<&'de Node>,
}

impl<'de> EnumAccess<'de> for Choice<'de> {
    type Error = DecodeError;
    type Variant = Choice<'de>;

    fn variant_seed<V: DeserializeSeed<'de>>(
        self,
        seed: V,
    ) -> Result<(V::Value, Choice<'de>), DecodeError> {
        let name: StrDeserializer<'_, DecodeError> = self.name.into_deserializer();
        let variant = seed.deserialize(name).map_err(|error| error.at(self.place))?;
        Ok((variant, self))
    }
}

impl<'de> Choice<'de> {
    fn settings(&self) -> Result<&'de Node, DecodeError> {
        self.value.ok_or_else(|| {
            let allowed = format!("{{{}: ...}}", self.name);
            let fault = Fault::new("settings are missing", self.name, allowed);
            DecodeError::new(fault).at(self.place)
        })
    }

    fn read<T>(
        self,
        read: impl FnOnce(At<'de>) -> Result<T, DecodeError>,
    ) -> Result<T, DecodeError> {
        let node = self.settings()?;
        read(At(node))
            .map_err(|error| error.at(node.place).below(Segment::Key(self.name.to_owned())))
    }
}

impl<'de> VariantAccess<'de> for Choice<'de> {
    type Error = DecodeError;

    fn unit_variant(self) -> Result<(), DecodeError> {
        match self.value {
            None => Ok(()),
            Some(node) => {
                let fault = Fault::new("takes no settings", node.describe(), self.name);
                Err(DecodeError::new(fault).at(node.place))
            }
        }
    }

    fn newtype_variant_seed<T: DeserializeSeed<'de>>(
        self,
        seed: T,
    ) -> Result<T::Value, DecodeError> {
        self.read(|node| seed.deserialize(node))
    }

    fn tuple_variant<V: Visitor<'de>>(
        self,
        _len: usize,
        visitor: V,
    ) -> Result<V::Value, DecodeError> {
        self.read(|node| node.deserialize_any(visitor))
    }

    fn struct_variant<V: Visitor<'de>>(
        self,
        fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, DecodeError> {
        self.read(|node| node.deserialize_struct("", fields, visitor))
    }
}
