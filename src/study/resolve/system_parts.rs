//! Reads the parameters, the coordinates and the contacts of a system file, and the motions that tables give over time.

use indexmap::IndexMap;
use serde_json::{Value, json};

use super::system::Reader;
use crate::model::{
    Bound, COEFFICIENT, FRICTION_LAWS, Formula, GivenMotion, WrittenContact, WrittenCoordinate,
    WrittenFriction, WrittenMotion, WrittenNormal, WrittenParameter, WrittenUnit, law_key,
    unit_ending,
};
use crate::study::error::{Fault, StudyError, list_names, shorten};
use crate::study::file::quantity::{convert, split_number};
use crate::study::file::source::SourcePath;
use crate::study::file::system_file::{
    BoundFile, ContactEntry, CoordinateEntry, Ends, FormulaText, FrictionEntry, MotionEntry,
    ParameterKeys, SystemFile,
};
use crate::study::file::table_input::values_over_time;
use crate::study::file::values::TableKey;

/// The largest number of bodies that an index counts.
const MOST_BODIES: u64 = 64;
/// The largest number of rows of all motions over time: each begins a stage of a run.
const MOST_ROWS: usize = 10_000;

impl Reader<'_> {
    /// Reads a parameter.
    pub(super) fn parameter(
        &self,
        name: &str,
        entry: &ParameterKeys,
    ) -> Result<WrittenParameter, StudyError> {
        let path = self.path(&["parameters", name]);
        let value =
            if path.key("value").node().is_some() { path.key("value") } else { path.clone() };
        let text = entry.value.0.as_str();
        let fault = |fault: Fault| value.refuse_value(fault);
        let (number, unit) = match split_number(text) {
            Some((number, "")) => (number.parse().unwrap_or(f64::NAN), "1"),
            Some((_, unit)) => (f64::NAN, unit),
            None => {
                let allowed = "a number, or a value with a unit such as 0.3 kg";
                return Err(fault(Fault::new("not a value", shorten(text), allowed)));
            }
        };
        let unit = self.unit(unit).map_err(fault)?;
        let number = if number.is_nan() { convert(text, &unit.si).map_err(fault)? } else { number };
        if !number.is_finite() {
            return Err(fault(Fault::new("not a finite number", shorten(text), "a finite number")));
        }
        self.check_ending(&path, name, &unit)?;
        if let Some(most) = entry.most {
            let least = entry.least.unwrap_or(0) as f64;
            let is_count = number.fract() == 0.0 && (least..=most as f64).contains(&number);
            if !is_count || most > MOST_BODIES || unit.si != "1" {
                let allowed = format!(
                    "a whole number from `least` to `most`, which is at most {MOST_BODIES}"
                );
                let found = format!("{} with most: {most}", shorten(text));
                return Err(fault(Fault::new("not a number of bodies", found, allowed)));
            }
        }
        Ok(WrittenParameter {
            name: name.to_owned(),
            unit,
            value: number,
            meaning: entry.meaning.clone(),
            bound: match entry.bound {
                None => Bound::None,
                Some(BoundFile::Positive) => Bound::Positive,
                Some(BoundFile::NotNegative) => Bound::NotNegative,
            },
            counts: entry.most.map(|most| {
                let least = entry.least.map_or((number as usize).min(1), |least| least as usize);
                [least, most as usize]
            }),
        })
    }

    /// Reads a coordinate.
    pub(super) fn coordinate(
        &self,
        key: &str,
        entry: &CoordinateEntry,
        file: &SystemFile,
    ) -> Result<WrittenCoordinate, StudyError> {
        let path = self.path(&["coordinates", key]);
        let (name, index) = self.indexed(&path, key, file)?;
        let written = entry.unit.as_deref().unwrap_or("1");
        let unit = self.si_unit(
            &path,
            written,
            &format!("; values may have other units, as in `start: 5 {written}`"),
        )?;
        self.check_ending(&path, &name, &unit)?;
        if entry.periodic && unit.dimension != [0; 3] {
            let allowed = "a coordinate with the unit rad: a period is one turn";
            let fault = Fault::new("a periodic coordinate", shorten(&unit.si), allowed);
            return Err(path.key("periodic").refuse_value(fault));
        }
        let range = |key: &str, ends: &Option<Ends>| match ends {
            None => Ok([Formula::number(0.0), Formula::number(0.0)]),
            Some(ends) => self.range(&path.key(key), ends),
        };
        let start = [range("start", &entry.start)?, range("start_rate", &entry.start_rate)?];
        let (periodic, enlarged) = (entry.periodic, entry.enlarged);
        let meaning = entry.meaning.clone();
        let rate = entry.rate.clone().unwrap_or_else(|| format!("{name}_rate"));
        Ok(WrittenCoordinate { name, index, unit, rate, periodic, enlarged, meaning, start })
    }

    /// Reads all motions. In the keys of the file, rows take the place of the names of tables, so that the study of finished results
    /// has them.
    pub(super) fn motions(
        &self,
        file: &SystemFile,
        keys: &mut Value,
    ) -> Result<Vec<WrittenMotion>, StudyError> {
        let mut motions = Vec::new();
        for (name, entry) in &file.motions {
            let motion = self.motion(name, entry)?;
            keys["motions"][name]["table"] = json!({
                "columns": motion_columns(name, &motion.unit),
                "rows": motion.motion.rows(),
            });
            motions.push(motion);
            let rows: usize = motions.iter().map(|given| given.motion.rows().len()).sum();
            if rows > MOST_ROWS {
                let allowed = format!("at most {MOST_ROWS} rows in all motions together");
                let fault = Fault::new("too many rows", rows.to_string(), allowed);
                return Err(self.path(&["motions", name, "table"]).refuse_value(fault));
            }
        }
        Ok(motions)
    }

    /// Reads a motion that a table gives over time.
    fn motion(&self, name: &str, entry: &MotionEntry) -> Result<WrittenMotion, StudyError> {
        let path = self.path(&["motions", name]);
        let remedy = "; the columns of the table may have other units, as in `road [mm]`";
        let unit = self.si_unit(&path, entry.unit.as_deref().unwrap_or("1"), remedy)?;
        self.check_ending(&path, name, &unit)?;
        if name == "time" {
            return Err(path.wrong_key("a name of another column", name, "another name"));
        }
        let names = motion_columns(name, &unit);
        let table = match &entry.table {
            TableKey::File(name) => TableKey::File(self.beside.join(name).display().to_string()),
            inline @ TableKey::Inline(_) => inline.clone(),
        };
        let rows = values_over_time(&path.key("table"), &table, names)?;
        Ok(WrittenMotion { name: name.to_owned(), unit, motion: GivenMotion::new(rows) })
    }
}

/// Returns the names of the columns of a motion over time.
fn motion_columns(name: &str, unit: &WrittenUnit) -> [String; 2] {
    ["time_s".to_owned(), format!("{name}{}", unit_ending(&unit.si))]
}

impl Reader<'_> {
    /// Reads a contact.
    pub(super) fn contact(
        &self,
        key: &str,
        entry: &ContactEntry,
        file: &SystemFile,
    ) -> Result<WrittenContact, StudyError> {
        let path = self.path(&["contacts", key]);
        let (name, index) = self.indexed(&path, key, file)?;
        let formula = |name: &str, text: &FormulaText| self.formula(&["contacts", key, name], text);
        let sliding = entry.sliding.as_ref().map(|text| formula("sliding", text)).transpose()?;
        let refuse = |problem: &str, found: &str, allowed: &str| {
            Err(path.wrong_key(problem, found, allowed))
        };
        let allowed = "`gap: ...` for a contact that opens, or `normal: ...` for a given force";
        let normal = match (&entry.gap, &entry.normal) {
            (Some(gap), None) => WrittenNormal::Gap(formula("gap", gap)?),
            (None, Some(normal)) => WrittenNormal::Given(formula("normal", normal)?),
            (Some(_), Some(_)) => {
                return refuse("two normal forces", "`gap` and `normal`", allowed);
            }
            (None, None) => {
                return refuse("no normal force", "neither `gap` nor `normal`", allowed);
            }
        };
        if sliding.is_none() && (entry.friction.is_some() || entry.normal.is_some()) {
            let allowed = "`sliding: ...`, such as x' or x' - v_belt";
            return refuse("missing key", "no `sliding`", allowed);
        }
        let has_gap = entry.gap.is_some();
        if entry.restitution.is_some() && !has_gap
            || entry.tangential_restitution.is_some() && !(has_gap && sliding.is_some())
        {
            let allowed =
                "`restitution` only with `gap`, and `tangential_restitution` also with `sliding`";
            return refuse(
                "a restitution without an impact",
                "no gap or no sliding speed",
                allowed,
            );
        }
        let has_law_of_study = matches!(entry.friction, Some(FrictionEntry(None)));
        let laws = entry.friction.as_ref().and_then(|FrictionEntry(laws)| laws.as_ref());
        let friction = laws.map(|laws| self.friction(&path.key("friction"), key, laws));
        let friction = friction.transpose()?;
        let or_zero = |name: &str, text: &Option<FormulaText>| {
            text.as_ref().map_or(Ok(Formula::number(0.0)), |text| formula(name, text))
        };
        let restitution = [
            or_zero("restitution", &entry.restitution)?,
            or_zero("tangential_restitution", &entry.tangential_restitution)?,
        ];
        Ok(WrittenContact { name, index, sliding, normal, friction, has_law_of_study, restitution })
    }

    /// Reads the law of friction of a contact.
    fn friction(
        &self,
        path: &SourcePath<'_>,
        key: &str,
        laws: &IndexMap<String, IndexMap<String, FormulaText>>,
    ) -> Result<WrittenFriction, StudyError> {
        let names: Vec<&str> = FRICTION_LAWS.iter().map(|law| law.name()).collect();
        let Some((name, values)) = laws.iter().next().filter(|_| laws.len() == 1) else {
            let (found, allowed) =
                (format!("{} laws", laws.len()), format!("one of {}", names.join(", ")));
            return Err(path.wrong_value("not one law of friction", found, allowed));
        };
        let path = path.key(name);
        let Some(law) = FRICTION_LAWS.iter().find(|law| law.name() == name) else {
            let allowed = list_names(name, &names);
            return Err(path.wrong_key("unknown choice", shorten(name), allowed));
        };
        let has_coefficient = law.uses_friction_coefficient();
        let of_law = law.parameters().iter().map(law_key);
        let keys: Vec<&str> =
            has_coefficient.then_some(COEFFICIENT).into_iter().chain(of_law).collect();
        if let Some(unknown) = values.keys().find(|key| !keys.contains(&key.as_str())) {
            let fault = Fault::new("unknown key", shorten(unknown), list_names(unknown, &keys));
            return Err(path.key(unknown).refuse_key(fault));
        }
        let value = |law_key: &str| match values.get(law_key) {
            Some(text) => self.formula(&["contacts", key, "friction", name, law_key], text),
            None => {
                let allowed = format!("a value for `{law_key}`");
                Err(path.wrong_key("missing key", "no such key", allowed))
            }
        };
        let coefficient = if has_coefficient { value(COEFFICIENT)? } else { Formula::number(0.0) };
        let formulas = law.parameters().iter().map(|parameter| value(law_key(parameter)));
        let values = formulas.collect::<Result<_, _>>()?;
        Ok(WrittenFriction { law: *law, coefficient, values })
    }
}
