//! Parameters that determine others: a density determines the mass of a ball. A study gives one of the two, wherever it does.

use std::collections::HashSet;

use crate::model::{ModelKind, ParameterDescriptor};
use crate::study::error::StudyError;
use crate::study::file::key_path::KeyPath;
use crate::study::file::model_parts::Balls;
use crate::study::file::source::Source;
use crate::study::file::study_file::StudyFile;
use crate::study::plan::parameter::{MOST_MEMBERS, Parameter};

/// Returns the names of the parameters that others determine, which are then no parameters of the study.
pub(crate) fn determined(
    source: &Source,
    kind: &'static ModelKind,
    written: &StudyFile,
    swept: &[Parameter],
) -> Result<Vec<&'static str>, StudyError> {
    let mentioned = mentioned(written, swept);
    let place_of = |parameter: &ParameterDescriptor| {
        let members = (1..=MOST_MEMBERS).map(|member| parameter.name_of_member(member));
        let names: HashSet<String> = members.chain([parameter.name.to_owned()]).collect();
        mentioned.iter().find(|(_, name)| names.contains(name))
    };
    let mut all = Vec::new();
    for parameter in kind.parameters {
        let Some(name) = parameter.determines() else { continue };
        let Some((own_section, written)) = place_of(parameter) else { continue };
        let other = kind.parameters.iter().find(|other| other.name == name);
        if let Some((section, given)) = other.and_then(place_of) {
            let as_written = |section: &str, name: &str| {
                let path = KeyPath::of(&format!("{section}.{name}"));
                let path = source.root.as_written(&path).to_string();
                path.rsplit('.').next().unwrap_or(name).to_owned()
            };
            let [first, second] = [(own_section, written), (section, given)]
                .map(|(section, name)| as_written(section, name));
            return Err(source.path(section).key(given).wrong_key(
                format!("`{first}` determines `{second}`"),
                format!("both `{first}` and `{second}`"),
                "one of the two",
            ));
        }
        all.push(name);
    }
    Ok(all)
}

/// Returns all parameters that the study gives, sweeps, draws, designs or infers, with the place in the file.
fn mentioned(written: &StudyFile, swept: &[Parameter]) -> Vec<(&'static str, String)> {
    let mut all: Vec<(&'static str, String)> = Vec::new();
    let parameters = written.model.parameters.as_ref();
    if let Some(parameters) = parameters {
        all.extend(parameters.numbers.keys().map(|name| ("model.parameters", name.clone())));
        if let Some(Balls::Each(balls)) = &parameters.balls {
            let has_mass = balls.iter().any(|ball| ball.mass_kg.is_some());
            all.extend(has_mass.then(|| ("model.parameters.balls", "ball_mass_kg".to_owned())));
        }
    }
    all.extend(swept.iter().map(|parameter| ("sweep", parameter.name())));
    let uncertain = written.uncertain.iter().flat_map(|names| names.keys());
    all.extend(uncertain.map(|name| ("uncertain", name.clone())));
    for (name, variable) in written.design.iter().flatten() {
        all.push(("design", name.clone()));
        let choices = variable.choices.iter().flatten().flat_map(|(_, values)| values.keys());
        all.extend(choices.map(|name| ("design", name.clone())));
    }
    let inferred = written.identify.iter().flat_map(|identify| identify.parameters.keys());
    all.extend(inferred.map(|name| ("identify.parameters", name.clone())));
    all
}
