//! Reads a system file, or the keys of one in a study, and makes it a kind of model.

use std::path::Path;
use std::rc::Rc;

use serde_json::Value;

use crate::model::{
    FaultAt, Formula, FormulaFault, IndexedName, ModelKind, SystemDefinition, WHOLE,
    WrittenDerived, WrittenOutput, WrittenParameter, WrittenTurning, WrittenUnit, written_kind,
};
use crate::study::error::{Fault, StudyError, list_names, shorten};
use crate::study::file::decode::decode;
use crate::study::file::key_path::{KeyPath, Segment};
use crate::study::file::key_units::split_unit;
use crate::study::file::quantity::{convert, split_number, unit_of};
use crate::study::file::source::{Source, SourcePath};
use crate::study::file::system_file::{
    DerivedEntry, DerivedKeys, Ends, FormulaText, OutputKeys, SystemFile,
};
use crate::study::file::table_folders::TableFolders;
use crate::study::file::unit_keys::Names;
use crate::study::file::yaml_tree::{Content, YamlNode};
use crate::study::resolve::names::is_key;
use crate::tabular::to_text;

/// Replaces the key `system` of a model by the key `kind` with the kind that the system defines.
pub(in crate::study) fn read_system(source: &mut Source) -> Result<(), StudyError> {
    let path = source.path("model.system");
    let Some(node) = path.node() else { return Ok(()) };
    let beside = |key: &str, allowed: &str| {
        let other = source.path("model").key(key);
        let refuse = |_| Err(other.refuse_key(Fault::new("not beside `system`", key, allowed)));
        other.node().map_or(Ok(()), refuse)
    };
    beside("kind", "`kind` or `system`")?;
    let place = node.place;
    let definition = match &node.content {
        Content::Text(name) => {
            let refuse = |fault: Fault| {
                let plain = |text: String| text.replace("table", "system file");
                let allowed = fault.allowed.map(|text| text.replace("the system file", "it"));
                path.refuse_value(Fault { problem: plain(fault.problem), allowed, ..fault })
            };
            let (file, bytes) = source.folders.read(name).map_err(refuse)?;
            let text = to_text(bytes).map_err(|fault| StudyError::about_file(&file, fault))?;
            let inner = Source::new(&file, text, Rc::clone(&source.folders));
            let beside = Path::new(name).parent().unwrap_or(Path::new(""));
            definition(&inner.map_err(|error| with_hint(error, true))?, beside)?
        }
        Content::Map(_) => {
            let inner = Source {
                file: source.file.clone(),
                text: source.text.clone(),
                root: node.clone(),
                units: Vec::new(),
                folders: Rc::clone(&source.folders),
            };
            definition(&inner, Path::new(""))?
        }
        _ => {
            let allowed = "the name of a system file, or the keys of one";
            return Err(path.refuse_value(Fault::new("not a system", node.describe(), allowed)));
        }
    };
    if !definition.has_law_of_study() {
        let allowed = "`friction` of each contact of the system, or `friction: study` there";
        beside("friction", allowed)?;
    }
    let (_, name) = written_kind(definition, false);
    let model = [Segment::Key("model".to_owned())];
    if let Some(YamlNode { content: Content::Map(entries), .. }) = source.root.at_mut(&model) {
        for (key, value) in entries.iter_mut().filter(|(key, _)| key.name() == "system") {
            key.content = Content::Text("kind".to_owned());
            *value = YamlNode { place, content: Content::Text(name.clone()) };
        }
    }
    Ok(())
}

/// Reads a system file that is part of this program.
///
/// # Panics
/// Panics if the file has a fault, which a test of all kinds of models finds.
pub(in crate::study) fn built_in_system(file: &str, text: &str) -> &'static ModelKind {
    let definition = of_text(Path::new(file), text);
    let definition = definition.unwrap_or_else(|error| panic!("{error}"));
    written_kind(definition, true).0
}

/// Returns the equations of a system file in LaTeX; `None` if it has a fault. Tables are relative to the folder `beside`.
pub fn system_in_latex(text: &str, beside: &Path) -> Option<String> {
    of_text(&beside.join("system"), text).ok()?.latex()
}

/// Reads and checks a system file.
fn of_text(file: &Path, text: &str) -> Result<SystemDefinition, StudyError> {
    let folders = Rc::new(TableFolders::new(file, &[])?);
    definition(&Source::new(file, text.to_owned(), folders)?, Path::new(""))
}

/// Reads and checks the keys of a system. Tables are relative to the folder `beside`.
fn definition(source: &Source, beside: &Path) -> Result<SystemDefinition, StudyError> {
    let file: SystemFile = decode(source, &Names::default(), None).map_err(|error| {
        let is_cut = error.found().is_some_and(|found| found.contains([')', ']', '}']));
        with_hint(error, is_cut)
    })?;
    let reader = Reader { source, beside };
    let mut definition = reader.definition(&file)?;
    definition.check().map_err(|fault| reader.refuse(fault))?;
    Ok(definition)
}

/// Adds a remedy to the message for a formula that YAML may have cut.
fn with_hint(error: StudyError, is_cut: bool) -> StudyError {
    if error.allowed().is_some_and(|allowed| allowed.contains("`schema: 1`")) {
        let (problem, found) = (error.problem().replace("study", "system"), error.found());
        let allowed = "keys and values, starting with `system: NAME`";
        let fault = Fault::new(problem, found.unwrap_or_default(), allowed);
        return error.clone().with_fault(fault);
    }
    if !is_cut {
        return error;
    }
    let hint = "inside {...}, a formula with a comma, [ or { needs quotation marks";
    let allowed =
        error.allowed().unwrap_or_default().replace("a study in YAML", "a system in YAML");
    let (problem, found) =
        (error.problem().to_owned(), error.found().unwrap_or_default().to_owned());
    error.with_fault(Fault::new(problem, found, format!("{allowed}; {hint}")))
}

/// Reads the parts of a system.
pub(super) struct Reader<'s> {
    source: &'s Source,
    /// The folder of the system file, relative to the study.
    pub(super) beside: &'s Path,
}

impl<'s> Reader<'s> {
    fn definition(&self, file: &SystemFile) -> Result<SystemDefinition, StudyError> {
        if !is_key(&file.system) {
            let allowed = "lower-case letters, digits and _, with a letter first";
            let fault = Fault::new("not a name of a system", shorten(&file.system), allowed);
            return Err(self.path(&["system"]).refuse_value(fault));
        }
        let mut parameters = Vec::new();
        for (name, entry) in &file.parameters {
            parameters.push(self.parameter(name, &entry.0)?);
        }
        for (index, count) in &file.repeat {
            if !parameters.iter().any(|known| known.name == *count && known.counts.is_some()) {
                let counts = parameters.iter().filter(|known| known.counts.is_some());
                let counts: Vec<&str> = counts.map(|known| known.name.as_str()).collect();
                let allowed = match counts[..] {
                    [] => {
                        "a parameter with the key `most`: blocks: {value: 3, most: 10}".to_owned()
                    }
                    _ => list_names(count, &counts),
                };
                let fault = Fault::new("not a number of bodies", shorten(count), allowed);
                return Err(self.path(&["repeat", index]).refuse_value(fault));
            }
        }
        let mut coordinates = Vec::new();
        for (key, entry) in &file.coordinates {
            coordinates.push(self.coordinate(key, entry, file)?);
        }
        let mut mass = Vec::new();
        for (row, columns) in &file.mass {
            let row_place = self.place(&["mass", row], row)?;
            for (column, text) in columns {
                let column_place = self.place(&["mass", row, column], column)?;
                let entry = self.formula(&["mass", row, column], text)?;
                mass.push(([row_place.clone(), column_place], entry));
            }
        }
        let mut force = Vec::new();
        for (key, text) in &file.force {
            force.push((self.place(&["force", key], key)?, self.formula(&["force", key], text)?));
        }
        let mut contacts = Vec::new();
        for (key, entry) in &file.contacts {
            contacts.push(self.contact(key, entry, file)?);
        }
        if coordinates.is_empty() {
            let fault = Fault::new("an empty list", "no keys", "at least one");
            return Err(self.path(&["coordinates"]).refuse_value(fault));
        }
        let quantity = |list: &str, key: &String, entry: &OutputKeys| {
            let path = self.path(&[list, key]);
            let (name, index) = self.indexed(&path, key, file)?;
            let value = path.key("value");
            let value = if value.node().is_some() { value } else { path.clone() };
            let formula = self.formula_at(&value, &entry.value)?;
            let unit = entry.unit.as_deref().map(|unit| self.si_unit(&path, unit, ""));
            let (unit, meaning) = (unit.transpose()?, entry.meaning.clone());
            Ok(WrittenOutput { name, index, unit, meaning, formula })
        };
        let outputs = file.outputs.iter().map(|(key, entry)| quantity("outputs", key, &entry.0));
        let outputs = outputs.collect::<Result<Vec<_>, StudyError>>()?;
        let mut derived = Vec::new();
        for (key, DerivedEntry(keys)) in &file.derived {
            let path = self.path(&["derived", key]);
            let DerivedKeys { value, unit, meaning, within, usual } = keys.clone();
            let quantity = quantity("derived", key, &OutputKeys { value, unit, meaning })?;
            if quantity.index.is_some() {
                let allowed = "a name without an index: parameters are the same for all bodies";
                return Err(path.refuse_key(Fault::new("a quantity of a body", key, allowed)));
            }
            let range = |key: &str, ends: Option<Ends>| {
                ends.map(|ends| self.range(&path.key(key), &ends)).transpose()
            };
            let (within, usual) = (range("within", within)?, range("usual", usual)?);
            derived.push(WrittenDerived { quantity, within, usual });
        }
        let mut keys = plain(&self.source.root);
        let motions = self.motions(file, &mut keys)?;
        let draw = file.draw.iter().map(|(name, entry)| self.view(name, entry, file));
        let draw = draw.collect::<Result<Vec<_>, StudyError>>()?;
        let turning = file.turning.iter().next();
        let units = parameters
            .iter()
            .map(|parameter| &parameter.unit)
            .chain(coordinates.iter().map(|coordinate| &coordinate.unit));
        let speed_unit = if units.into_iter().any(|unit| unit.si != "1") { "rad/s" } else { "1" };
        if let Some((angle, speed)) = turning {
            let is_speed = |known: &WrittenParameter| {
                known.name == *speed && known.counts.is_none() && known.unit.si == speed_unit
            };
            if file.turning.len() > 1 {
                let allowed = "one part that turns; other speeds are multiples of its speed";
                let fault =
                    Fault::new("several parts that turn", file.turning.len().to_string(), allowed);
                return Err(self.path(&["turning"]).refuse_value(fault));
            }
            if !parameters.iter().any(is_speed) {
                let allowed = "a parameter that is a speed, such as 3000 rpm";
                let fault = Fault::new("not a speed of this system", shorten(speed), allowed);
                return Err(self.path(&["turning", angle]).refuse_value(fault));
            }
        }
        let period = file.period.as_ref().map(|text| self.formula(&["period"], text));
        Ok(SystemDefinition {
            name: file.system.clone(),
            meaning: file.meaning.clone(),
            parameters,
            repeat: file.repeat.iter().map(|(index, of)| (index.clone(), of.clone())).collect(),
            coordinates,
            mass,
            force,
            contacts,
            outputs,
            derived,
            motions,
            draw,
            turning: turning.map(|(angle, speed)| WrittenTurning {
                angle: angle.clone(),
                speed: speed.clone(),
            }),
            period: period.transpose()?,
            uses_time: false,
            uses_accelerations: false,
            source: keys,
        })
    }

    /// Returns the unit under the key `unit`, which must be an SI unit.
    pub(super) fn si_unit(
        &self,
        path: &SourcePath<'_>,
        written: &str,
        remedy: &str,
    ) -> Result<WrittenUnit, StudyError> {
        let refuse = |fault| path.key("unit").refuse_value(fault);
        let unit = self.unit(written).map_err(refuse)?;
        if convert(&format!("1 {written}"), &unit.si).is_ok_and(|factor| factor != 1.0) {
            let allowed = format!("{}{remedy}", unit.si);
            return Err(refuse(Fault::new("not an SI unit", shorten(written), allowed)));
        }
        Ok(unit)
    }

    /// Returns the formulas of the two ends of a range.
    pub(super) fn range(
        &self,
        path: &SourcePath<'_>,
        ends: &Ends,
    ) -> Result<[Formula; 2], StudyError> {
        match &ends.0[..] {
            [text] => self.formula_at(path, text).map(|formula| [formula.clone(), formula]),
            [low, high] => {
                let [low, high] = [(0, low), (1, high)]
                    .map(|(place, text)| self.formula_at(&path.item(place), text));
                Ok([low?, high?])
            }
            other => {
                let found = format!("{} values", other.len());
                let allowed = "a value, or two values [low, high]";
                Err(path.refuse_value(Fault::new("not a range", found, allowed)))
            }
        }
    }

    /// Splits a key such as `x[block]` into the name and the index.
    pub(super) fn indexed(
        &self,
        path: &SourcePath<'_>,
        key: &str,
        file: &SystemFile,
    ) -> Result<(String, Option<String>), StudyError> {
        let Some((name, rest)) = key.split_once('[') else { return Ok((key.to_owned(), None)) };
        let index = rest.strip_suffix(']').unwrap_or(rest);
        if file.repeat.contains_key(index) {
            return Ok((name.to_owned(), Some(index.to_owned())));
        }
        let indices: Vec<&str> = file.repeat.keys().map(String::as_str).collect();
        let allowed = match indices[..] {
            [] => {
                "a name without [...], or a key `repeat: {block: blocks}` with an index".to_owned()
            }
            _ => format!("an index of `repeat`: {}", list_names(index, &indices)),
        };
        Err(path.refuse_key(Fault::new("unknown index", shorten(index), allowed)))
    }

    pub(super) fn unit(&self, text: &str) -> Result<WrittenUnit, Fault> {
        let (si, [length, mass, time, _]) = unit_of(text)?;
        Ok(WrittenUnit { si, dimension: [mass, length, time].map(|exponent| exponent * WHOLE) })
    }

    /// Names in tables end with their units, so that a name without a unit must not look like one with a unit.
    pub(super) fn check_ending(
        &self,
        path: &SourcePath<'_>,
        name: &str,
        unit: &WrittenUnit,
    ) -> Result<(), StudyError> {
        match split_unit(name).filter(|_| unit.si == "1") {
            Some((short, ending)) => {
                let found = format!("{} without a unit", shorten(name));
                let allowed =
                    format!("another ending: tables take it for {} in {ending}", shorten(short));
                Err(path.refuse_key(Fault::new("a name that ends like a unit", found, allowed)))
            }
            None => Ok(()),
        }
    }

    pub(super) fn place(&self, path: &[&str], text: &str) -> Result<IndexedName, StudyError> {
        let parsed = Formula::parse(text);
        parsed.map(IndexedName).map_err(|fault| refuse(&self.path(path), text, fault))
    }

    /// Reads a formula, or a value with a unit.
    pub(super) fn formula(&self, path: &[&str], text: &FormulaText) -> Result<Formula, StudyError> {
        self.formula_at(&self.path(path), text)
    }

    fn formula_at(&self, path: &SourcePath<'_>, text: &FormulaText) -> Result<Formula, StudyError> {
        // `0 * t` is a formula, not a number of tons.
        let is_unit = |unit: &str| !unit.starts_with('*') && unit_of(unit).is_ok();
        match split_number(&text.0).filter(|(_, unit)| is_unit(unit)) {
            Some((_, unit)) => {
                let refuse = |fault| path.refuse_value(fault);
                let unit = self.unit(unit).map_err(refuse)?;
                let value = convert(&text.0, &unit.si).map_err(refuse)?;
                Ok(Formula::quantity(value, unit.dimension))
            }
            None => Formula::parse(&text.0).map_err(|fault| refuse(path, &text.0, fault)),
        }
    }

    pub(super) fn path(&self, keys: &[&str]) -> SourcePath<'s> {
        let mut path = self.source.at(KeyPath::default());
        for key in keys {
            path = match key.strip_prefix('[').and_then(|rest| rest.strip_suffix(']')?.parse().ok())
            {
                Some(item) => path.item(item),
                None => key.split('.').fold(path, |path, key| path.key(key)),
            };
        }
        path
    }

    /// Creates the message for a fault of the whole system.
    fn refuse(&self, (keys, fault): FaultAt) -> StudyError {
        let keys: Vec<&str> = keys.iter().map(String::as_str).collect();
        let path = self.path(&keys);
        let path = if path.key("value").node().is_some() { path.key("value") } else { path };
        let text = path.node().map(|node| match &node.content {
            Content::Text(text) => text.clone(),
            Content::Map(_) => String::new(),
            _ => node.describe(),
        });
        refuse(&path, &text.unwrap_or_default(), fault)
    }
}

/// Creates the message for a fault of a formula.
fn refuse(path: &SourcePath<'_>, text: &str, fault: FormulaFault) -> StudyError {
    let FormulaFault { at, problem, found, allowed, names } = fault;
    let allowed = if names.is_empty() { allowed } else { list_names(&found, &names) };
    let shown = if names.is_empty() { found.clone() } else { format!("`{found}`") };
    let found = match text.is_empty() || found == text {
        true => shorten(&shown),
        false => {
            let character = text.get(..at).map_or(1, |before| before.chars().count() + 1);
            format!("{} at character {character} of {:?}", shorten(&shown), shorten(text))
        }
    };
    path.refuse_value(Fault::new(problem, found, allowed))
}

/// Returns a tree as plain values.
fn plain(node: &YamlNode) -> Value {
    match &node.content {
        Content::Nothing | Content::Placeholder => Value::Null,
        Content::Truth(truth) => (*truth).into(),
        Content::Natural(number) => (*number).into(),
        Content::Number(number) => (*number).into(),
        Content::Text(text) => text.as_str().into(),
        Content::List(items) => items.iter().map(plain).collect(),
        Content::Map(entries) => Value::Object(
            entries.iter().map(|(key, value)| (key.name().to_owned(), plain(value))).collect(),
        ),
    }
}
