//! Encodes answers as lines of JSON.

use indexmap::IndexMap;
use serde::Serialize;
use serde_json::{Value, json};

use super::respond::Answer;
use crate::classification::Label;
use crate::study::{DesignValue, ParameterValue, Study, Variable, VariedParameter};

/// Returns the answer to a request. For a study with a single point it holds `responses`, `runs`, `failed` and
/// `discontinuous`, otherwise `points`, a list of such objects with the swept parameters of each point.
pub fn to_json(study: &Study, id: &Value, answers: &[Answer]) -> Value {
    let id = json!({"id": id});
    if let ([only], []) = (answers, study.swept()) {
        return merged(id, point_json(study, only));
    }
    let point = |answer: &Answer| {
        let keys = point_keys(answer.point_id, study.swept(), &answer.swept);
        merged(keys, point_json(study, answer))
    };
    merged(id, json!({"points": answers.iter().map(point).collect::<Vec<Value>>()}))
}

/// Returns the start of a point's JSON object: its number and the values of its swept parameters.
pub(crate) fn point_keys(
    point_id: u64,
    columns: &[VariedParameter],
    swept: &[ParameterValue],
) -> Value {
    let swept = columns.iter().zip(swept).map(|(column, value)| (&column.name, value));
    merged(json!({"point_id": point_id}), swept.collect::<IndexMap<_, _>>())
}

/// Returns the object `first` with the keys of the object `second` added; `None` has no keys.
pub(crate) fn merged(mut first: Value, second: impl Serialize) -> Value {
    if let (Value::Object(first), Value::Object(second)) = (&mut first, json!(second)) {
        first.extend(second);
    }
    first
}

/// Adds a key to an object, unless its value is `None`.
pub(crate) fn add_known(object: &mut Value, key: &str, value: Option<impl Serialize>) {
    if let Some(value) = value {
        object[key] = json!(value);
    }
}

/// Returns the values of a design as a JSON object.
pub(crate) fn design_json(study: &Study, values: &[DesignValue]) -> Value {
    let value = |(variable, value): (&Variable, &DesignValue)| {
        let json = match value {
            DesignValue::Number(number) => json!(number),
            DesignValue::Choice(_) => json!(variable.describe(*value)),
        };
        (variable.name().to_owned(), json)
    };
    study.variables().iter().zip(values).map(value).collect::<serde_json::Map<_, _>>().into()
}

fn point_json(study: &Study, answer: &Answer) -> Value {
    let estimates = study.responses().iter().zip(&answer.estimates);
    let estimates = estimates.map(|(response, estimate)| (&response.name, estimate));
    json!({
        "responses": estimates.collect::<IndexMap<_, _>>(),
        "runs": answer.counts.total(),
        "failed": answer.counts.of(Label::Failed),
        "discontinuous": answer.discontinuous,
    })
}
