//! A machine from keyword arguments, written as the text of a study, so that errors are located as
//! in a file.

use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict};
use serde_json::{Map, Number, Value, json};
use stickslip::study::Study;

use crate::error::Trouble;
use crate::values::{is_text, items, keys, kind, number};

/// The study of one machine.
pub struct Machine {
    /// The name of the function in messages.
    pub name: &'static str,
    model: Map<String, Value>,
    /// Other keys of the study, with their values.
    pub parts: Vec<(&'static str, Value)>,
}

impl Machine {
    /// Creates a machine of a kind with these parameters; `friction`, `normal_force` and
    /// `contact` are keys of the model.
    ///
    /// # Errors
    /// Returns a `TypeError` for values that a study file cannot contain.
    pub fn new(
        name: &'static str,
        kind: &str,
        parameters: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        let mut own = Map::new();
        let mut model = Map::from_iter([("kind".to_owned(), kind.into())]);
        for (key, value) in parameters.iter().flat_map(|parameters| parameters.iter()) {
            let key: String = key.extract()?;
            let value = to_value(&key, &value)?;
            let part = matches!(key.as_str(), "friction" | "normal_force" | "contact");
            if part { &mut model } else { &mut own }.insert(key, value);
        }
        model.insert("parameters".to_owned(), Value::Object(own));
        Ok(Machine { name, model, parts: Vec::new() })
    }

    /// Returns the study of this machine with the given sampling design.
    ///
    /// # Errors
    /// Returns the first fault of the study.
    pub fn study(&self, design: Value) -> Result<Study, Trouble> {
        let mut text = format!("schema: 1\nname: {}\nseed: 0\nmodel:\n", self.name);
        for (key, value) in &self.model {
            match value {
                // One line per parameter, which a message can quote.
                Value::Object(parameters) if key == "parameters" && !parameters.is_empty() => {
                    text.push_str("  parameters:\n");
                    for (key, value) in parameters {
                        text.push_str(&format!("    {}: {value}\n", key_text(key)));
                    }
                }
                _ => text.push_str(&format!("  {key}: {value}\n")),
            }
        }
        for (key, value) in &self.parts {
            text.push_str(&format!("{key}: {value}\n"));
        }
        text.push_str(&format!("initial_conditions: {}\n", json!({ "design": design })));
        Ok(Study::parse(self.name.as_ref(), text)?)
    }
}

/// Returns a key in its usual notation: unquoted if it is a name.
fn key_text(key: &str) -> String {
    let name = |letter: char| letter.is_ascii_alphanumeric() || letter == '_';
    match key.starts_with(|first: char| first.is_ascii_alphabetic()) && key.chars().all(name) {
        true => key.to_owned(),
        false => Value::from(key).to_string(),
    }
}

/// Converts a Python value to a value of a study file: numbers, text, booleans, and lists and
/// mappings of them.
///
/// # Errors
/// Returns a `TypeError` for any other type, and a `StudyError` for a number that is not finite;
/// `key` is the place of the value.
pub fn to_value(key: &str, value: &Bound<'_, PyAny>) -> PyResult<Value> {
    if value.is_none() {
        return Ok(Value::Null);
    }
    if is_text(value) {
        return Ok(Value::String(value.extract()?));
    }
    if value.is_instance_of::<PyBool>() {
        return Ok(Value::Bool(value.extract()?));
    }
    if let Some(number) = number(value)? {
        // An integer is written as such if a float represents it exactly.
        if number.abs() < 2.0_f64.powi(53) && value.hasattr("__index__")? {
            return Ok((number as i64).into());
        }
        let Some(finite) = Number::from_f64(number) else {
            let found = format!("{key}: not a finite number\n  found:   {number}");
            return Err(Trouble::Usage(format!("{found}\n  allowed: a finite number")).into());
        };
        return Ok(Value::Number(finite));
    }
    if let Some(names) = keys(value)? {
        let mut map = Map::new();
        for name in names {
            let inner = to_value(&format!("{key}.{name}"), &value.get_item(&name)?)?;
            map.insert(name, inner);
        }
        return Ok(Value::Object(map));
    }
    let Some(items) = items(value)? else {
        let kind = kind(value);
        return Err(PyTypeError::new_err(format!(
            "{key}: wrong type\n  found:   a value of type {kind}\n  allowed: numbers, text, and lists and \
             dicts of them"
        )));
    };
    let mut list = Vec::with_capacity(items.len());
    for (index, item) in items.iter().enumerate() {
        list.push(to_value(&format!("{key}[{index}]"), item)?);
    }
    Ok(Value::Array(list))
}
