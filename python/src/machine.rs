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
        let mut study = json!({"schema": 1, "name": self.name, "seed": 0, "model": self.model});
        for (key, value) in &self.parts {
            study[*key] = value.clone();
        }
        study["initial_conditions"] = json!({"design": design});
        Ok(Study::from_value(self.name.as_ref(), &study, &[])?)
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
    if value.hasattr("__fspath__")? {
        return Ok(Value::String(value.call_method0("__fspath__")?.extract()?));
    }
    if value.is_instance_of::<PyBool>() {
        return Ok(Value::Bool(value.extract()?));
    }
    if value.hasattr("__index__")? {
        // An integer is written as such. One without 64 bits becomes a float, which is refused where it has no meaning.
        if let Ok(whole) = value.extract::<i64>() {
            return Ok(whole.into());
        }
        if let Ok(whole) = value.extract::<u64>() {
            return Ok(whole.into());
        }
    }
    if let Some(number) = number(value)? {
        let Some(finite) = Number::from_f64(number) else {
            let found = format!("{key}: not a finite number\n  found:   {number}");
            return Err(Trouble::Usage(format!("{found}\n  allowed: a finite number")).into());
        };
        return Ok(Value::Number(finite));
    }
    if let Some(names) = keys(value)? {
        let mut map = Map::new();
        for name in names {
            let below = if key.is_empty() { name.clone() } else { format!("{key}.{name}") };
            let inner = to_value(&below, &value.get_item(&name)?)?;
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
