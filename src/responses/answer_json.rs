//! Encodes answers as lines of JSON.

use serde_json::{Map, Value, json};

use super::respond::Answer;
use crate::classification::Label;
use crate::study::{ParameterValue, Study};

/// Returns the answer to a request. For a study with a single point it holds `responses`, `runs`, `failed` and
/// `discontinuous`, otherwise `points`, a list of such objects with the swept parameters of each point.
pub fn to_json(study: &Study, id: &Value, answers: &[Answer]) -> Value {
    let mut answer = Map::new();
    answer.insert("id".to_owned(), id.clone());
    match answers {
        [only] if study.swept().is_empty() => answer.extend(point_json(study, only)),
        _ => {
            let points = answers.iter().map(|answer| {
                let mut object = Map::new();
                object.insert("point_id".to_owned(), json!(answer.point_id));
                for (column, value) in study.swept().iter().zip(&answer.swept) {
                    let value = match value {
                        ParameterValue::Number(number) => json!(number),
                        ParameterValue::Text(text) => json!(text),
                    };
                    object.insert(column.name.clone(), value);
                }
                object.extend(point_json(study, answer));
                Value::Object(object)
            });
            answer.insert("points".to_owned(), points.collect());
        }
    }
    Value::Object(answer)
}

fn point_json(study: &Study, answer: &Answer) -> Map<String, Value> {
    let mut object = Map::new();
    let responses = study.responses().iter().zip(&answer.estimates);
    let responses = responses.map(|(one, estimate)| (one.name.clone(), json!(estimate)));
    object.insert("responses".to_owned(), Value::Object(responses.collect()));
    object.insert("runs".to_owned(), json!(answer.counts.total()));
    object.insert("failed".to_owned(), json!(answer.counts.of(Label::Failed)));
    object.insert("discontinuous".to_owned(), json!(answer.discontinuous));
    object
}
