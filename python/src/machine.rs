//! A machine from keyword arguments, written as the text of a study, so that errors are located as
//! in a file.

use pyo3::exceptions::PyOverflowError;
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyFrozenSet, PySet};
use serde_json::{Map, Number, Value, json};
use stickslip::study::Study;

use crate::error::{Trouble, refused, wrong_type};
use crate::values::{is_text, items, keys, number, plain, text};

/// The largest number of levels of a value, as in a study file.
const MOST_LEVELS: usize = 24;
/// The largest number below which all whole numbers are floats.
const LARGEST_WHOLE: f64 = 9_007_199_254_740_992.0;

/// The study of one machine.
pub struct Machine {
    /// The name of the function in messages.
    pub name: &'static str,
    model: Map<String, Value>,
    /// Other keys of the study, with their values.
    pub parts: Vec<(&'static str, Value)>,
}

impl Machine {
    /// Creates a machine of a kind with these parameters; some of them, such as `friction`, are keys of the model.
    ///
    /// # Errors
    /// Returns a `TypeError` for values that a study file cannot contain.
    pub fn new(
        name: &'static str,
        kind: &str,
        of_model: &[&str],
        parameters: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        let mut own = Map::new();
        let mut model = Map::from_iter([("kind".to_owned(), kind.into())]);
        for (key, value) in parameters.iter().flat_map(|parameters| parameters.iter()) {
            let key: String = key.extract()?;
            let value = to_value(&key, &value)?;
            if of_model.contains(&key.as_str()) { &mut model } else { &mut own }.insert(key, value);
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
/// Returns a `TypeError` for any other type, and a `StudyError` for a number that is not finite and for too many levels;
/// `key` is the place of the value.
pub fn to_value(key: &str, value: &Bound<'_, PyAny>) -> PyResult<Value> {
    convert(key, value, MOST_LEVELS)
}

/// Converts a value with at most so many levels below it.
fn convert(key: &str, value: &Bound<'_, PyAny>, levels: usize) -> PyResult<Value> {
    if value.is_none() {
        return Ok(Value::Null);
    }
    if is_text(value) {
        return Ok(text(|| key.to_owned(), value)?.into());
    }
    if value.hasattr("__fspath__")? {
        return Ok(text(|| key.to_owned(), &value.call_method0("__fspath__")?)?.into());
    }
    if value.is_instance_of::<PyBool>() {
        return Ok(Value::Bool(value.extract()?));
    }
    // A series with names is a mapping.
    if !value.hasattr("keys")? {
        let plain = plain(value)?;
        if !plain.is(value) && !plain.hasattr("dtype")? {
            return convert(key, &plain, levels);
        }
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
    // A series of one number would be a number, too.
    match if value.hasattr("__len__")? { Ok(None) } else { number(value) } {
        Ok(None) => {}
        Ok(Some(number)) => return finite(key, number),
        Err(error) if error.is_instance_of::<PyOverflowError>(value.py()) => {
            let found = "a number with more than 308 digits";
            return Err(refused(key, "out of range", found, "a finite number").into());
        }
        Err(error) => return Err(error),
    }
    let Some(below) = levels.checked_sub(1) else {
        let found = format!("more than {MOST_LEVELS} levels, as of a value that contains itself");
        let allowed = format!("at most {MOST_LEVELS} levels of dicts and lists");
        return Err(refused(key, "nested too deeply", &found, &allowed).into());
    };
    let place = if key.is_empty() { "keys" } else { key };
    if let Some(names) = keys(place, value)? {
        let mut map = Map::new();
        for name in names {
            let path = if key.is_empty() { name.clone() } else { format!("{key}.{name}") };
            let inner = convert(&path, &value.get_item(&name)?, below)?;
            map.insert(name, inner);
        }
        return Ok(Value::Object(map));
    }
    if value.is_instance_of::<PySet>() || value.is_instance_of::<PyFrozenSet>() {
        return Err(wrong_type(key, value, "a list, because a set has no order"));
    }
    let Some(items) = items(value)? else {
        return Err(wrong_type(key, value, "numbers, text, and lists and dicts of them"));
    };
    let mut list = Vec::with_capacity(items.len());
    for (index, item) in items.iter().enumerate() {
        list.push(convert(&format!("{key}[{index}]"), item, below)?);
    }
    Ok(Value::Array(list))
}

/// Converts a number. A whole number is written as such, because arrays and dataframes hold whole numbers as floats.
fn finite(key: &str, number: f64) -> PyResult<Value> {
    let is_whole = number.fract() == 0.0 && number.abs() <= LARGEST_WHOLE;
    if is_whole && !(number == 0.0 && number.is_sign_negative()) {
        return Ok((number as i64).into());
    }
    let Some(finite) = Number::from_f64(number) else {
        return Err(
            refused(key, "not a finite number", &number.to_string(), "a finite number").into()
        );
    };
    Ok(Value::Number(finite))
}
