//! Answers as rows of `responses.parquet`, one per design and point of the sweep, and as lines of JSON.

use indexmap::IndexMap;
use serde::Serialize;
use serde_json::{Value, json};

use super::respond::Answer;
use crate::classification::Label;
use crate::study::{DesignValue, ParameterValue, Study, Variable, VariedParameter};
use crate::table::column::{Column, Columns};
use crate::table::{add_estimate, add_swept};

/// Returns the answer of a row.
pub(super) type OfRow<R> = fn(&R) -> &Answer;

/// Returns the columns of `responses.parquet`.
pub fn response_columns(study: &Study) -> Vec<Column<Answer>> {
    let mut list = Columns::<Answer>::new();
    list.extend(answer_columns(study, |row: &Answer| row));
    list.boolean("discontinuous", |row| row.discontinuous).meaning(
        "whether the fractions of labels differ from those of a nearest other design (all tests of \
         a table together err with 1 %)",
    );
    list.finish()
}

/// Returns the columns of an answer, for any type of row that contains one.
pub(crate) fn answer_columns<R: 'static>(study: &Study, of: OfRow<R>) -> Vec<Column<R>> {
    let mut list = Columns::new();
    list.count("design", move |row| of(row).design)
        .meaning("number of the design, from 0 in the order of the table of designs");
    add_variables(&mut list, study, move |row| of(row).values.as_slice());
    list.count("point_id", move |row| of(row).point_id)
        .meaning("number of the sweep's point, from 0");
    add_swept(&mut list, study, move |row| &of(row).swept);
    for (index, response) in study.responses().iter().enumerate() {
        let (name, unit, meaning) = (&response.name, response.unit(), response.meaning());
        add_estimate(&mut list, name, unit, &meaning, move |row| of(row).estimates.get(index));
    }
    list.count("runs", move |row| of(row).counts.total())
        .meaning("runs of the design at the point");
    for label in Label::ALL {
        list.count(label.name(), move |row| of(row).counts.of(label)).meaning(match label {
            Label::Failed => "runs that failed".to_owned(),
            _ => format!("runs that ended as {}", label.name()),
        });
    }
    list.finish()
}

/// Adds one column per variable of a design.
pub(crate) fn add_variables<R: 'static>(
    list: &mut Columns<R>,
    study: &Study,
    of: impl Fn(&R) -> &[DesignValue] + Copy + Send + Sync + 'static,
) {
    for (index, variable) in study.variables().iter().enumerate() {
        let column = match variable.unit() {
            Some(unit) => {
                list.number(variable.name(), unit, move |row| match of(row).get(index)? {
                    DesignValue::Number(number) => Some(*number),
                    DesignValue::Choice(_) => None,
                })
            }
            None => {
                let copy = variable.clone();
                list.text(variable.name(), move |row| Some(copy.describe(*of(row).get(index)?)))
            }
        };
        column.meaning(variable.meaning());
    }
}

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
