//! Reads the motions of a system file, which tables give over time.

use serde_json::{Value, json};

use super::system::Reader;
use crate::model::{GivenMotion, WrittenMotion, WrittenUnit, unit_ending};
use crate::study::error::{Fault, StudyError};
use crate::study::file::system_file::{MotionEntry, SystemFile};
use crate::study::file::table_input::values_over_time;
use crate::study::file::values::TableKey;

/// The largest number of rows of all motions over time: each begins a stage of a run.
const MOST_ROWS: usize = 10_000;

impl Reader<'_> {
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
            let fault = Fault::new("a name of another column", name, "another name");
            return Err(path.refuse_key(fault));
        }
        let names = motion_columns(name, &unit);
        let table = match &entry.table {
            TableKey::File(name) => TableKey::File(self.beside.join(name).display().to_string()),
            inline @ TableKey::Inline(_) => inline.clone(),
        };
        let rows = values_over_time(self.folders, &path.key("table"), &table, names)?;
        Ok(WrittenMotion { name: name.to_owned(), unit, motion: GivenMotion::new(rows) })
    }
}

/// Returns the names of the columns of a motion over time.
fn motion_columns(name: &str, unit: &WrittenUnit) -> [String; 2] {
    ["time_s".to_owned(), format!("{name}{}", unit_ending(&unit.si))]
}
