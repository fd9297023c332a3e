//! A study file as it is written: the places of its keys, and the parameters that it gives.
//!
//! A resolved study has every default filled in and no places. Warnings need both.

use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};

use serde_json::Value;

use crate::study::error::{Location, shorten};
use crate::study::file::study_file::{ModelFile, StudyFile};
use crate::study::file::yaml_tree::{Content, Node};
use crate::study::plan::planned_study::Study;

/// The largest number of keys with a place; a study with more keys has no places for the others.
const MOST_PLACES: usize = 20_000;

/// The places of the keys of a study file, and the names of the parameters that it gives.
#[derive(Clone, Debug, Default)]
pub(in crate::study) struct Written {
    file: PathBuf,
    /// The place of each key path, such as `sweep[0].grid.speed_rad_s`.
    places: HashMap<String, Location>,
    /// The keys of `model.parameters`, and `friction` and `normal_force`, as far as the file contains them.
    given: HashSet<String>,
}

impl Written {
    /// Collects the keys of a study file.
    pub fn of(file: &Path, root: &Node, study: &StudyFile) -> Written {
        let given = given(&study.model);
        let mut written = Written { file: file.to_path_buf(), places: HashMap::new(), given };
        written.add("", root);
        written
    }

    fn add(&mut self, path: &str, node: &Node) {
        match &node.content {
            Content::Map(entries) => {
                for (key, value) in entries {
                    let name = shorten(key.name());
                    let path = if path.is_empty() { name } else { format!("{path}.{name}") };
                    let nested = matches!(value.content, Content::Map(_) | Content::List(_));
                    let place = if nested { key.place } else { value.place };
                    self.add_one(path, place, value);
                }
            }
            Content::List(items) => {
                // A list of numbers may be long, and its items have no keys.
                let maps = |item: &&(usize, &Node)| matches!(item.1.content, Content::Map(_));
                for (index, item) in items.iter().enumerate().take_while(|item| maps(&item)) {
                    self.add_one(format!("{path}[{index}]"), item.place, item);
                }
            }
            _ => {}
        }
    }

    fn add_one(&mut self, path: String, place: Location, value: &Node) {
        if self.places.len() < MOST_PLACES {
            self.places.insert(path.clone(), place);
            self.add(&path, value);
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

/// Returns the keys of the model that the file contains. The values of a ball have the keys of `model.parameters`.
fn given(model: &ModelFile) -> HashSet<String> {
    let values = serde_json::to_value(model).unwrap_or_default();
    let names = |value: &Value| -> Vec<String> {
        let entries = value.as_object().into_iter().flatten();
        entries.filter(|(_, value)| !value.is_null()).map(|(name, _)| name.clone()).collect()
    };
    let mut given: HashSet<String> = names(&values["parameters"]).into_iter().collect();
    given.extend(names(&values).into_iter().filter(|name| name != "parameters"));
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

    /// Returns whether the study file contains this key of `model.parameters`, or `friction` or `normal_force`.
    pub(in crate::study) fn gives(&self, name: &str) -> bool {
        self.written.given.contains(name)
    }

    /// Returns whether the study file contains this key path.
    pub(in crate::study) fn has_key(&self, key: &str) -> bool {
        self.written.places.contains_key(key)
    }
}
