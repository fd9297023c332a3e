//! Reads tables of designs and of measured runs, in which balls were seen to rest or to move.

use std::f64::consts::TAU;
use std::path::Path;

use arrow_array::RecordBatchReader;

use super::error::{Fault, StudyError, describe_number};
use super::file::table_folders::read_bytes;
use super::file::table_input::{Rows, cells_in_memory};
use super::file::values::Entry;
use super::plan::parameter::{ParameterKind, ParameterValue};
use super::plan::planned_runs::Plan;
use super::plan::planned_study::Study;
use super::plan::variable::DesignValue;
use crate::tabular::{Cells, Limits, Refusal, check_name};

/// A table that a study reads. Messages call a table that is no file by its name here.
pub enum TableSource<'a> {
    /// A CSV or Parquet file.
    File(&'a Path),
    /// The name and an Arrow table.
    Arrow(&'a str, Box<dyn RecordBatchReader + 'a>),
    /// The name, the columns, and rows with one value per column, `None` if it is missing.
    Rows(&'a str, Vec<String>, Vec<Vec<Option<Entry>>>),
}

impl<'a, P: AsRef<Path> + ?Sized> From<&'a P> for TableSource<'a> {
    fn from(path: &'a P) -> Self {
        TableSource::File(path.as_ref())
    }
}

/// Reads the cells of a table within limits.
type Read<'a> = Box<dyn FnOnce(&Limits<'_>) -> Result<Cells, Refusal> + 'a>;

impl<'a> TableSource<'a> {
    /// Opens the table under its name in messages. `allowed` says in words which files can be read.
    fn open(self, allowed: &str) -> Result<(&'a Path, Read<'a>), StudyError> {
        Ok(match self {
            TableSource::File(path) => {
                let refuse = |fault| StudyError::about_file(path, fault);
                check_name(path, allowed).map_err(refuse)?;
                let bytes = read_bytes(path).map_err(refuse)?;
                (path, Box::new(move |limits| Cells::read(path, bytes, limits)))
            }
            TableSource::Arrow(name, reader) => {
                (name.as_ref(), Box::new(move |limits| Cells::of_arrow(reader, limits)))
            }
            TableSource::Rows(name, columns, rows) => {
                (name.as_ref(), Box::new(move |limits| cells_in_memory(columns, rows, limits)))
            }
        })
    }
}

/// Swept values of the table and of the study agree if they differ by at most this part.
const AGREEMENT: f64 = 1e-4;
/// The column of the standard deviation of a measured angle.
const STD_DEV: &str = "std_dev_rad";
/// The column of the stage of a run.
const STAGE: &str = "stage";

/// A measured run.
#[derive(Clone, Debug, PartialEq)]
pub struct MeasuredRun {
    /// The point of the sweep.
    pub point_id: u64,
    /// The number of the stage at whose end the balls were measured, from 1; `None` for the end of the run.
    pub stage: Option<u64>,
    /// Angles of the balls from the imbalance in any order, rad; `None` if the balls were seen to move.
    pub rest: Option<Vec<f64>>,
    /// Standard deviation of a measured angle, rad.
    pub std_dev_rad: f64,
}

/// Returns a warning if a measured angle is beyond two turns, because it is probably in degrees. An angle near a turn may be
/// beyond it by its error.
pub fn implausible_angle(runs: &[MeasuredRun]) -> Option<String> {
    let angles = runs.iter().flat_map(|run| run.rest.iter().flatten());
    let largest = angles.copied().max_by(|left, right| left.abs().total_cmp(&right.abs()))?;
    (largest.abs() > 2.0 * TAU).then(|| {
        format!(
            "a measured angle is beyond two turns\n  found:  {} rad\n  remedy: angles in rad, without whole turns; a \
             degree is 0.0174533 rad",
            describe_number(largest)
        )
    })
}

impl Plan {
    /// Reads measured runs from a table: columns of swept parameters, which select the point; `stage`; `beta_1_rad` and so
    /// on, empty where the balls were seen to move; and `std_dev_rad`.
    ///
    /// # Errors
    /// Returns the first fault with its row and column: an unreadable file, an unknown or missing column, a row that
    /// selects no point or several, a value that is no angle, or a standard deviation that is not positive.
    pub fn measured<'a>(
        &self,
        table: impl Into<TableSource<'a>>,
    ) -> Result<Vec<MeasuredRun>, StudyError> {
        let (path, read) = table.into().open("a name that ends in .csv or .parquet")?;
        let angles: Vec<String> = (1..=self.model().angle_contacts().len())
            .map(|ball| format!("beta_{ball}_rad"))
            .collect();
        let mut names: Vec<String> = self.swept().iter().map(|swept| swept.name.clone()).collect();
        if self.has_stages() {
            names.push(STAGE.to_owned());
        }
        names.extend(angles.iter().cloned());
        names.push(STD_DEV.to_owned());
        let rows = Rows::in_file(path, read, &names, Some(Entry::Text(String::new())))?;
        let needed = angles.iter().map(String::as_str).chain([STD_DEV]);
        rows.check_has(needed, || format!("the columns {}", names.join(", ")))?;
        (0..rows.rows.len()).map(|row| self.measured_run(&rows, row, &angles)).collect()
    }

    fn measured_run(
        &self,
        rows: &Rows<'_>,
        row: usize,
        angles: &[String],
    ) -> Result<MeasuredRun, StudyError> {
        let place = |name: &str| rows.column(name);
        let number = |name: &str, allowed: &str| -> Result<Option<f64>, StudyError> {
            let Some(column) = place(name) else { return Ok(None) };
            match &rows.rows[row][column] {
                Entry::Number(number) => Ok(Some(*number)),
                Entry::Text(text) if text.is_empty() => Ok(None),
                Entry::Text(text) => {
                    let fault = Fault::new("not a number", text.as_str(), allowed);
                    Err(rows.refuse(Some(row), Some(column), fault))
                }
            }
        };
        let stage = match number(STAGE, "the number of a stage, from 1")? {
            Some(stage) if stage >= 1.0 && stage.fract() == 0.0 => Some(stage as u64),
            Some(stage) => {
                let allowed = "the number of a stage, from 1, as in stages.parquet";
                let fault = Fault::new("not a stage", describe_number(stage), allowed);
                return Err(rows.refuse(Some(row), place(STAGE), fault));
            }
            None => None,
        };
        let allowed = "an angle in rad, or nothing in all of these columns for balls that move";
        let measured = angles.iter().map(|name| number(name, allowed));
        let measured = measured.collect::<Result<Vec<_>, _>>()?;
        let rest = match measured.iter().flatten().count() {
            0 => None,
            all if all == measured.len() => Some(measured.into_iter().flatten().collect()),
            some => {
                let found = format!("{some} of {} angles", measured.len());
                let fault = Fault::new("angles of some balls only", found, allowed);
                return Err(rows.refuse(Some(row), None, fault));
            }
        };
        let std_dev_rad = number(STD_DEV, "a number above 0, rad")?;
        let std_dev_rad = std_dev_rad.filter(|value| *value > 0.0 && *value < 1.0);
        let std_dev_rad = std_dev_rad.ok_or_else(|| {
            let allowed = "the standard deviation of a measured angle in rad, above 0 and below 1, such as 0.1";
            let found = place(STD_DEV).map(|column| match &rows.rows[row][column] {
                Entry::Number(number) => describe_number(*number),
                Entry::Text(_) => "nothing".to_owned(),
            });
            let found = found.unwrap_or_default();
            rows.refuse(Some(row), place(STD_DEV), Fault::new("not an accuracy", found, allowed))
        })?;
        Ok(MeasuredRun { point_id: self.measured_point(rows, row)?, stage, rest, std_dev_rad })
    }

    /// Returns the only point whose swept values are those of a row.
    fn measured_point(&self, rows: &Rows<'_>, row: usize) -> Result<u64, StudyError> {
        let values = |name: &String| {
            let column = rows.column(name)?;
            Some(&rows.rows[row][column])
        };
        let agrees = |point_id: &u64| {
            let swept = self.point(*point_id).swept;
            self.swept().iter().zip(swept).all(|(parameter, value)| {
                match (values(&parameter.name), value) {
                    (None, _) => true,
                    (Some(Entry::Number(measured)), ParameterValue::Number(number)) => {
                        (measured - number).abs() <= AGREEMENT * number.abs()
                    }
                    (Some(Entry::Text(measured)), ParameterValue::Text(text)) => measured == text,
                    _ => false,
                }
            })
        };
        let mut points = (0..self.point_count()).filter(agrees);
        let (first, second) = (points.next(), points.next());
        match (first, second) {
            (Some(point_id), None) => Ok(point_id),
            (first, _) => {
                let given = self.swept().iter().filter_map(|parameter| {
                    let value = match values(&parameter.name)? {
                        Entry::Number(number) => describe_number(*number),
                        Entry::Text(text) => text.clone(),
                    };
                    Some(format!("{} {value}", parameter.name))
                });
                let given: Vec<String> = given.collect();
                let problem = match first {
                    None => "no point of the sweep has these values",
                    Some(_) => "several points of the sweep have these values",
                };
                let all = self.swept().iter().map(|parameter| match parameter.kind {
                    ParameterKind::Number => format!("{} in {}", parameter.name, parameter.unit),
                    ParameterKind::Text => parameter.name.clone(),
                });
                let allowed = format!(
                    "values of one point of the study's `sweep`, by {}; a sweep such as [{{grid: {{speed_rad_s: \
                     [-160, -173]}}}}] has the measured speeds",
                    all.collect::<Vec<_>>().join(", ")
                );
                let found =
                    if given.is_empty() { "no swept value".to_owned() } else { given.join(", ") };
                Err(rows.refuse(Some(row), None, Fault::new(problem, found, allowed)))
            }
        }
    }
}

impl Study {
    /// Reads the designs in a table: a file, also `-` for standard input, an Arrow table, or rows. Each design is valid at
    /// every point of the study.
    ///
    /// # Errors
    /// Returns the first fault with its row and column: an unreadable file, a column that is unknown, missing or given
    /// twice, a value outside its variable's range, or a design that is invalid at a point.
    pub fn designs<'a>(
        &self,
        table: impl Into<TableSource<'a>>,
    ) -> Result<Vec<Vec<DesignValue>>, StudyError> {
        let allowed = "a name that ends in .csv or .parquet, or - for standard input";
        let (name, read) = table.into().open(allowed)?;
        let names: Vec<String> =
            self.variables().iter().map(|variable| variable.name.clone()).collect();
        let rows = Rows::in_file(name, read, &names, None)?;
        let allowed = || format!("a column for each variable: {}", names.join(", "));
        rows.check_has(names.iter().map(String::as_str), allowed)?;
        (0..rows.rows.len()).map(|row| self.design_of(&rows, row)).collect()
    }

    fn design_of(&self, rows: &Rows<'_>, row: usize) -> Result<Vec<DesignValue>, StudyError> {
        let mut values = Vec::with_capacity(self.variables().len());
        for variable in self.variables() {
            let column = rows.column(&variable.name);
            // The caller has checked that each variable has a column.
            let entry = column.and_then(|column| rows.rows[row].get(column));
            let value = match entry {
                Some(Entry::Number(number)) => variable.number(*number),
                Some(Entry::Text(word)) => variable.word(word),
                None => Err(Fault::new("an empty value", "nothing", variable.allowed())),
            };
            values.push(value.map_err(|fault| rows.refuse(Some(row), column, fault))?);
        }
        self.with_design(&values).map_err(|fault| rows.refuse(Some(row), None, fault))?;
        Ok(values)
    }
}
