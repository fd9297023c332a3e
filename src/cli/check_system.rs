//! The system file of a study for `check`: its equations as they were read, and what the program can prove about its rest.

use serde_json::Value;

use crate::model::{Graph, Model};
use crate::printed_table::text_table;
use crate::study::Study;

/// Returns the equations as lines of text; nothing for a kind of model that no file defines.
pub(super) fn system_text(study: &Study) -> String {
    let Some(source) = study.model().kind().source() else { return String::new() };
    let row = |name: String, text: String| [String::new(), name, text];
    let named = |key: &str, word: &'static str| {
        entries(&source[key]).map(move |(name, node)| row(format!("{word} {name}"), in_words(node)))
    };
    let mut rows: Vec<[String; 3]> = named("coordinates", "coordinate").collect();
    for (line, columns) in entries(&source["mass"]) {
        for (column, formula) in entries(columns) {
            rows.push(row(format!("mass {line}, {column}"), in_words(formula)));
        }
    }
    for (key, word) in
        [("force", "force"), ("contacts", "contact"), ("outputs", "output"), ("derived", "derived")]
    {
        rows.extend(named(key, word));
    }
    for (name, node) in entries(&source["motions"]) {
        let table = node["table"]["rows"].as_array().map_or(&[][..], Vec::as_slice);
        let end = table.last().map_or("0".to_owned(), |row| in_words(&row[0]));
        let keys = entries(node).filter(|(key, _)| *key != "table");
        let keys = keys.map(|(key, value)| format!("{key}: {}, ", in_words(value)));
        let text = format!("{}{} rows until {end} s", keys.collect::<String>(), table.len());
        rows.push(row(format!("motion {name}"), text));
    }
    for key in ["turning", "period"] {
        rows.extend(source.get(key).map(|value| row(key.to_owned(), in_words(value))));
    }
    rows.push(row("rest".to_owned(), rest_in_words(study.model())));
    format!("\nsystem ({})\n{}", study.model().kind().name, text_table(&rows, &[0, 1, 2]))
}

fn entries(map: &Value) -> impl Iterator<Item = (&String, &Value)> {
    map.as_object().into_iter().flatten()
}

/// Returns a value as a study file may write it, on one line.
fn in_words(value: &Value) -> String {
    match value {
        Value::String(text) => text.split_whitespace().collect::<Vec<_>>().join(" "),
        Value::Object(fields) => {
            let each = fields.iter().map(|(key, value)| format!("{key}: {}", in_words(value)));
            each.collect::<Vec<_>>().join(", ")
        }
        Value::Array(items) => {
            format!("[{}]", items.iter().map(in_words).collect::<Vec<_>>().join(", "))
        }
        other => other.to_string(),
    }
}

/// Returns whether a rest with all contacts sticking can be certified.
fn rest_in_words(model: &Model) -> String {
    let Some(system) = model.system() else { return String::new() };
    if system.contacts() == 0 {
        return "where all forces vanish and small motions decay".to_owned();
    }
    let graph = Graph::of(system.as_ref());
    let contacts = 0..system.contacts();
    let without: Vec<String> = contacts
        .filter(|contact| system.friction(*contact).can_stick() && !graph.holds_position(*contact))
        .map(|contact| model.contact_in_words(contact))
        .collect();
    match without.is_empty() {
        true => "certified where all contacts stick and cannot break loose again".to_owned(),
        false => format!(
            "certified where contacts hold all bodies in all directions; not while one of them moves on, because {} may stick \
             while all coordinates move, or has a sliding speed with factors that change",
            without.join(", ")
        ),
    }
}
