//! Rules of the JSON Schema that the types of the study file do not express: which keys go together, and which names a
//! kind of model has.

use serde_json::{Map, Value, json};

use super::key_units::split_unit;
use super::kind_parameters::{axes_of, numeric_parameters_of, parameters_of};
use super::parameters_file::BALLS;
use crate::classification::Label;
use crate::model::{FRICTION_LAWS, LawParameter, ModelKind, ParameterDescriptor};
use crate::study::kinds::model_kinds;

/// Returns the keys of an expectation that are fractions.
fn fractions() -> impl Iterator<Item = String> {
    let of_labels = Label::names().map(|label| format!("{label}_fraction"));
    of_labels.chain(["audit_flip_rate".to_owned()])
}

/// Adds the rules.
pub(in crate::study) fn add_rules(schema: &mut Value) {
    let required = |keys: &[&str]| json!({ "required": keys });
    let own_designs = json!({
        "properties": { "sweep": { "items": required(&["design"]) } }, "required": ["sweep"]
    });
    let common_design = json!({ "properties": { "initial_conditions": required(&["design"]) } });
    let fraction = json!({ "items": { "minimum": 0, "maximum": 1 } });
    let rules = [
        (
            "/$defs/BlockFile",
            json!({ "oneOf": [required(&["grid"]), required(&["zip"]), required(&["table"])] }),
        ),
        // `max_runs` and at least one half width.
        ("/$defs/PrecisionFile", json!({ "minProperties": 2 })),
        ("/$defs/LimitFile", json!({ "anyOf": [required(&["at_least"]), required(&["at_most"])] })),
        (
            "/$defs/OptimizeFile",
            json!({ "anyOf": [required(&["minimize"]), required(&["maximize"])] }),
        ),
        (
            "/$defs/ExpectationFile",
            json!({ "anyOf": fractions().map(|name| required(&[&name])).collect::<Vec<_>>() }),
        ),
        ("/$defs/ModelFile", json!({ "oneOf": [required(&["kind"]), required(&["system"])] })),
        ("/$defs/VariableFile", range_or_choices()),
        ("/$defs/VariableFileWithUnits", range_or_choices()),
        (
            "",
            json!({ "dependentSchemas": { "optimize": {
            "required": ["design", "responses"],
            "properties": { "design": { "minProperties": 1 }, "responses": { "minProperties": 1 } },
        } } }),
        ),
        ("", json!({ "allOf": [{ "anyOf": [common_design, own_designs] }] })),
    ];
    if let Some(Value::Object(model)) = schema.pointer_mut("/$defs/ModelFile") {
        model.shift_remove("required");
    }
    for (pointer, rule) in rules {
        merge(schema.pointer_mut(pointer), rule);
    }
    for name in fractions() {
        let pointer = format!("/$defs/ExpectationFile/properties/{name}");
        merge(schema.pointer_mut(&pointer), fraction.clone());
    }
    for name in ["DistributionFile", "DistributionFileWithUnits"] {
        let forms =
            schema.pointer_mut(&format!("/$defs/{name}/oneOf")).and_then(Value::as_array_mut);
        for form in forms.into_iter().flatten() {
            let weights = form.pointer_mut("/properties/choice/properties/weights");
            merge(weights, json!({ "items": { "type": "number", "minimum": 0 }, "minItems": 1 }));
        }
    }
    let parameters = schema.pointer("/$defs/ParametersFile/properties");
    let parameters = parameters.and_then(Value::as_object).cloned().unwrap_or_default();
    let of_kinds = model_kinds().iter().map(|kind| {
        let name = kind.name;
        let is_kind = json!({ "properties": { "kind": { "const": name } }, "required": ["kind"] });
        json!({
            "if": { "properties": { "model": is_kind }, "required": ["model"] },
            "then": { "properties": of_kind(kind, &parameters) },
        })
    });
    merge(Some(schema), json!({ "allOf": of_kinds.collect::<Vec<Value>>() }));
}

/// A variable has either a range or choices.
fn range_or_choices() -> Value {
    json!({ "oneOf": [
        { "required": ["from", "to"], "not": { "required": ["choices"] } },
        {
            "required": ["choices"],
            "not": { "anyOf": [{ "required": ["from"] }, { "required": ["to"] }] },
        },
    ] })
}

/// Returns the rules of a model without balls, which has none of their keys; a part of it may turn.
fn without_balls(turns: bool) -> Value {
    let of_disc: &[&str] = if turns { &[] } else { &["speed_profile", "protocol"] };
    ["normal_force", "contact", "disturbances"]
        .iter()
        .chain(of_disc)
        .map(|key| ((*key).to_owned(), json!(false)))
        .collect::<Map<String, Value>>()
        .into()
}

/// Returns the rules of the top-level keys for a kind of model; `parameters` are the keys of any model's parameters.
fn of_kind(kind: &'static ModelKind, parameters: &Map<String, Value>) -> Value {
    let has_balls = kind.parameters.iter().any(ParameterDescriptor::is_of_each_ball);
    let [mut swept, numeric] = [parameters_of(kind), numeric_parameters_of(kind)].map(with_short);
    swept.extend(has_balls.then(|| BALLS.to_owned()));
    let is_count = |name: &str| {
        kind.parameters.iter().any(|entry| entry.name == name && entry.largest_count().is_some())
    };
    let is_key =
        |name: &&String| numeric.contains(name) || has_balls && *name == BALLS || is_count(name);
    let keys: Vec<&String> = parameters.keys().filter(is_key).collect();
    let names = |names: &[String]| json!({ "propertyNames": { "enum": names } });
    let friction = FRICTION_LAWS.iter().filter_map(|law| {
        let used = |entry: &LawParameter| entry.name(kind.sliding_speed);
        let foreign = law
            .parameters()
            .iter()
            .flat_map(|entry| entry.names().into_iter().filter(move |name| *name != used(entry)));
        let foreign: Map<String, Value> =
            foreign.map(|name| (name.to_owned(), json!(false))).collect();
        (!foreign.is_empty()).then(|| (law.name().to_owned(), json!({ "properties": foreign })))
    });
    let friction: Map<String, Value> = friction.collect();
    let mut model = json!({
        "parameters": { "propertyNames": { "enum": keys } },
        "friction": { "properties": friction },
    });
    let mut variables: Map<String, Value> =
        numeric.iter().map(|name| (name.clone(), json!({}))).collect();
    if has_balls {
        let number = json!({ "type": "integer", "minimum": 1, "maximum": 8 });
        let balls = json!({ "properties": { "from": number, "to": number } });
        variables.insert(BALLS.to_owned(), balls);
    } else {
        let turns = kind.parameters.iter().any(|entry| entry.own_key() == Some("speed_profile"));
        merge(Some(&mut model), without_balls(turns));
    }
    json!({
        "model": { "properties": model },
        "sweep": { "items": { "properties": { "grid": names(&swept), "zip": names(&swept) } } },
        "uncertain": names(&numeric),
        "uncertain_sampling": { "properties": { "correlations": { "items": { "properties": {
            "parameters": { "items": { "enum": numeric } }
        } } } } },
        "expect": { "items": { "properties": { "point": names(&swept) } } },
        "design": {
            "properties": variables,
            "additionalProperties": {
                "required": ["choices"],
                "properties": { "choices": { "additionalProperties": names(&numeric) } },
            },
        },
        "identify": { "properties": { "parameters": names(&numeric) } },
        "initial_conditions": { "properties": { "box": names(&with_short(axes_of(kind))) } },
    })
}

/// Returns names, and the names without units.
fn with_short(names: Vec<String>) -> Vec<String> {
    let short = names.iter().filter_map(|name| split_unit(name));
    let mut short: Vec<String> = short.map(|(short, _)| short.to_owned()).collect();
    short.extend(names);
    short.sort();
    short.dedup();
    short
}

/// Adds the fields of a rule to a schema; `allOf` is continued.
fn merge(schema: Option<&mut Value>, rule: Value) {
    let (Some(Value::Object(fields)), Value::Object(rule)) = (schema, rule) else { return };
    for (key, value) in rule {
        match (fields.get_mut(&key), value) {
            (Some(Value::Array(all)), Value::Array(more)) if key == "allOf" => all.extend(more),
            (_, value) => {
                fields.insert(key, value);
            }
        }
    }
}
