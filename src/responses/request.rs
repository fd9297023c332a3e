//! A request: one line of JSON with a value for every variable, or the reason why it is invalid.

use std::fmt;

use serde::de::{Deserializer, MapAccess, Visitor};
use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::study::{DesignValue, Plan, Study, list_names, shorten};
use crate::tabular::Fault;

/// A request of an optimiser.
#[derive(Clone, Debug)]
pub struct Request {
    /// The request's `id`; null if it has none.
    pub id: Value,
    /// One value per variable of the study, and the plan with these values; or the reason why the request is invalid.
    pub design: Result<(Vec<DesignValue>, Box<Plan>), RequestError>,
}

/// The reason why a request is invalid.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RequestError {
    /// The variable with the invalid value, if it is one.
    #[serde(skip_serializing_if = "Option::is_none")]
    variable: Option<String>,
    #[serde(flatten)]
    fault: Fault,
}

impl RequestError {
    fn of_line(problem: &str, found: impl Into<String>) -> RequestError {
        let allowed = "one JSON object per line, with a value for each variable";
        RequestError { variable: None, fault: Fault::new(problem, found, allowed) }
    }
}

impl Request {
    /// Returns the invalid request of a line that is longer than `most` bytes.
    pub fn too_long(most: usize) -> Request {
        let error = RequestError::of_line("line too long", format!("more than {most} bytes"));
        Request { id: Value::Null, design: Err(error) }
    }

    /// Parses a line.
    pub fn read(study: &Study, line: &[u8]) -> Request {
        match serde_json::from_slice::<RequestEntries>(line) {
            Err(error) => {
                let text = String::from_utf8_lossy(line);
                let found = format!("{} ({error})", shorten(&text));
                let design = Err(RequestError::of_line("not a request", found));
                Request { id: Value::Null, design }
            }
            Ok(entries) => {
                let id = entries.get("id").cloned().unwrap_or_default();
                Request { id, design: read_design(study, &entries) }
            }
        }
    }
}

/// The entries of a JSON object, also those with the same name, which a map would lose.
#[derive(Default)]
struct RequestEntries(Vec<(String, Value)>);

impl RequestEntries {
    fn get(&self, name: &str) -> Option<&Value> {
        self.0.iter().find(|(other, _)| other == name).map(|(_, value)| value)
    }
}

impl<'de> Visitor<'de> for RequestEntries {
    type Value = Self;

    fn expecting(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str("names and values")
    }

    fn visit_map<A: MapAccess<'de>>(mut self, mut map: A) -> Result<Self, A::Error> {
        while let Some(entry) = map.next_entry()? {
            self.0.push(entry);
        }
        Ok(self)
    }
}

impl<'de> Deserialize<'de> for RequestEntries {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_map(RequestEntries::default())
    }
}

fn read_design(
    study: &Study,
    given: &RequestEntries,
) -> Result<(Vec<DesignValue>, Box<Plan>), RequestError> {
    let variables = study.variables();
    for (index, (name, value)) in given.0.iter().enumerate() {
        let about = |fault| Err(RequestError { variable: Some(shorten(name)), fault });
        if name != "id" && !variables.iter().any(|variable| variable.name() == name) {
            let names: Vec<&str> = variables.iter().map(|variable| variable.name()).collect();
            let allowed = match list_names(name, &names) {
                names if names.is_empty() => "no variable: the study has no `design`".to_owned(),
                names => names,
            };
            return about(Fault::new("not a variable", shorten(name), allowed));
        }
        if given.0.iter().take(index).any(|(other, _)| other == name) {
            let found = shorten(&value.to_string());
            return about(Fault::new("given twice", found, "each variable once"));
        }
    }
    let mut values = Vec::with_capacity(variables.len());
    for variable in variables {
        let value = match given.get(variable.name()) {
            None => Err(Fault::new("missing", "no value", variable.allowed())),
            Some(Value::String(word)) => variable.word(word),
            Some(value) => match value.as_f64().filter(|number| number.is_finite()) {
                Some(number) => variable.number(number),
                None => {
                    let found = shorten(&value.to_string());
                    Err(Fault::new("neither a number nor text", found, variable.allowed()))
                }
            },
        };
        let name = || Some(variable.name().to_owned());
        values.push(value.map_err(|fault| RequestError { variable: name(), fault })?);
    }
    let set = study.with_design(&values).map_err(|fault| RequestError { variable: None, fault })?;
    Ok((values, Box::new(set)))
}
