//! Parts of the JSON Schema of a study file that depend on the parameters and coordinates of the models.

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde_json::{Map, Value};

use super::distribution_file::DistributionFile;
use super::values::{Entry, Range};
use crate::model::{Ball, Block, FrictionLaw, MAX_BALLS, Machine, Model};
use crate::study::plan::parameter::Parameter;
use crate::study::sampling::initial_box::axes_in_words;

/// The labels of runs that can be continued.
pub(crate) const EXTENDED_LABELS: [&str; 2] = ["undecided", "irregular"];

/// Returns the schema of lists of values by parameter.
pub(in crate::study) fn swept(generator: &mut SchemaGenerator) -> Schema {
    per_parameter(generator.subschema_for::<Vec<Entry>>(), &all_parameters())
}

/// Returns the schema of one value by parameter.
pub(in crate::study) fn selector(generator: &mut SchemaGenerator) -> Schema {
    per_parameter(generator.subschema_for::<Entry>(), &all_parameters())
}

/// Returns the schema of distributions by numeric parameter.
pub(in crate::study) fn uncertain(generator: &mut SchemaGenerator) -> Schema {
    let mut parameters = all_parameters();
    parameters.retain(|parameter| parameter.is_number());
    per_parameter(generator.subschema_for::<DistributionFile>(), &parameters)
}

/// Returns the schema of ranges by start coordinate.
pub(in crate::study) fn start_box(generator: &mut SchemaGenerator) -> Schema {
    let range = <Range as JsonSchema>::json_schema(generator);
    let models = all_models();
    let axes = models.iter().flat_map(axes_in_words);
    let properties: Map<String, Value> =
        axes.map(|(name, meaning)| (name, described(&range, meaning))).collect();
    json_schema!({ "type": "object", "properties": properties, "additionalProperties": false })
}

/// Returns the schema of the labels of runs that can be continued.
pub(in crate::study) fn extended_labels(_: &mut SchemaGenerator) -> Schema {
    json_schema!({
        "type": "array", "items": { "enum": EXTENDED_LABELS }, "minItems": 1, "uniqueItems": true
    })
}

/// Returns one model of every kind and every friction law, with the largest number of balls.
fn all_models() -> Vec<Model> {
    let laws = [
        FrictionLaw::Coulomb,
        FrictionLaw::Stribeck { static_friction_coefficient: 1.0, stribeck_speed: 0.0 },
        FrictionLaw::Smooth { smoothing_speed: 1.0 },
        FrictionLaw::Viscous { viscous_coefficient_n_s_m: 0.0 },
    ];
    let kinds = [
        Model::BallBalancer(Machine {
            balls: vec![Ball::default(); MAX_BALLS],
            ..Machine::default()
        }),
        Model::Block(Block::on_spring()),
        Model::Block(Block::on_belt()),
    ];
    let with = |model: &Model, law: FrictionLaw| {
        let mut model = model.clone();
        *model.friction_mut() = law;
        model
    };
    kinds.iter().flat_map(|model| laws.map(|law| with(model, law))).collect()
}

/// Returns every parameter of any model, without repeated names.
fn all_parameters() -> Vec<Parameter> {
    let mut parameters: Vec<Parameter> = Vec::new();
    for parameter in all_models().iter().flat_map(Parameter::all) {
        if !parameters.iter().any(|known| known.name() == parameter.name()) {
            parameters.push(parameter);
        }
    }
    parameters
}

/// Returns a schema with a description.
fn described(schema: &Schema, description: String) -> Value {
    let mut described = schema.clone().to_value();
    if let Value::Object(fields) = &mut described {
        fields.insert("description".to_owned(), Value::String(description));
    }
    described
}

fn per_parameter(value: Schema, parameters: &[Parameter]) -> Schema {
    let properties: Map<String, Value> = parameters
        .iter()
        .map(|parameter| {
            let unit = match parameter.unit() {
                "" => String::new(),
                "1" => ", dimensionless".to_owned(),
                unit => format!(", {unit}"),
            };
            (parameter.name(), described(&value, format!("{}{unit}.", parameter.meaning())))
        })
        .collect();
    json_schema!({ "type": "object", "properties": properties, "additionalProperties": false })
}
