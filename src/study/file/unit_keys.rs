//! Keys without a unit, such as `speed: 6000 rpm` beside `speed_rad_s: 628.3`: the decoder reads each as the SI key with a
//! number, so that the rest of the program knows SI keys only.

use std::cell::RefCell;

use crate::model::{MATERIALS, Material};
use crate::study::error::{Fault, list_names, shorten};
use crate::study::file::key_units::{DENSITY, MATERIAL, split_unit};
use crate::study::file::quantity::{convert, decimal_comma, measured, split_number};
use crate::study::file::yaml_tree::{Content, YamlNode};

/// The names that a map may have as its keys.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::study) enum Keys {
    /// Those of a type.
    Of(&'static [&'static str]),
    /// The parameters of the model.
    Parameters,
    /// The parameters of the model, and choices of other names.
    Variables,
    /// Any names, for maps whose keys are parameters.
    ParametersOfEach,
    /// The coordinates of the model.
    Coordinates,
}

impl Keys {
    /// Returns the names below a key whose map has names of the model.
    pub(super) fn below(key: &str) -> Option<Keys> {
        match key {
            "parameters" | "grid" | "zip" | "uncertain" | "point" => Some(Keys::Parameters),
            "design" | "compare_with" => Some(Keys::Variables),
            "choices" => Some(Keys::ParametersOfEach),
            "box" => Some(Keys::Coordinates),
            _ => None,
        }
    }
}

/// A key with a unit.
#[derive(Clone, Copy, Debug)]
pub(in crate::study) struct UnitKey<'a> {
    si: &'a str,
    /// The name without the unit.
    short: &'a str,
    unit: &'static str,
    values: ValueNotation,
}

/// How the values of a key are written.
#[derive(Clone, Copy, Debug, PartialEq)]
enum ValueNotation {
    Numbers,
    WithUnits,
    Either,
}

/// What a study calls by names that depend on its model; nothing for a file that is no study.
#[derive(Default)]
pub(in crate::study) struct Names {
    pub parameters: Vec<String>,
    /// The coordinates with a unit.
    pub coordinates: Vec<String>,
    /// The design's variables with choices.
    pub choices: Vec<String>,
    /// The first unit of each key with a unit: the key without its unit, the unit as it is written, and the SI unit.
    pub units: RefCell<Vec<(String, String, &'static str)>>,
}

impl UnitKey<'static> {
    /// A length that is a number in m or a value with a unit.
    pub const LENGTH: UnitKey<'static> =
        UnitKey { si: "limit", short: "limit", unit: "m", values: ValueNotation::Either };
}

impl Names {
    /// Returns the SI name of a key and, if it has a unit, how its values are written.
    pub fn find<'a>(&'a self, keys: Keys, written: &'a str) -> (&'a str, Option<UnitKey<'a>>) {
        let (fields, names): (&[&str], &[String]) = match keys {
            Keys::Of(fields) => (fields, &[]),
            Keys::Variables if self.choices.iter().any(|name| name == written) => (&[], &[]),
            Keys::Parameters | Keys::Variables => (&[], &self.parameters),
            Keys::Coordinates => (&[], &self.coordinates),
            Keys::ParametersOfEach => (&[], &[]),
        };
        let known = || fields.iter().copied().chain(names.iter().map(String::as_str));
        if written == MATERIAL && known().any(|si| si == DENSITY) {
            let key = UnitKey {
                si: DENSITY,
                short: MATERIAL,
                unit: "kg/m3",
                values: ValueNotation::WithUnits,
            };
            return (DENSITY, Some(key));
        }
        let unit_key = |si: &'a str| {
            let (short, unit) = split_unit(si)?;
            let values =
                if si == written { ValueNotation::Numbers } else { ValueNotation::WithUnits };
            (si == written || short == written).then_some(UnitKey { si, short, unit, values })
        };
        // A friction law has the same speed in the unit of each kind of model.
        let of_model = |key: &UnitKey<'_>| self.parameters.iter().any(|name| name == key.si);
        let key = match known().find(|si| *si == written) {
            Some(si) => unit_key(si),
            None => {
                known().filter_map(unit_key).find(of_model).or_else(|| known().find_map(unit_key))
            }
        };
        (key.map_or(written, |key| key.si), key)
    }

    /// Checks that no parameter of a map is given twice, with and without a unit.
    ///
    /// # Errors
    /// Returns the key at fault and the fault.
    pub fn check_once<'n>(
        &self,
        keys: Keys,
        entries: &'n [(YamlNode, YamlNode)],
    ) -> Result<(), (&'n YamlNode, Fault)> {
        let mut read: Vec<(&str, &YamlNode)> = Vec::new();
        for (key, _) in entries {
            let (si, known) = self.find(keys, key.name());
            if !known.is_some_and(|known| known.values == ValueNotation::WithUnits) {
                continue;
            }
            let is_si = |other: &&(YamlNode, YamlNode)| other.0.name() == si;
            let with_unit = entries.iter().find(is_si).map(|(other, _)| other);
            let before = read.iter().find(|(other, _)| *other == si).map(|(_, other)| *other);
            if let Some(other) = before.or(with_unit) {
                let problem = match before {
                    Some(_) => "given twice",
                    None => "given twice, with and without a unit in the key",
                };
                let [first, second] =
                    [key, other].map(|key| format!("`{}` in line {}", key.name(), key.place.line));
                let fault =
                    Fault::new(problem, format!("{first} and {second}"), "one of the two keys");
                return Err((key, fault));
            }
            read.push((si, key));
        }
        Ok(())
    }

    /// Returns the number of a value with a unit below a key; `None` for a value that is read as it is.
    ///
    /// # Errors
    /// Returns a fault if the value has no unit, although the key has none, if it has the unit of another quantity, or if
    /// both the key and the value have one.
    pub fn number(&self, node: &YamlNode, key: &UnitKey<'_>) -> Result<Option<f64>, Fault> {
        let UnitKey { si, short, unit, values } = *key;
        let of_unit = || format!("a number in {unit}, or `{short}` with {}", measured(unit));
        match (&node.content, values) {
            (Content::Text(name), ValueNotation::WithUnits) if short == MATERIAL => {
                density(name).map(Some)
            }
            (Content::Text(text), ValueNotation::WithUnits) => {
                self.note_unit(text, key);
                convert(text, unit).map(Some).map_err(|fault| with_si_key(fault, key))
            }
            (Content::Text(text), ValueNotation::Either) => convert(text, unit).map(Some),
            (Content::Nothing, ValueNotation::WithUnits) => {
                Err(Fault::new("a value is missing", node.describe(), measured(unit)))
            }
            (Content::Nothing, ValueNotation::Numbers) => {
                Err(Fault::new("a value is missing", node.describe(), of_unit()))
            }
            (Content::Natural(_) | Content::Number(_), ValueNotation::WithUnits)
                if short == MATERIAL =>
            {
                let allowed = format!("a material, or `{si}` for a density");
                Err(Fault::new("not a material", node.describe(), allowed))
            }
            (Content::Natural(_) | Content::Number(_), ValueNotation::WithUnits) => {
                Err(with_si_key(Fault::new(WITHOUT, node.describe(), ""), key))
            }
            (Content::Text(text), ValueNotation::Numbers) => {
                if let Some(fault) = decimal_comma(text) {
                    return Err(fault);
                }
                if split_number(text).is_none_or(|(_, unit)| unit.is_empty()) {
                    return Ok(None);
                }
                let allowed = format!("a number in {unit}, or `{short}` for values with units");
                Err(Fault::new("a value with a unit", node.describe(), allowed))
            }
            _ => Ok(None),
        }
    }

    /// Notes the unit of a parameter, or of a speed of rotation.
    fn note_unit(&self, text: &str, key: &UnitKey<'_>) {
        let short = match key.unit {
            _ if self.parameters.iter().any(|name| name == key.si) => key.short,
            "rad/s" => "speed",
            _ => return,
        };
        let Some((_, unit)) = split_number(text).filter(|(_, unit)| !unit.is_empty()) else {
            return;
        };
        let mut units = self.units.borrow_mut();
        if units.iter().all(|(other, ..)| other != short) {
            units.push((short.to_owned(), unit.to_owned(), key.unit));
        }
    }
}

/// The problem of a number without a unit.
const WITHOUT: &str = "a number without a unit";

/// Returns the fault with the SI key as what is allowed for a number without a unit.
fn with_si_key(fault: Fault, UnitKey { si, unit, .. }: &UnitKey<'_>) -> Fault {
    if fault.problem != WITHOUT {
        return fault;
    }
    let allowed = format!("`{si}` for a number in {unit}, or {}", measured(unit));
    Fault { allowed: Some(allowed), ..fault }
}

/// Returns the density of a material.
fn density(name: &str) -> Result<f64, Fault> {
    let material = Material::named(name).ok_or_else(|| {
        let names: Vec<&str> = MATERIALS.iter().map(|material| material.name).collect();
        Fault::new("unknown material", shorten(name), list_names(name, &names))
    })?;
    Ok(material.density_kg_m3)
}
