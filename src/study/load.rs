//! Reads study files: from text to a [`Study`].

use std::path::{Path, PathBuf};
use std::rc::Rc;

use serde_json::Value;

use crate::model::{Material, ModelKind};
use crate::study::error::{Fault, StudyError};
use crate::study::file::decode::decode;
use crate::study::file::key_path::{KeyPath, Segment};
use crate::study::file::key_units::{MATERIAL, split_unit};
use crate::study::file::kind_parameters::{axes_of, parameters_of, parameters_of_any};
use crate::study::file::ranges::expand_ranges;
use crate::study::file::resolved_yaml::block_text;
use crate::study::file::schema_place::SchemaPlace;
use crate::study::file::source::Source;
use crate::study::file::study_file::StudyFile;
use crate::study::file::table_folders::{TableFolders, read_text};
use crate::study::file::unit_keys::Names;
use crate::study::file::yaml_tree::{Content, YamlNode};
use crate::study::kinds::model_kind;
use crate::study::plan::planned_study::Study;
use crate::study::resolve::further_errors::{Found, leave_out, with_further_errors};
use crate::study::resolve::model::check_parameters;
use crate::study::resolve::system::read_system;
use crate::study::resolve::whole_study::resolve;
use crate::study::schema::DECLARED;

/// The version of the study file's format that this program reads.
const SCHEMA: u64 = 1;

impl Study {
    /// Reads and validates a study file and the tables that it names. Tables are in the directory
    /// of the study file or below it.
    pub fn load(path: &Path) -> Result<Study, StudyError> {
        Study::load_with_tables(path, &[])
    }

    /// Reads a study file like [`Study::load`], and grants access to tables in further directories
    /// and below them. The paths of tables stay relative to the study file, so that the directories
    /// never change the meaning of a study.
    pub fn load_with_tables(path: &Path, directories: &[PathBuf]) -> Result<Study, StudyError> {
        let text = read_text(path).map_err(|fault| StudyError::about_file(path, fault))?;
        Study::parse_with_tables(path, text, directories)
    }

    /// Parses a study from the text of a file of this name. The paths of tables are relative to
    /// this file.
    pub fn parse(file: &Path, text: String) -> Result<Study, StudyError> {
        Study::parse_with_tables(file, text, &[])
    }

    /// Parses a study from the keys and values of a study file. Messages show them in the notation of a file of this name,
    /// to which the paths of tables are relative, with access to tables in further directories.
    pub fn from_value(
        file: &Path,
        value: &Value,
        directories: &[PathBuf],
    ) -> Result<Study, StudyError> {
        Study::parse_with_tables(file, block_text(value), directories)
    }

    /// Parses a study like [`Study::parse`], and grants access to tables in further directories.
    pub fn parse_with_tables(
        file: &Path,
        text: String,
        directories: &[PathBuf],
    ) -> Result<Study, StudyError> {
        let is_short = text.len() <= MOST_REREAD;
        let copy = if is_short { text.clone() } else { String::new() };
        read(file, text, directories, &[]).map_err(|(_, error)| match is_short {
            true => with_further_errors(error, |without| {
                read(file, copy.clone(), directories, without).map(|_| ())
            }),
            false => error,
        })
    }
}

/// The longest study that is read again for further errors, in bytes.
const MOST_REREAD: usize = 100_000;

/// Reads a study without some of its keys.
fn read(
    file: &Path,
    text: String,
    directories: &[PathBuf],
    without: &[KeyPath],
) -> Result<Study, (Found, StudyError)> {
    let in_key = |error| (Found::InKey, error);
    let folders = TableFolders::new(file, directories).map_err(in_key)?;
    let mut source = Source::new(file, text, Rc::new(folders)).map_err(in_key)?;
    without.iter().for_each(|path| leave_out(&mut source.root, path));
    check_schema(&source).map_err(in_key)?;
    read_system(&mut source).map_err(in_key)?;
    expand_ranges(&mut source).map_err(in_key)?;
    add_restitution(&mut source.root);
    let names = Names::of(&source.root);
    check_parameters(&source, &names).map_err(in_key)?;
    let written: StudyFile =
        decode(&source, &names, Some(SchemaPlace::root(&DECLARED))).map_err(in_key)?;
    source.units = names.units.into_inner();
    let between = |error| (Found::BetweenKeys, error);
    resolve(&source, &written).map_err(between)
}

/// Checks the version first, because the keys of another version may be unknown.
fn check_schema(source: &Source) -> Result<(), StudyError> {
    let Some(node) = source.root.get("schema") else { return Ok(()) };
    match node.content {
        Content::Natural(SCHEMA) => Ok(()),
        _ => {
            let allowed = format!("{SCHEMA}, the version that this program reads");
            let fault = Fault::new("unknown version of the format", node.describe(), allowed);
            Err(source.path("schema").refuse_value(fault))
        }
    }
}

impl Names {
    /// Returns the names of a study.
    pub fn of(root: &YamlNode) -> Names {
        let kind = root.get("model").and_then(|model| model.get("kind")).map_or("", YamlNode::name);
        Names {
            parameters: model_kind(kind).map_or_else(parameters_of_any, parameters_of),
            coordinates: coordinates_of(model_kind(kind)),
            choices: names_of_choices(root),
            ..Names::default()
        }
    }
}

/// Gives the contact of balls the restitution of their material, unless it has its own.
fn add_restitution(root: &mut YamlNode) {
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
