//! One printed point of the sweep, from its runs or from a row of `points.parquet`.

use serde_json::{Value, json};

use crate::analysis::AuditCounts;
use crate::classification::Label;
use crate::study::{ParameterKind, ParameterValue, Study};
use crate::table::{Batch, Kind, PointRow, TableError};

/// The printed values of a point.
#[derive(Clone, Debug)]
pub struct PointLine {
    /// Number of the point, from 0.
    pub point_id: u64,
    /// Values of the swept parameters, as text and as JSON.
    pub swept: Vec<(String, Value)>,
    /// Finished runs.
    pub runs: u64,
    /// Runs per label, in the order of [`Label::ALL`].
    pub label_runs: [u64; 5],
    /// Fraction of runs that end at an equilibrium.
    pub equilibrium_fraction: f64,
    /// 95 % confidence interval of `equilibrium_fraction`.
    pub interval: (f64, f64),
    /// Method of the confidence interval.
    pub ci_method: String,
    /// Median time to rest, s.
    pub time_to_rest_p50_s: Option<f64>,
    /// Results of the audit.
    pub audit: AuditCounts,
    /// Fraction of ball positions that are equilibria.
    pub set_fraction: Option<f64>,
}

impl PointLine {
    /// Returns the line of a point whose runs have finished.
    pub fn of(row: &PointRow) -> Self {
        let PointRow { point_id, swept, summary, set_fraction, .. } = row;
        let swept = swept.iter().map(|value| match value {
            ParameterValue::Number(number) => number_cell(*number),
            ParameterValue::Text(text) => ((*text).to_owned(), json!(text)),
        });
        PointLine {
            point_id: *point_id,
            swept: swept.collect(),
            runs: summary.counts.total(),
            label_runs: Label::ALL.map(|label| summary.counts.of(label)),
            equilibrium_fraction: summary.equilibrium_fraction,
            interval: summary.interval.ends(),
            ci_method: summary.interval.method.name().to_owned(),
            time_to_rest_p50_s: summary.time_to_rest_s[1],
            audit: summary.audit,
            set_fraction: *set_fraction,
        }
    }

    /// Returns the columns of `points.parquet` that [`Self::read`] needs.
    pub fn columns(study: &Study) -> Vec<(String, Kind)> {
        let mut columns = vec![("point_id".to_owned(), Kind::Count)];
        columns.extend(study.swept().iter().map(|column| {
            let kind = match column.kind {
                ParameterKind::Number => Kind::Number,
                ParameterKind::Text => Kind::Text,
            };
            (column.name.clone(), kind)
        }));
        let labels = Label::ALL.map(|label| format!("{}_runs", label.name()));
        let counts = ["runs", "audited_runs", "audit_flips", "audit_rest_flips"].map(String::from);
        columns.extend(labels.into_iter().chain(counts).map(|name| (name, Kind::Count)));
        let numbers = ["equilibrium_fraction", "ci_low", "ci_high", "time_to_rest_p50_s"];
        columns.extend(numbers.map(|name| (name.to_owned(), Kind::Number)));
        columns.push(("ci_method".to_owned(), Kind::Text));
        if has_set(study) {
            columns.push(("set_fraction".to_owned(), Kind::Number));
        }
        columns
    }

    /// Returns the points of some rows of `points.parquet`, read with [`Self::columns`].
    ///
    /// # Errors
    /// Returns an error if a column is missing.
    pub fn read(study: &Study, batch: &Batch) -> Result<Vec<Self>, TableError> {
        let number = |name: &str, row: usize| {
            let values = batch.numbers(name)?;
            Ok::<_, TableError>(values.get(row).copied().flatten())
        };
        // A missing count belongs to a kind of run that did not occur.
        let count = |name: &str, row: usize| {
            let values = batch.counts(name)?;
            Ok::<_, TableError>(values.get(row).copied().flatten().unwrap_or(0))
        };
        let text = |name: &str, row: usize| {
            let values = batch.texts(name)?;
            Ok::<_, TableError>(values.get(row).cloned().flatten().unwrap_or_default())
        };
        let line = |row: usize| {
            let swept = study.swept().iter().map(|column| match column.kind {
                ParameterKind::Number => {
                    Ok(number_cell(number(&column.name, row)?.unwrap_or(f64::NAN)))
                }
                ParameterKind::Text => {
                    let text = text(&column.name, row)?;
                    Ok((text.clone(), json!(text)))
                }
            });
            let mut label_runs = [0; 5];
            for (runs, label) in label_runs.iter_mut().zip(Label::ALL) {
                *runs = count(&format!("{}_runs", label.name()), row)?;
            }
            let fraction = |name: &str| Ok::<_, TableError>(number(name, row)?.unwrap_or(f64::NAN));
            Ok(PointLine {
                point_id: count("point_id", row)?,
                swept: swept.collect::<Result<_, TableError>>()?,
                runs: count("runs", row)?,
                label_runs,
                equilibrium_fraction: fraction("equilibrium_fraction")?,
                interval: (fraction("ci_low")?, fraction("ci_high")?),
                ci_method: text("ci_method", row)?,
                time_to_rest_p50_s: number("time_to_rest_p50_s", row)?,
                audit: AuditCounts {
                    runs: count("audited_runs", row)?,
                    flips: count("audit_flips", row)?,
                    rest_flips: count("audit_rest_flips", row)?,
                },
                set_fraction: if has_set(study) { number("set_fraction", row)? } else { None },
            })
        };
        (0..batch.rows).map(line).collect()
    }

    /// Returns the number of runs with this label.
    pub fn label_runs(&self, label: Label) -> u64 {
        Label::ALL
            .iter()
            .zip(self.label_runs)
            .find_map(|(other, runs)| (*other == label).then_some(runs))
            .unwrap_or(0)
    }
}

fn number_cell(number: f64) -> (String, Value) {
    (ParameterValue::Number(number).to_string(), json!(number))
}

fn has_set(study: &Study) -> bool {
    study.model().balls() > 0
}
