//! A study file as it is written: the places and names of its keys, and the parameters that it gives.
//!
//! A resolved study has every default filled in and no places. Warnings need both.

use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};

use serde_json::Value;

use crate::study::error::{Location, shorten};
use crate::study::file::stages_file::ProfilePartFile;
use crate::study::file::study_file::{ModelFile, StudyFile};
use crate::study::file::yaml_tree::{Content, Node, Source};
use crate::study::plan::planned_study::Study;

/// The largest number of keys with a place; a study with more keys has no places for the others.
const MOST_PLACES: usize = 20_000;

/// The places of the keys of a study file, and the names of the parameters that it gives.
#[derive(Clone, Debug, Default)]
pub(in crate::study) struct Written {
    file: PathBuf,
    /// The place of each key path, such as `sweep[0].grid.speed_rad_s`.
    places: HashMap<String, Location>,
    /// The key paths that the file writes with other keys, such as `speed` for `speed_rad_s`, with the written path.
    renamed: HashMap<String, String>,
    /// The keys of `model.parameters`, and `friction` and `normal_force`, as far as the file contains them.
    given: HashSet<String>,
}

impl Written {
    /// Collects the keys of a study file.
    pub fn of(file: &Path, source: &Source, study: &StudyFile) -> Written {
        let given = given(&study.model);
        let mut written = Written { file: file.to_path_buf(), given, ..Written::default() };
        let place = |place: &Location| [place.line, place.column];
        let names =
            source.renamed.iter().map(|(renamed, name)| (place(renamed), name.as_str())).collect();
        written.add(&Keys { path: String::new(), written: String::new() }, &source.root, &names);
        written
    }

    fn add(&mut self, keys: &Keys, node: &Node, names: &HashMap<[usize; 2], &str>) {
        match &node.content {
            Content::Map(entries) => {
                for (key, value) in entries {
                    let name = shorten(key.name());
                    let written = names.get(&[key.place.line, key.place.column]);
                    let written = written.map_or_else(|| name.clone(), |name| shorten(name));
                    let below = keys.below(&name, &written);
                    let nested = matches!(value.content, Content::Map(_) | Content::List(_));
                    let place = if nested { key.place } else { value.place };
                    self.add_one(below, place, value, names);
                }
            }
            Content::List(items) => {
                // A list of numbers may be long, and its items have no keys.
                let maps = |item: &&(usize, &Node)| matches!(item.1.content, Content::Map(_));
                for (index, item) in items.iter().enumerate().take_while(|item| maps(&item)) {
                    self.add_one(keys.item(index), item.place, item, names);
                }
            }
            _ => {}
        }
    }

    fn add_one(
        &mut self,
        keys: Keys,
        place: Location,
        value: &Node,
        names: &HashMap<[usize; 2], &str>,
    ) {
        if self.places.len() < MOST_PLACES {
            self.places.insert(keys.path.clone(), place);
            if keys.path != keys.written {
                self.renamed.insert(keys.path.clone(), keys.written.clone());
            }
            self.add(&keys, value, names);
        }
    }

    /// Returns the place of a key, or of the innermost key around it that the file contains.
    fn place(&self, key: &str) -> Option<Location> {
        let mut key = key;
        loop {
            if let Some(place) = self.places.get(key) {
                return Some(*place);
            }
            key = &key[..key.rfind(['.', '['])?];
        }
    }
}

/// A key path, and the same path as the file writes it.
struct Keys {
    path: String,
    written: String,
}

impl Keys {
    /// Returns the paths of a key below this one.
    fn below(&self, name: &str, written: &str) -> Keys {
        let joined = |path: &str, name: &str| match path {
            "" => name.to_owned(),
            path => format!("{path}.{name}"),
        };
        Keys { path: joined(&self.path, name), written: joined(&self.written, written) }
    }

    /// Returns the paths of an item of the list at this path.
    fn item(&self, index: usize) -> Keys {
        let item = |path: &str| format!("{path}[{index}]");
        Keys { path: item(&self.path), written: item(&self.written) }
    }
}

/// Returns the keys of the model that the file contains. The values of a ball have the keys of `model.parameters`.
fn given(model: &ModelFile) -> HashSet<String> {
    let values = serde_json::to_value(model).unwrap_or_default();
    let names = |value: &Value| -> Vec<String> {
        let entries = value.as_object().into_iter().flatten();
        entries.filter(|(_, value)| !value.is_null()).map(|(name, _)| name.clone()).collect()
    };
    let mut given: HashSet<String> = names(&values["parameters"]).into_iter().collect();
    given.extend(names(&values).into_iter().filter(|name| name != "parameters"));
    let law = names(&values["contact"]).into_iter();
    given.extend(law.map(|name| format!("contact_{}", name.trim_start_matches("material_"))));
    // The last change of a speed profile gives the speed of the machine.
    let last = model.speed_profile.iter().flatten().rev().find_map(|part| match part {
        ProfilePartFile::HoldS(_) => None,
        ProfilePartFile::Table(_) => Some(true),
        ProfilePartFile::Ramp(ramp) | ProfilePartFile::SmoothRamp(ramp) => {
            Some(ramp.to_rad_s.is_some())
        }
    });
    given.extend(last.filter(|is_given| *is_given).map(|_| "speed_rad_s".to_owned()));
    given
}

impl Study {
    /// Returns the file that contains the study.
    pub fn file(&self) -> &Path {
        &self.written.file
    }

    /// Returns the line and the column, from 1, of a key such as `model.parameters.balls`, or of the innermost key
    /// around it that the file contains.
    pub fn place_of(&self, key: &str) -> Option<[usize; 2]> {
        self.written.place(key).map(|place| [place.line, place.column])
    }

    /// Returns the key path as the file writes it, if the file writes the key without the unit of its name, such as
    /// `model.parameters.speed: 6000 rpm`.
    pub fn key_with_unit(&self, key: &str) -> Option<&str> {
        self.written.renamed.get(key).map(String::as_str)
    }

    /// Returns whether the study file contains this key of `model.parameters`, or `friction` or `normal_force`.
    pub(in crate::study) fn gives(&self, name: &str) -> bool {
        self.written.given.contains(name)
    }

    /// Returns whether the study file contains this key path.
    pub(crate) fn has_key(&self, key: &str) -> bool {
        self.written.places.contains_key(key)
    }
}
