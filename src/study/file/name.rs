//! A name in a study file that is one of the names of the models.

use std::fmt;

use serde::de::{DeserializeSeed, Deserializer, Error, Visitor};

/// The name of a choice or of a key, read as its place among all names.
pub(super) struct Name {
    names: &'static [&'static str],
    is_key: bool,
}

impl Name {
    /// A choice among these names.
    pub(super) fn of_choice(names: &'static [&'static str]) -> Self {
        Name { names, is_key: false }
    }

    /// A key among these names.
    pub(super) fn of_key(names: &'static [&'static str]) -> Self {
        Name { names, is_key: true }
    }
}

impl<'de> DeserializeSeed<'de> for Name {
    type Value = usize;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<usize, D::Error> {
        deserializer.deserialize_identifier(self)
    }
}

impl Visitor<'_> for Name {
    type Value = usize;

    fn expecting(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "one of {}", self.names.join(", "))
    }

    fn visit_str<E: Error>(self, found: &str) -> Result<usize, E> {
        let index = self.names.iter().position(|name| *name == found);
        index.ok_or_else(|| match self.is_key {
            true => E::unknown_field(found, self.names),
            false => E::unknown_variant(found, self.names),
        })
    }
}
