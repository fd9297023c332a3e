//! Places in the JSON Schema of study files: the keys of a value, their descriptions and choices.

use serde_json::Value;

/// A value in the schema, with everything that it may be.
#[derive(Clone)]
pub(super) struct SchemaPlace<'a> {
    schema: &'a Value,
    /// The value's own schema, followed by the schemas that it refers to.
    alternatives: Vec<&'a Value>,
}

/// A key in the schema.
pub(super) struct SchemaKey<'a> {
    /// Meaning, unit and range.
    pub(super) description: Option<&'a str>,
    /// The default in all models that have the key.
    pub(super) default: Option<&'a Value>,
    /// The value of the key.
    pub(super) place: SchemaPlace<'a>,
}

impl<'a> SchemaPlace<'a> {
    /// Returns the whole study.
    pub(super) fn root(schema: &'a Value) -> Self {
        SchemaPlace::of(schema, schema)
    }

    fn of(schema: &'a Value, node: &'a Value) -> Self {
        let mut alternatives = Vec::new();
        collect(schema, node, &mut alternatives);
        SchemaPlace { schema, alternatives }
    }

    /// Returns a key of a map.
    pub(super) fn key(&self, name: &str) -> Option<SchemaKey<'a>> {
        let in_map = |node: &&'a Value| Some((*node, node.get("properties")?.get(name)?));
        let named = self.alternatives.iter().find_map(in_map);
        let other = || {
            let free = |node: &&'a Value| {
                Some((*node, node.get("additionalProperties").filter(|below| below.is_object())?))
            };
            self.alternatives.iter().find_map(free)
        };
        let (map, node) = named.or_else(other)?;
        let place = SchemaPlace::of(self.schema, node);
        // The description of an alternative with a single key describes this key.
        let of_alternative = || only_key(map).and_then(|_| text(map, "description"));
        let of_type = || place.alternatives.iter().find_map(|node| text(node, "description"));
        let description = text(node, "description").or_else(of_alternative).or_else(of_type);
        Some(SchemaKey { description, default: node.get("default"), place })
    }

    /// Returns the entries of a list.
    pub(super) fn item(&self) -> Option<SchemaPlace<'a>> {
        let items = self.alternatives.iter().find_map(|node| node.get("items"))?;
        Some(SchemaPlace::of(self.schema, items))
    }

    /// Returns the names of all keys of a map, each once.
    pub(super) fn names(&self) -> Vec<&'a str> {
        let mut names: Vec<&str> = Vec::new();
        let maps = self.alternatives.iter().filter_map(|node| node.get("properties")?.as_object());
        for name in maps.flat_map(|map| map.keys()) {
            if !names.contains(&name.as_str()) {
                names.push(name);
            }
        }
        names
    }

    /// Returns the words or keys between which the value chooses; empty if there is no choice.
    pub(super) fn choices(&self) -> Vec<&'a str> {
        let words = self.alternatives.iter().filter_map(|node| node.get("enum")?.as_array());
        let either = self.alternatives.iter().filter_map(|node| node.get("oneOf")?.as_array());
        let choice = |one: &'a Value| text(one, "const").or_else(|| only_key(one));
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
        for one in node.get(several).and_then(Value::as_array).into_iter().flatten() {
            collect(schema, one, found);
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
