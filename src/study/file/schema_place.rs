//! Places in the JSON Schema of study files: the keys of a value, their descriptions, choices and bounds.

use serde_json::Value;

use crate::study::error::describe_number;

/// A value in the schema.
#[derive(Clone, Copy)]
pub(in crate::study) struct SchemaPlace<'a> {
    schema: &'a Value,
    node: &'a Value,
}

/// A key in the schema.
pub(in crate::study) struct SchemaKey<'a> {
    /// Meaning, unit and range.
    pub(in crate::study) description: Option<&'a str>,
    /// The default in all models that have the key.
    pub(in crate::study) default: Option<&'a Value>,
    /// The value of the key.
    pub(in crate::study) place: SchemaPlace<'a>,
}

impl<'a> SchemaPlace<'a> {
    /// Returns the whole study.
    pub(in crate::study) fn root(schema: &'a Value) -> Self {
        SchemaPlace { schema, node: schema }
    }

    /// Returns the value's own schema, followed by the schemas that it refers to.
    fn alternatives(&self) -> impl Iterator<Item = &'a Value> + use<'a> {
        let mut alternatives = Vec::new();
        collect(self.schema, self.node, &mut alternatives);
        alternatives.into_iter()
    }

    /// Returns a key of a map.
    pub(in crate::study) fn key(&self, name: &str) -> Option<SchemaKey<'a>> {
        let in_map = |node: &'a Value| Some((node, node.get("properties")?.get(name)?));
        let named = self.alternatives().find_map(in_map);
        let other = || {
            let free = |node: &'a Value| {
                Some((node, node.get("additionalProperties").filter(|below| below.is_object())?))
            };
            self.alternatives().find_map(free)
        };
        let (map, node) = named.or_else(other)?;
        let place = SchemaPlace { schema: self.schema, node };
        // The description of an alternative with a single key describes this key.
        let of_alternative = || only_key(map).and_then(|_| text(map, "description"));
        let of_type = || place.alternatives().find_map(|node| text(node, "description"));
        let description = text(node, "description").or_else(of_alternative).or_else(of_type);
        Some(SchemaKey { description, default: node.get("default"), place })
    }

    /// Returns the entries of a list.
    pub(in crate::study) fn item(&self) -> Option<SchemaPlace<'a>> {
        let node = self.alternatives().find_map(|node| node.get("items"))?;
        Some(SchemaPlace { schema: self.schema, node })
    }

    /// Returns which numbers are allowed, in words, if this number is outside the bounds.
    pub(super) fn allowed_instead_of(&self, number: f64) -> Option<String> {
        let is_number = |node: &&Value| matches!(text(node, "type"), Some("number" | "integer"));
        let node = self.alternatives().find(is_number)?;
        let bound = |key: &str| node.get(key).and_then(Value::as_f64);
        let [least, most] = ["minimum", "maximum"].map(bound);
        let [above, below] = ["exclusiveMinimum", "exclusiveMaximum"].map(bound);
        let is_within = least.is_none_or(|least| number >= least)
            && most.is_none_or(|most| number <= most)
            && above.is_none_or(|above| number > above)
            && below.is_none_or(|below| number < below);
        if is_within {
            return None;
        }
        let kind =
            if text(node, "type") == Some("integer") { "a whole number" } else { "a number" };
        if let (Some(least), Some(most)) = (least, most) {
            return Some(format!(
                "{kind} from {} to {}",
                describe_number(least),
                describe_number(most)
            ));
        }
        let ends = [("above", above), ("at least", least), ("below", below), ("at most", most)];
        let ends = ends
            .into_iter()
            .filter_map(|(words, end)| Some(format!("{words} {}", describe_number(end?))));
        Some(format!("{kind} {}", ends.collect::<Vec<_>>().join(" and ")))
    }

    /// Returns the names of all keys of a map, each once.
    pub(in crate::study) fn names(&self) -> Vec<&'a str> {
        let mut names: Vec<&str> = Vec::new();
        let maps = self.alternatives().filter_map(|node| node.get("properties")?.as_object());
        for name in maps.flat_map(|map| map.keys()) {
            if !names.contains(&name.as_str()) {
                names.push(name);
            }
        }
        names
    }

    /// Returns the words or keys between which the value chooses; empty if there is no choice.
    pub(in crate::study) fn choices(&self) -> Vec<&'a str> {
        let words = self.alternatives().filter_map(|node| node.get("enum")?.as_array());
        let either = self.alternatives().filter_map(|node| node.get("oneOf")?.as_array());
        let choice = |form: &'a Value| text(form, "const").or_else(|| only_key(form));
        let words = words.flatten().filter_map(Value::as_str);
        words.chain(either.flatten().filter_map(choice)).collect()
    }
}

/// Adds a schema and everything that it refers to.
fn collect<'a>(schema: &'a Value, node: &'a Value, found: &mut Vec<&'a Value>) {
    // A type that contains itself is added once.
    if found.iter().any(|known| std::ptr::eq(*known, node)) {
        return;
    }
    found.push(node);
    let target = text(node, "$ref").and_then(|path| path.strip_prefix('#'));
    if let Some(target) = target.and_then(|pointer| schema.pointer(pointer)) {
        collect(schema, target, found);
    }
    for several in ["anyOf", "oneOf", "allOf"] {
        for form in node.get(several).and_then(Value::as_array).into_iter().flatten() {
            collect(schema, form, found);
        }
    }
}

/// Returns the key of a map that has exactly one, which is required.
fn only_key(node: &Value) -> Option<&str> {
    let (properties, required) = (node.get("properties")?.as_object()?, node.get("required")?);
    let key = properties.keys().next().filter(|_| properties.len() == 1)?;
    (required.get(0)?.as_str()? == key).then_some(key)
}

fn text<'a>(node: &'a Value, key: &str) -> Option<&'a str> {
    node.get(key)?.as_str()
}
