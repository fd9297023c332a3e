//! Reads the parameters and the coordinates of a system file.

use super::system::Reader;
use crate::model::{Bound, Formula, WrittenCoordinate, WrittenParameter};
use crate::study::error::{Fault, StudyError, shorten};
use crate::study::file::quantity::{convert, split_number};
use crate::study::file::system_file::{
    BoundFile, CoordinateEntry, Ends, ParameterKeys, SystemFile,
};

/// The largest number of bodies that an index counts.
const MOST_BODIES: u64 = 64;

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
}
