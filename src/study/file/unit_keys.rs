//! Keys without a unit, such as `speed: 6000 rpm` beside `speed_rad_s: 628.3`: each becomes the SI key before the file is
//! decoded, so that the rest of the program knows SI keys only.

use crate::model::{MATERIALS, Material};
use crate::study::error::{Fault, Location, StudyError, list_names, shorten};
use crate::study::file::key_path::{KeyPath, Segment};
use crate::study::file::quantity::{convert, decimal_comma, measured, split_number};
use crate::study::file::schema_parts::{axes_of, parameters_of};
use crate::study::file::yaml_tree::{Content, Node, Source};

/// The endings of SI keys with their units; a longer ending stands before the shorter one that it contains.
const ENDINGS: [(&str, &str); 10] = [
    ("_n_s_m", "N s/m"),
    ("_rad_s", "rad/s"),
    ("_n_m", "N/m"),
    ("_m_s", "m/s"),
    ("_kg_m3", "kg/m3"),
    ("_kg_m", "kg m"),
    ("_kg", "kg"),
    ("_m", "m"),
    ("_n", "N"),
    ("_s", "s"),
];

/// The names of the model's coordinates.
const COORDINATES: &[&str] = &["*"];

/// The places of keys with units, where `*` is any key or item, with the SI keys; none means the model's parameters, and [`COORDINATES`] its coordinates.
const PLACES: [(&str, &[&str]); 21] = [
    ("model.parameters", &[]),
    ("model.parameters.balls.*", &["mass_kg", "diameter_m"]),
    ("model.friction.*", &[]),
    ("model.speed_profile.*", &["hold_s"]),
    ("model.speed_profile.*.ramp", &["from_rad_s", "to_rad_s", "over_s"]),
    ("model.speed_profile.*.smooth_ramp", &["from_rad_s", "to_rad_s", "over_s"]),
    ("model.disturbances.*.kick", &["at_s", "speed_m_s"]),
    ("model.protocol.startup", &["from_rad_s", "over_s"]),
    ("model.protocol.startup_and_hammer", &["from_rad_s", "over_s", "wait_s", "speed_m_s"]),
    ("sweep.*.grid", &[]),
    ("sweep.*.zip", &[]),
    ("uncertain", &[]),
    ("initial_conditions.box", COORDINATES),
    ("simulation", &["end_time_s"]),
    ("precision", &["amplitude_p05_m", "amplitude_p50_m", "amplitude_p95_m"]),
    ("expect.*.point", &[]),
    ("responses.*", &["at_rest_by_s"]),
    ("design", &[]),
    ("design.*.choices.*", &[]),
    ("optimize.compare_with", &[]),
    ("identify.parameters", &[]),
];

/// The places of keys for a number in SI units or a value with a unit, with the key and the unit. Such a key has no SI
/// form, because its number has no unit where `relative` is true.
const NUMBERS_OR_UNITS: [(&str, &str, &str); 1] = [("responses.*.amplitude_above", "limit", "m")];

/// The key that takes names of materials in place of densities.
pub(super) const MATERIAL: &str = "ball_material";
/// The parameter that a material gives.
pub(super) const DENSITY: &str = "ball_density_kg_m3";

/// Keys below a parameter whose values do not have its unit.
pub(crate) const WITHOUT_UNIT: [&str; 4] = ["count", "spacing", "times", "weights"];

/// Returns the key without its unit and the unit, if this is an SI key with a unit.
pub(crate) fn split_unit(key: &str) -> Option<(&str, &'static str)> {
    ENDINGS.iter().find_map(|(ending, unit)| Some((key.strip_suffix(ending)?, *unit)))
}

/// Replaces each key without a unit, and the values below it, by the SI key and numbers.
///
/// # Errors
/// Returns an error if a parameter is given both with and without a unit, if a value has no unit or one of another
/// quantity, or if an SI key has a value with a unit.
pub(in crate::study) fn read_units(source: &mut Source) -> Result<(), StudyError> {
    let kind = source.root.get("model").and_then(|model| model.get("kind"));
    let mut reading = Reading {
        parameters: parameters_of(kind.map_or("", Node::name)),
        coordinates: coordinates_of(kind.map_or("", Node::name)),
        choices: names_of_choices(&source.root),
        renamed: Vec::new(),
        units: Vec::new(),
        restitution: None,
        path: KeyPath::default(),
    };
    let nothing = Node { place: source.root.place, content: Content::Nothing };
    let mut root = std::mem::replace(&mut source.root, nothing);
    let result =
        PLACES.iter().try_for_each(|place| reading.place(&mut root, place)).and_then(|()| {
            let mut each = NUMBERS_OR_UNITS.iter();
            each.try_for_each(|(place, key, unit)| {
                reading.number_or_unit(&mut root, place, key, unit)
            })
        });
    if let Some(restitution) = reading.restitution {
        add_restitution(&mut root, restitution);
    }
    source.root = root;
    source.renamed = reading.renamed;
    source.units = reading.units;
    result.map_err(|Wrong { place, fault }| source.refuse_at(place, &reading.path, fault))
}

/// Gives the contact of balls the restitution of their material, unless it has its own.
fn add_restitution(root: &mut Node, restitution: f64) {
    let Content::Map(entries) = &mut root.content else { return };
    let model = entries.iter_mut().find(|(key, _)| key.name() == "model");
    let Some(Content::Map(entries)) = model.map(|(_, model)| &mut model.content) else { return };
    let contact = entries.iter_mut().find(|(key, _)| key.name() == "contact");
    let Some((_, Node { place, content: Content::Map(law) })) = contact else { return };
    let own = ["restitution", "material_restitution"];
    if law.iter().all(|(key, _)| !own.contains(&key.name())) {
        let node = |content| Node { place: *place, content };
        let key = node(Content::Text("material_restitution".to_owned()));
        law.push((key, node(Content::Number(restitution))));
    }
}

/// Returns the names of the coordinates of this kind of model that end with a unit, and those of a block.
fn coordinates_of(kind: &str) -> Vec<String> {
    let mut names = ["position_m", "velocity_m_s"].map(str::to_owned).to_vec();
    names.extend(axes_of(kind).into_iter().filter(|name| split_unit(name).is_some()));
    names.sort_unstable();
    names.dedup();
    names
}

/// Returns the variables with choices. A variable with choices may have the name of a parameter without its unit.
fn names_of_choices(root: &Node) -> Vec<String> {
    let Some(Content::Map(variables)) = root.get("design").map(|design| &design.content) else {
        return Vec::new();
    };
    let choices = variables.iter().filter(|(_, value)| value.get("choices").is_some());
    choices.map(|(key, _)| key.name().to_owned()).collect()
}

/// A fault and its place; the path is that of the reading.
struct Wrong {
    place: Location,
    fault: Fault,
}

struct Reading {
    /// The names of the model's parameters.
    parameters: Vec<String>,
    /// The names of the model's coordinates with a unit.
    coordinates: Vec<String>,
    /// The names of the design's variables with choices.
    choices: Vec<String>,
    /// The places of renamed keys, with their names in the file.
    renamed: Vec<(Location, String)>,
    /// The first unit of each parameter, as in [`Source::units`].
    units: Vec<(String, String, &'static str)>,
    /// The coefficient of restitution of the balls' material.
    restitution: Option<f64>,
    /// Where the reading is.
    path: KeyPath,
}

/// A key with a unit: its name in SI units, its name without the unit, and the SI unit.
struct UnitKey<'a> {
    si: &'a str,
    short: &'a str,
    unit: &'static str,
}

impl Reading {
    fn place(&mut self, root: &mut Node, place: &(&str, &[&str])) -> Result<(), Wrong> {
        let (place, own) = place;
        let names: Vec<String> = match *own {
            [] => self.parameters.clone(),
            COORDINATES => self.coordinates.clone(),
            own => own.iter().map(|&key| key.to_owned()).collect(),
        };
        let steps: Vec<&str> = place.split('.').collect();
        self.visit(root, &steps, &mut |reading, node| reading.keys(node, &names))
    }

    fn number_or_unit(
        &mut self,
        root: &mut Node,
        place: &str,
        key: &str,
        unit: &str,
    ) -> Result<(), Wrong> {
        let steps: Vec<&str> = place.split('.').collect();
        self.visit(root, &steps, &mut |reading, node| {
            let relative = node.get("relative").map(|node| &node.content);
            let relative = matches!(relative, Some(Content::Truth(true)));
            let Content::Map(entries) = &mut node.content else { return Ok(()) };
            let Some((_, value)) = entries.iter_mut().find(|(other, _)| other.name() == key) else {
                return Ok(());
            };
            let Content::Text(text) = &value.content else { return Ok(()) };
            reading.path.0.push(Segment::Key(key.to_owned()));
            let number = match relative {
                true => Err(Fault::new(
                    "a value with a unit, although `relative` is true",
                    value.describe(),
                    "a number, the amplitude over that without balls; or `relative: false`",
                )),
                false => convert(text, unit),
            };
            value.content =
                Content::Number(number.map_err(|fault| Wrong { place: value.place, fault })?);
            reading.path.0.pop();
            Ok(())
        })
    }

    /// Calls a function for each node at a place.
    fn visit(
        &mut self,
        node: &mut Node,
        steps: &[&str],
        at: &mut dyn FnMut(&mut Reading, &mut Node) -> Result<(), Wrong>,
    ) -> Result<(), Wrong> {
        let Some((step, rest)) = steps.split_first() else {
            return at(self, node);
        };
        match &mut node.content {
            Content::Map(entries) => {
                for (key, value) in entries {
                    if *step == "*" || key.name() == *step {
                        self.path.0.push(Segment::Key(key.name().to_owned()));
                        self.visit(value, rest, at)?;
                        self.path.0.pop();
                    }
                }
            }
            Content::List(items) if *step == "*" => {
                for (index, item) in items.iter_mut().enumerate() {
                    self.path.0.push(Segment::Item(index));
                    self.visit(item, rest, at)?;
                    self.path.0.pop();
                }
            }
            _ => {}
        }
        Ok(())
    }

    /// Reads the keys of one map.
    fn keys(&mut self, node: &mut Node, names: &[String]) -> Result<(), Wrong> {
        // Only variables are called by other names than those of parameters.
        let of_design = ["design", "compare_with"]
            .iter()
            .any(|name| self.path.0.last() == Some(&Segment::Key((*name).to_owned())));
        let Content::Map(entries) = &mut node.content else { return Ok(()) };
        let places: Vec<(String, usize)> =
            entries.iter().map(|(key, _)| (key.name().to_owned(), key.place.line)).collect();
        let mut read: Vec<(String, String, usize)> = Vec::new();
        for entry in entries {
            let (key, value) = entry;
            let written = key.name().to_owned();
            if of_design && self.choices.contains(&written) {
                continue;
            }
            let known = names.iter().find_map(|si| {
                let (short, unit) = split_unit(si)?;
                (si == &written || short == written).then_some(UnitKey { si, short, unit })
            });
            let takes_materials = written == MATERIAL && names.iter().any(|si| si == DENSITY);
            let material = UnitKey { si: DENSITY, short: MATERIAL, unit: "kg/m3" };
            let Some(known) = known.or(takes_materials.then_some(material)) else { continue };
            if let Some((_, other, line)) = read.iter().find(|(si, ..)| si == known.si) {
                let found =
                    format!("`{written}` in line {} and `{other}` in line {line}", key.place.line);
                let fault = Fault::new("given twice", found, "one of the two keys");
                self.path.0.push(Segment::Key(written));
                return Err(Wrong { place: key.place, fault });
            }
            if written != known.si {
                read.push((known.si.to_owned(), written.clone(), key.place.line));
            }
            self.path.0.push(Segment::Key(written.clone()));
            if written == known.si {
                self.check_numbers(value, &known)?;
            } else {
                if let Some((si, line)) = places.iter().find(|(name, _)| name == known.si) {
                    let problem = "given twice, with and without a unit in the key";
                    let found =
                        format!("`{written}` in line {} and `{si}` in line {line}", key.place.line);
                    let fault = Fault::new(problem, found, "one of the two keys");
                    return Err(Wrong { place: key.place, fault });
                }
                self.convert(value, &known)?;
                self.renamed.push((key.place, written));
                key.content = Content::Text(known.si.to_owned());
            }
            self.path.0.pop();
        }
        Ok(())
    }

    /// Replaces the values with units below a key by numbers in SI units.
    fn convert(&mut self, node: &mut Node, key: &UnitKey<'_>) -> Result<(), Wrong> {
        let number = match &node.content {
            Content::Text(text) if key.short == MATERIAL => Some(self.density(text)),
            Content::Natural(_) | Content::Number(_) if key.short == MATERIAL => {
                let allowed = format!("a material, or `{DENSITY}` for a density");
                Some(Err(Fault::new("not a material", node.describe(), allowed)))
            }
            Content::Text(text) => {
                self.note_unit(text, key);
                Some(convert(text, key.unit))
            }
            Content::Nothing => {
                let allowed = measured(key.unit);
                Some(Err(Fault::new("a value is missing", node.describe(), allowed)))
            }
            Content::Natural(_) | Content::Number(_) => {
                let problem = "a number without a unit";
                Some(Err(Fault::new(problem, node.describe(), String::new())))
            }
            _ => None,
        };
        match number {
            None => self.below(node, &mut |reading, node| reading.convert(node, key)),
            Some(Ok(number)) => {
                node.content = Content::Number(number);
                Ok(())
            }
            Some(Err(mut fault)) => {
                if fault.problem == "a number without a unit" {
                    let UnitKey { si, unit, .. } = key;
                    let measured = measured(unit);
                    fault.allowed = Some(format!("`{si}` for a number in {unit}, or {measured}"));
                }
                Err(Wrong { place: node.place, fault })
            }
        }
    }

    /// Returns the density of a material.
    fn density(&mut self, name: &str) -> Result<f64, Fault> {
        let material = Material::named(name).ok_or_else(|| {
            let names: Vec<&str> = MATERIALS.iter().map(|material| material.name).collect();
            Fault::new("unknown material", shorten(name), list_names(name, &names))
        })?;
        if self.path.to_string() == format!("model.parameters.{MATERIAL}") {
            self.restitution = material.restitution;
        }
        Ok(material.density_kg_m3)
    }

    /// Notes the unit of a parameter, or of a speed of rotation.
    fn note_unit(&mut self, text: &str, key: &UnitKey<'_>) {
        let short = match key.unit {
            _ if self.parameters.iter().any(|name| name == key.si) => key.short,
            "rad/s" => "speed",
            _ => return,
        };
        let Some((_, unit)) = split_number(text).filter(|(_, unit)| !unit.is_empty()) else {
            return;
        };
        if self.units.iter().all(|(other, ..)| other != short) {
            self.units.push((short.to_owned(), unit.to_owned(), key.unit));
        }
    }

    /// Checks that no value below an SI key has a unit.
    fn check_numbers(&mut self, node: &mut Node, key: &UnitKey<'_>) -> Result<(), Wrong> {
        if let Content::Nothing = &node.content {
            let UnitKey { short, unit, .. } = key;
            let allowed = format!("a number in {unit}, or `{short}` with {}", measured(unit));
            let fault = Fault::new("a value is missing", node.describe(), allowed);
            return Err(Wrong { place: node.place, fault });
        }
        if let Content::Text(text) = &node.content {
            if let Some(fault) = decimal_comma(text) {
                return Err(Wrong { place: node.place, fault });
            }
            return match split_number(text) {
                Some((_, unit)) if !unit.is_empty() => {
                    let UnitKey { short, unit, .. } = key;
                    let allowed = format!("a number in {unit}, or `{short}` for values with units");
                    let fault = Fault::new("a value with a unit", node.describe(), allowed);
                    Err(Wrong { place: node.place, fault })
                }
                _ => Ok(()),
            };
        }
        self.below(node, &mut |reading, node| reading.check_numbers(node, key))
    }

    /// Visits the items of a list, or the values of a map that have the unit of the parameter.
    fn below(
        &mut self,
        node: &mut Node,
        visit: &mut dyn FnMut(&mut Reading, &mut Node) -> Result<(), Wrong>,
    ) -> Result<(), Wrong> {
        let nodes: Vec<(Segment, &mut Node)> = match &mut node.content {
            Content::List(items) => {
                let items = items.iter_mut().enumerate();
                items.map(|(index, item)| (Segment::Item(index), item)).collect()
            }
            Content::Map(entries) => {
                let entries =
                    entries.iter_mut().filter(|(key, _)| !WITHOUT_UNIT.contains(&key.name()));
                entries.map(|(key, value)| (Segment::Key(key.name().to_owned()), value)).collect()
            }
            _ => Vec::new(),
        };
        for (step, node) in nodes {
            self.path.0.push(step);
            visit(self, node)?;
            self.path.0.pop();
        }
        Ok(())
    }
}
