//! The study file as it is written: the places and names of its keys, and the parameters that it gives.
//!
//! A resolved study has every default filled in and no places. Warnings need both.

use std::path::Path;

use crate::study::file::key_path::KeyPath;
use crate::study::file::yaml_tree::{Content, YamlNode};
use crate::study::plan::planned_runs::Plan;

impl Plan {
    /// Returns the file that contains the study.
    pub fn file(&self) -> &Path {
        &self.source.file
    }

    /// Returns the line and the column, from 1, of a key such as `model.parameters.balls`, or of the innermost key
    /// around it that the file contains.
    pub fn place_of(&self, key: &str) -> Option<[usize; 2]> {
        let mut node = &self.source.root;
        let mut place = None;
        for step in &KeyPath::parse(key)?.0 {
            let Some((key, value)) = node.below(step) else { break };
            let is_nested = matches!(value.content, Content::Map(_) | Content::List(_));
            let here = if is_nested { key.place } else { value.place };
            (node, place) = (value, Some([here.line, here.column]));
        }
        place
    }

    /// Returns the key path as the file writes it, if the file writes the key without the unit of its name, such as
    /// `model.parameters.speed: 6000 rpm`.
    pub fn key_with_unit(&self, key: &str) -> Option<String> {
        let path = KeyPath::parse(key)?;
        let written = self.source.root.as_written(&path);
        (written != path).then(|| written.to_string())
    }

    /// Returns whether the study file contains this key path.
    pub(crate) fn has_key(&self, key: &str) -> bool {
        KeyPath::parse(key).is_some_and(|path| self.source.root.at(&path).is_some())
    }

    /// Returns whether the study file contains this key of `model.parameters` or of `model`, or a value of a key of
    /// its own, such as `contact_restitution`.
    pub(in crate::study) fn gives(&self, name: &str) -> bool {
        let has = |key: String| self.has_key(&key);
        let of_contact = || {
            let key = name.strip_prefix("contact_")?;
            let keys = [key.to_owned(), format!("material_{key}")];
            Some(keys.into_iter().any(|key| has(format!("model.contact.{key}"))))
        };
        has(format!("model.parameters.{name}"))
            || has(format!("model.{name}"))
            || of_contact().unwrap_or(false)
            || name == "speed_rad_s" && self.profile_gives_speed()
    }

    /// Returns whether the last change of the speed profile gives the speed of the machine.
    fn profile_gives_speed(&self) -> bool {
        let parts = self.source.root.at(&KeyPath::of("model.speed_profile"));
        let Some(Content::List(parts)) = parts.map(|parts| &parts.content) else { return false };
        let last = parts.iter().rev().find(|part| part.get("hold_s").is_none());
        let is_given = |part: &YamlNode| {
            let shapes = ["ramp", "smooth_ramp"].into_iter().filter_map(|shape| part.get(shape));
            let mut ends = shapes.map(|ramp| ramp.get("to_rad_s").is_some());
            ends.next().unwrap_or(true)
        };
        last.is_some_and(is_given)
    }
}
