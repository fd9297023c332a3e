//! Keys without units in the JSON Schema: beside each SI key with a unit stands the key that takes values with units.

use serde_json::{Map, Value, json};

use super::key_units::{DENSITY, MATERIAL, WITHOUT_UNIT, split_unit};
use super::quantity::measured;
use crate::model::MATERIALS;

/// A number with a unit; the program checks the unit.
pub(super) const QUANTITY: &str =
    r"^\s*[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)?\s*(\s1/)?[A-Za-zµμ°].*$";

/// The ending of the name of a definition with values with units.
const WITH_UNITS: &str = "WithUnits";

/// Removes `null` everywhere, because a key in a study file has a value, and defaults of maps, because their keys have them.
pub(in crate::study) fn remove_nulls(schema: &mut Value) {
    let is_null = |value: &Value| *value == json!("null") || *value == json!({ "type": "null" });
    match schema {
        Value::Array(items) => items.iter_mut().for_each(remove_nulls),
        Value::Object(fields) => {
            fields.retain(|key, value| key != "default" || !(value.is_null() || value.is_object()));
            if let Some(Value::Array(types)) = fields.get_mut("type") {
                types.retain(|name| !is_null(name));
                if let [name] = &types[..] {
                    let name = name.clone();
                    fields.insert("type".to_owned(), name);
                }
            }
            if let Some(Value::Array(forms)) = fields.get_mut("anyOf") {
                forms.retain(|form| !is_null(form));
                if let [Value::Object(form)] = &forms[..] {
                    let form = form.clone();
                    fields.shift_remove("anyOf");
                    form.into_iter().for_each(|(key, value)| {
                        fields.entry(key).or_insert(value);
                    });
                }
            }
            fields.values_mut().for_each(remove_nulls);
        }
        _ => {}
    }
}

/// Adds the keys without units.
pub(in crate::study) fn add_units(schema: &mut Value) {
    let mut needed = Vec::new();
    add_keys(schema, &mut needed);
    // A definition with units may need another one.
    while let Some(name) = needed.pop() {
        let with_units = format!("{name}{WITH_UNITS}");
        let Some(Value::Object(definitions)) = schema.get_mut("$defs") else { return };
        if definitions.contains_key(&with_units) {
            continue;
        }
        let Some(plain) = definitions.get(&name).cloned() else { continue };
        definitions.insert(with_units, with_strings(&plain, &mut needed));
    }
}

fn add_keys(schema: &mut Value, needed: &mut Vec<String>) {
    match schema {
        Value::Array(items) => items.iter_mut().for_each(|item| add_keys(item, needed)),
        Value::Object(fields) => {
            fields.values_mut().for_each(|field| add_keys(field, needed));
            if let Some(Value::Object(properties)) = fields.get("properties").cloned() {
                let (properties, pairs) = doubled(properties, needed);
                fields.insert("properties".to_owned(), properties.into());
                pairs.iter().for_each(|pair| exclude(fields, pair));
            }
        }
        _ => {}
    }
}

/// Returns properties with the keys without units after the SI keys, and the pairs of both.
fn doubled(
    properties: Map<String, Value>,
    needed: &mut Vec<String>,
) -> (Map<String, Value>, Vec<[String; 2]>) {
    let (mut all, mut pairs): (Map<String, Value>, Vec<[String; 2]>) = Default::default();
    for (si, value) in properties {
        let short = split_unit(&si).map(|(short, unit)| {
            let mut with_unit = with_strings(&value, needed);
            if let Value::Object(fields) = &mut with_unit {
                let text = format!("`{si}` as {}.", measured(unit));
                fields.insert("description".to_owned(), text.into());
            }
            (short.to_owned(), with_unit)
        });
        let material = if si == DENSITY { materials(&value) } else { None };
        // `normal_force` is a word or, for a block, a force.
        match all.get_mut(&si) {
            Some(other) => *other = json!({ "anyOf": [other, value] }),
            None => {
                all.insert(si.clone(), value);
            }
        }
        if let Some(material) = material {
            pairs.push([si.clone(), MATERIAL.to_owned()]);
            all.insert(MATERIAL.to_owned(), material);
        }
        if let Some((short, value)) = short {
            let known = pairs.iter().any(|[_, other]| *other == short);
            pairs.push([si, short.clone()]);
            match all.get_mut(&short) {
                Some(_) if known => {}
                Some(other) => *other = json!({ "anyOf": [other, value] }),
                None => {
                    all.insert(short, value);
                }
            }
        }
    }
    (all, pairs)
}

/// Returns a schema of numbers as one of names of materials; `None` for a distribution or a range.
fn materials(schema: &Value) -> Option<Value> {
    let names: Vec<&str> = MATERIALS.iter().map(|material| material.name).collect();
    let words = "Material of the balls, which gives their density, in place of the mass.";
    let name = json!({ "type": "string", "enum": names, "description": words });
    let is_list = |form: &Value| form["type"] == "array";
    match schema.get("anyOf").and_then(Value::as_array) {
        Some(forms) if forms.iter().any(is_list) => {
            Some(json!({ "type": "array", "items": name, "minItems": 1 }))
        }
        _ => (schema["type"] == "number").then_some(name),
    }
}

/// Lets an object have one of two keys only; a required key may be either.
fn exclude(fields: &mut Map<String, Value>, [si, short]: &[String; 2]) {
    let both = json!({ "not": { "required": [si, short] } });
    let mut rule = both;
    if let Some(Value::Array(required)) = fields.get_mut("required") {
        let before = required.len();
        required.retain(|key| key != si);
        if required.len() < before {
            rule = json!({ "oneOf": [{ "required": [si] }, { "required": [short] }] });
        }
        if required.is_empty() {
            fields.shift_remove("required");
        }
    }
    if let Value::Array(rules) = fields.entry("allOf").or_insert_with(|| json!([])) {
        rules.push(rule);
    }
}

/// Returns a schema in which texts with units stand for numbers.
fn with_strings(schema: &Value, needed: &mut Vec<String>) -> Value {
    let Value::Object(fields) = schema else { return schema.clone() };
    if let Some(name) = fields.get("$ref").and_then(Value::as_str) {
        let name = name.trim_start_matches("#/$defs/").to_owned();
        let with_units = format!("#/$defs/{name}{WITH_UNITS}");
        needed.push(name);
        let mut fields = fields.clone();
        fields.insert("$ref".to_owned(), with_units.into());
        return fields.into();
    }
    if fields.get("type") == Some(&json!("number")) {
        let mut text = json!({ "type": "string", "pattern": QUANTITY });
        if let (Value::Object(text), Some(meaning)) = (&mut text, fields.get("description")) {
            text.insert("description".to_owned(), meaning.clone());
        }
        return text;
    }
    let mut result = Map::new();
    for (key, value) in fields {
        let value = match (key.as_str(), value) {
            ("properties", Value::Object(properties)) => {
                let each = properties.iter().map(|(name, value)| {
                    let without = WITHOUT_UNIT.contains(&name.as_str());
                    let value = if without { value.clone() } else { with_strings(value, needed) };
                    (name.clone(), value)
                });
                Value::Object(each.collect())
            }
            ("items", value) => with_strings(value, needed),
            ("anyOf" | "oneOf", Value::Array(forms)) => {
                forms.iter().map(|form| with_strings(form, needed)).collect()
            }
            _ => value.clone(),
        };
        result.insert(key.clone(), value);
    }
    result.into()
}
