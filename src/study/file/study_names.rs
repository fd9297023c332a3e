//! The names of a study that depend on the kind of its model.

use crate::model::{Material, ModelKind};
use crate::study::file::key_path::Segment;
use crate::study::file::key_units::{MATERIAL, split_unit};
use crate::study::file::kind_parameters::{axes_of, parameters_of, parameters_of_any};
use crate::study::file::unit_keys::Names;
use crate::study::file::yaml_tree::{Content, YamlNode};
use crate::study::kinds::model_kind;

impl Names {
    /// Returns the names of a study.
    pub fn of(root: &YamlNode) -> Names {
        let kind = root.get("model").and_then(|model| model.get("kind")).map_or("", YamlNode::name);
        let parameters = model_kind(kind).map_or_else(parameters_of_any, parameters_of);
        Names::new(parameters, coordinates_of(model_kind(kind)), names_of_choices(root))
    }
}

/// Gives the contact of balls the restitution of their material, unless it has its own.
pub(in crate::study) fn add_restitution(root: &mut YamlNode) {
    let material = (|| root.get("model")?.get("parameters")?.get(MATERIAL))();
    let restitution = material.and_then(|name| Material::named(name.name())?.restitution);
    let contact = ["model", "contact"].map(|key| Segment::Key(key.to_owned()));
    let (Some(restitution), Some(YamlNode { place, content: Content::Map(law) })) =
        (restitution, root.at_mut(&contact))
    else {
        return;
    };
    let names = ["restitution", "material_restitution"];
    if law.iter().all(|(key, _)| !names.contains(&key.name())) {
        let node = |content| YamlNode { place: *place, content };
        let key = node(Content::Text("material_restitution".to_owned()));
        law.push((key, node(Content::Number(restitution))));
    }
}

/// Returns the names of the coordinates of this kind of model that end with a unit, and those of a block.
fn coordinates_of(kind: Option<&'static ModelKind>) -> Vec<String> {
    let mut names = ["position_m", "velocity_m_s"].map(str::to_owned).to_vec();
    names.extend(kind.into_iter().flat_map(axes_of).filter(|name| split_unit(name).is_some()));
    names.sort_unstable();
    names.dedup();
    names
}

/// Returns the variables with choices. A variable with choices may have the name of a parameter without its unit.
fn names_of_choices(root: &YamlNode) -> Vec<String> {
    let Some(Content::Map(variables)) = root.get("design").map(|design| &design.content) else {
        return Vec::new();
    };
    let choices = variables.iter().filter(|(_, value)| value.get("choices").is_some());
    choices.map(|(key, _)| key.name().to_owned()).collect()
}
