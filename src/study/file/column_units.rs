//! Columns of tables with a unit in brackets, such as `speed [rpm]` for `speed_rad_s`: their numbers become numbers in SI
//! units, so that the rest of the program knows SI columns only.

use crate::study::error::{Fault, list_names, shorten};
use crate::study::file::key_units::split_unit;
use crate::study::file::quantity::Conversion;
use crate::study::file::values::Entry;

/// A column as the program knows it, and how its numbers become SI numbers.
pub(super) struct KnownColumn {
    pub(super) name: String,
    conversion: Option<Conversion>,
}

impl KnownColumn {
    /// Returns the column that a table calls by this name; `allowed` contains the SI names.
    pub(super) fn of(written: &str, allowed: &[String]) -> Result<KnownColumn, Fault> {
        let plain = |name: &String| KnownColumn { name: name.clone(), conversion: None };
        if let Some(name) = allowed.iter().find(|name| *name == written) {
            return Ok(plain(name));
        }
        let unknown =
            || Fault::new("unknown column", shorten(written), list_names(written, allowed));
        let with_unit = written.trim().strip_suffix(']').and_then(|text| text.split_once('['));
        let (short, unit) = with_unit.ok_or_else(unknown)?;
        let (short, unit) = (short.trim(), unit.trim());
        let known = allowed.iter().find_map(|name| {
            let (without, si) = split_unit(name)?;
            (name == short || without == short).then_some((name, si))
        });
        let (name, si) = known.ok_or_else(unknown)?;
        let conversion = Conversion::new(unit, si).map_err(|fault| Fault {
            found: Some(format!("column {}", shorten(written))),
            ..fault
        })?;
        Ok(KnownColumn { name: name.clone(), conversion: Some(conversion) })
    }

    /// Converts the numbers of this column in all rows.
    pub(super) fn convert(&self, rows: &mut [Vec<Entry>], column: usize) {
        let Some(conversion) = &self.conversion else { return };
        for row in rows {
            if let Some(Entry::Number(number)) = row.get_mut(column) {
                *number = conversion.of(*number);
            }
        }
    }
}
